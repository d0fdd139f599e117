//! rpt borrows photon methods, and they agree with the path tracer that it borrows as well. False
//! alarms: 0.27 % a test, as in the other tests of this host; fixed seeds.
//!
//! Radii are fixed and small, so that what they blur is far below the standard error: the bias of a
//! kernel of radius r on a disc is r²∇²L/12 (Epanechnikov).

use crate::fog::{FALSE_ALARM, ball, fog, keyhole};
use rpt::{
    Environment, Light, Material, Object, Scene, SceneAdd, Transformable, cube, glm, plane, sphere,
};
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{AnyIntegrator, Rgb};
use tyndall_driver::PassStreams;
use tyndall_host_rpt::RptHost;
use tyndall_path::Path;
use tyndall_photon_beams::PhotonBeams;
use tyndall_photon_map::PhotonMap;
use tyndall_testkit::stats::check_means;
use tyndall_testkit::{integrator_conformance, measure_mean};

type Method = dyn AnyIntegrator<RptHost, PassStreams>;

/// The photons' picture is that of paths.
fn agree(host: &RptHost, photons: &Method, passes: u64) {
    host.check_photons().expect("photons bring all light");
    let by_photons = measure_mean(host, photons, passes, 1);
    let by_paths = measure_mean(host, &Path::with_unhittable_lights(), 100_000, 2);
    let cases: Vec<_> = by_photons
        .iter()
        .zip(&by_paths)
        .map(|(a, b)| {
            // A test that would not see a few in a hundred is none.
            let errors = [a, b].map(|estimate| estimate.relative_standard_error());
            assert!(errors.iter().all(|e| *e < 0.02), "{errors:?}");
            ("photons less paths", a.difference(b), 0.0)
        })
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

/// Looking down at a floor, two below the eye.
fn over_a_floor() -> RptHost {
    let mut scene = Scene::new();
    scene.add(
        Object::new(plane(glm::vec3(0.0, 0.0, 1.0), -2.0))
            .material(Material::diffuse(glm::vec3(0.8, 0.5, 0.2))),
    );
    RptHost {
        scene,
        camera: keyhole(glm::vec3(0.0, 0.0, 0.0)),
        resolution: [1, 1],
        fog: None,
        skin: 1e-5,
    }
}

#[test]
fn a_point_light_glows_in_fog_by_beams_as_by_paths() {
    let mut scene = Scene::new();
    scene.add(Light::Point(
        glm::vec3(1.0, 2.0, 0.5),
        glm::vec3(0.0, 1.0, -2.0),
    ));
    let (sigma_a, sigma_s) = (Rgb::new(0.2, 0.3, 0.1), Rgb::new(0.6, 0.4, 0.8));
    let host = RptHost {
        scene,
        fog: Some(fog(sigma_a, sigma_s)),
        ..over_a_floor()
    };
    let beams = BeamRadiance::new().paths(20_000).radius(0.12).alpha(1.0);
    agree(&host, &beams, 80);
    let beams = PhotonBeams::new().paths(4_000).beam_radius(0.06).alpha(1.0);
    agree(&host, &beams.surface_radius(0.12), 80);
    let beams = beams.starting_paths(4_000).beam_differentials(1.0);
    agree(&host, &beams.surface_radius(0.12), 80);
}

#[test]
fn lamps_of_any_shape_light_a_floor_by_photons_as_by_paths() {
    let mut host = over_a_floor();
    let lamp = |x, color| {
        let material = Material::light(color, 5.0);
        (glm::vec3(x, 0.0, 1.0), material)
    };
    let (place, material) = lamp(1.0, glm::vec3(1.0, 0.8, 0.6));
    let ball = sphere().scale(&glm::vec3(0.3, 0.3, 0.3)).translate(&place);
    host.scene
        .add(Light::Object(Object::new(ball).material(material)));
    let (place, material) = lamp(-1.0, glm::vec3(0.2, 0.4, 1.0));
    let block = cube()
        .scale(&glm::vec3(0.6, 0.4, 0.3))
        .rotate_x(0.5)
        .translate(&place);
    host.scene
        .add(Light::Object(Object::new(block).material(material)));
    let map = PhotonMap::new().paths(40_000).radius(0.3);
    agree(&host, &map, 150);
}

#[test]
fn light_that_starts_no_photons_is_told() {
    let told = |change: fn(&mut Scene)| {
        let mut host = over_a_floor();
        change(&mut host.scene);
        host.check_photons()
    };
    assert_eq!(told(|_| {}), Ok(()));
    for (change, what) in [
        (
            (|scene| scene.environment = Environment::Color(glm::vec3(0.1, 0.0, 0.0)))
                as fn(&mut Scene),
            "environment",
        ),
        (
            |scene| scene.add(Light::Directional(glm::zero(), glm::vec3(0.0, 0.0, 1.0))),
            "directional",
        ),
        (
            |scene| scene.add(Object::new(sphere()).material(Material::light(glm::zero(), 1.0))),
            "objects that glow",
        ),
    ] {
        assert!(told(change).is_err_and(|why| why.contains(what)));
    }
}

integrator_conformance! {
    name: beams_on_rpt,
    integrator: BeamRadiance::new().paths(2_000),
    host: ball,
}
