//! rpt's scenes in fog against closed forms. False alarms: 0.27 % a test (three standard errors of
//! a normal distribution), Šidák-corrected within it; fixed seeds.

use rpt::{Camera, Light, Material, Object, Scene, SceneAdd, Transformable, glm, plane, sphere};
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_host_rpt::RptHost;
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::{Path, Scattering};
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::stats::check_means;
use tyndall_testkit::{integrator_conformance, measure_mean};

pub(crate) const FALSE_ALARM: f64 = 0.0027;

pub(crate) fn fog(sigma_a: Rgb, sigma_s: Rgb) -> Homogeneous<Rgb> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    };
    Homogeneous::new(coefficients, Phase::Isotropic).expect("valid coefficients")
}

/// Looks along −z through a keyhole, so that every ray is the axis.
pub(crate) fn keyhole(eye: glm::DVec3) -> Camera {
    Camera {
        eye,
        fov: 1e-6,
        ..Camera::default()
    }
}

fn check(host: &RptHost, scattering: Scattering, passes: u64, expected: impl Fn(usize) -> f64) {
    let path = Path::with_unhittable_lights().scattering(scattering);
    let values = measure_mean(host, &path, passes, 1);
    let cases: Vec<_> = values
        .into_iter()
        .enumerate()
        .map(|(channel, estimate)| ("radiance", estimate, expected(channel)))
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn a_glowing_wall_fades_behind_fog_that_absorbs() {
    let mut scene = Scene::new();
    scene.add(
        Object::new(plane(glm::vec3(0.0, 0.0, 1.0), -2.0))
            .material(Material::light(glm::vec3(1.0, 0.5, 2.0), 3.0)),
    );
    let sigma_a = Rgb::new(0.1, 0.7, 1.3);
    let host = RptHost {
        scene,
        camera: keyhole(glm::vec3(0.0, 0.0, 1.0)),
        resolution: [1, 1],
        fog: Some(fog(sigma_a, Rgb::default())),
        skin: 1e-5,
    };
    check(&host, Scattering::Multiple, 2_000, |channel| {
        [3.0, 1.5, 6.0][channel] * (-3.0 * f64::from(sigma_a.channel(channel))).exp()
    });
}

#[test]
fn a_point_light_glows_in_fog() {
    let mut scene = Scene::new();
    // Intensity 1/(4π) W/sr is 1 W; rpt's colours are intensities.
    let intensity = 0.25 / std::f64::consts::PI;
    scene.add(Light::Point(
        glm::vec3(intensity, intensity, intensity),
        glm::vec3(0.0, 1.0, -2.0),
    ));
    let (sigma_a, sigma_s) = (Rgb::new(0.1, 0.2, 0.0), Rgb::new(0.5, 0.3, 1.0));
    let host = RptHost {
        scene,
        camera: keyhole(glm::vec3(0.0, 0.0, 0.0)),
        resolution: [1, 1],
        fog: Some(fog(sigma_a, sigma_s)),
        skin: 1e-5,
    };
    check(&host, Scattering::Single, 200_000, |channel| {
        let sigma_s = f64::from(sigma_s.channel(channel));
        let sigma_t = sigma_s + f64::from(sigma_a.channel(channel));
        airlight(sigma_s, sigma_t, 1.0, 2.0, f64::INFINITY)
    });
}

/// A ball over a floor, lit by an invisible lamp.
pub(crate) fn ball(scale: f32) -> RptHost {
    let s = f64::from(scale);
    let mut scene = Scene::new();
    scene.add(
        Object::new(plane(glm::vec3(0.0, 1.0, 0.0), -s))
            .material(Material::diffuse(glm::vec3(0.7, 0.6, 0.5))),
    );
    scene.add(
        Object::new(sphere().scale(&glm::vec3(s, s, s)))
            .material(Material::diffuse(glm::vec3(0.2, 0.4, 0.8))),
    );
    let lamp = sphere()
        .scale(&(0.5 * glm::vec3(s, s, s)))
        .translate(&(s * glm::vec3(2.0, 4.0, 1.0)));
    scene.add(Light::Object(
        Object::new(lamp).material(Material::light(glm::vec3(1.0, 1.0, 0.8), 20.0)),
    ));
    RptHost {
        scene,
        camera: Camera {
            eye: s * glm::vec3(0.0, 0.5, 6.0),
            ..Camera::default()
        },
        resolution: [16, 12],
        fog: Some(fog(Rgb::splat(0.01 / scale), Rgb::splat(0.1 / scale))),
        skin: 1e-4 * s,
    }
}

integrator_conformance! {
    name: path_on_rpt,
    integrator: Path::with_unhittable_lights().max_depth(6),
    host: ball,
}
