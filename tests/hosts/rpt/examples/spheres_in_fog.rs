//! rpt's own scene of spheres under an invisible lamp, in fog, by Tyndall's path tracer.
//!
//!     cargo run --release -p tyndall-host-rpt --example spheres_in_fog -- out.png

use rpt::{Camera, Environment, Light, Material, Object, Scene, SceneAdd, Transformable};
use rpt::{color_bytes, glm, hex_color, plane, sphere};
use tyndall_core::{Coefficients, Rgb};
use tyndall_driver::{Budget, Render};
use tyndall_host_rpt::RptHost;
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::Path;

/// The objects of rpt's example `spheres`, with its camera.
fn spheres() -> (Scene, Camera) {
    let mut scene = Scene::new();
    scene.environment = Environment::Color(glm::vec3(0.0, 0.0, 0.0));
    scene.add(
        Object::new(plane(glm::vec3(0.0, 0.0, 1.0), 0.0))
            .material(Material::diffuse(hex_color(0xE7E7E7))),
    );
    for (x, y, radius, color) in [
        (0.5, 4.0, 1.0, 0xE78999),
        (3.15, -0.7, 1.5, 0xE7A94D),
        (0.1, -2.0, 0.6, 0xB3E7AA),
        (-1.7, -0.2, 1.1, 0x7CA3E7),
        (1.2, 0.4, 0.5, 0xAAAAAA),
    ] {
        let ball = sphere().scale(&glm::vec3(radius, radius, radius));
        scene.add(
            Object::new(ball.translate(&glm::vec3(x, y, radius)))
                .material(Material::specular(hex_color(color), 0.1)),
        );
    }
    let lamp = sphere()
        .scale(&glm::vec3(2.0, 2.0, 2.0))
        .translate(&glm::vec3(1.2, -1.5, 8.0));
    scene.add(Light::Object(
        Object::new(lamp).material(Material::light(hex_color(0xFFFFFF), 8.0)),
    ));
    let camera = Camera::look_at(
        glm::vec3(0.7166, -9.2992, 2.8803),
        glm::vec3(0.8673, 0.2095, 0.9557),
        glm::vec3(0.0, 0.0, 1.0),
        0.6911,
    )
    .focus(glm::vec3(0.1, -2.0, 0.6), 0.15);
    (scene, camera)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let output = std::env::args().nth(1).ok_or("name the image: out.png")?;
    let (scene, camera) = spheres();
    let fog = Coefficients {
        sigma_a: Rgb::new(0.01, 0.008, 0.005),
        sigma_s: Rgb::new(0.05, 0.055, 0.065),
        emission: Rgb::default(),
    };
    let host = RptHost {
        scene,
        camera,
        resolution: [400, 300],
        fog: Some(Homogeneous::new(fog, Phase::henyey_greenstein(0.3)?)?),
        skin: 1e-4,
    };
    let film =
        Render::new(&host, &Path::with_unhittable_lights()).run(Budget::Passes(64), |_| {})?;
    let [width, height] = film.resolution();
    let bytes = film
        .mean()
        .chunks_exact(3)
        .flat_map(|c| color_bytes(&glm::vec3(c[0], c[1], c[2])))
        .collect();
    rpt::image::RgbImage::from_raw(width, height, bytes)
        .ok_or("the film has three channels a pixel")?
        .save(output)?;
    Ok(())
}
