//! Photon differentials against areas in closed form.

use glam::Vec3;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tyndall_core::{PassContext, Ray, Rgb};
use tyndall_driver::PassStreams;
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_walk::{Footprint, LightPaths, Route, Visit};

/// In clear haze, so that all of it is flights.
fn scene(rest: &str) -> Scene<Rgb> {
    let text = format!(
        r#"
        camera = {{ position = [0, 0, 9], look_at = [0, 0, 0], fov = 40, medium = "haze" }}
        film = {{ width = 4, height = 4 }}
        media.haze = {{ kind = "homogeneous", sigma_a = 0, sigma_s = 1e-6 }}
        {rest}
        "#
    );
    let scene = SceneFile::parse(&text, Path::new("test"), &[]).and_then(|file| file.build());
    scene.unwrap_or_else(|why| panic!("{why}"))
}

/// The flights of some paths before light is scattered into many directions, in the order of the paths.
fn flights(host: &Scene<Rgb>) -> Vec<(Ray, Footprint)> {
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    let paths = LightPaths::new(&cx, 100, u64::MAX).footprints(true);
    let flights = paths.collect(host, |walk, sampler, found| {
        walk.visit(sampler, |visit, route, _| {
            if let Visit::Flight(flight) = visit {
                assert!(route != Route::Diffuse || flight.footprint.is_none());
                found.extend(flight.footprint.map(|footprint| (flight.ray, footprint)));
            }
        });
    });
    flights.expect("light paths").concat()
}

#[track_caller]
fn check(footprint: &Footprint, v: f64, expected: f64, relative: f64) {
    let area = footprint.area(v);
    let close = (area / expected - 1.0).abs() < relative;
    assert!(close, "{area} at {v}, expected {expected}");
}

/// Rays beside are turned by 1e-3 and have directions in `f32`: an error of about 1e-4.
const TURNED: f64 = 1e-3;

#[test]
fn light_fans_out_from_a_point() {
    // Of two lamps, each with half of the paths: each path is one of half as many.
    for (count, lamps) in [
        (
            1.0,
            r#"{ kind = "point", position = [1, 2, 3], power = 1 }"#,
        ),
        (
            2.0,
            r#"{ kind = "point", position = [1, 2, 3], power = 1 },
               { kind = "point", position = [1, 2, 4], power = 1 }"#,
        ),
    ] {
        let host = scene(&format!("lights = [{lamps}]"));
        let flights = flights(&host);
        assert_eq!(flights.len(), 100);
        for (_, footprint) in flights {
            for v in [1e-3, 1.0, 50.0] {
                check(&footprint, v, count * 4.0 * PI * v * v, TURNED);
            }
        }
    }
}

#[test]
fn a_lamp_fills_its_area_and_then_its_angle() {
    // A square of 0.1: by its cosine, and by π v² over cos θ of the directions.
    let host = scene(
        r#"shapes = [{ kind = "quad", corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0],
            material = "lamp", emission = 1 }]
        materials.lamp = { kind = "diffuse", reflectance = 0 }"#,
    );
    for (ray, footprint) in flights(&host) {
        let cosine = f64::from(ray.direction.z.abs());
        check(&footprint, 0.0, 0.01 * cosine, 1e-3);
        let far = PI / cosine;
        check(&footprint, 1e4, far * 1e8, 1e-2);
    }
}

#[test]
fn a_ball_of_glass_focuses() {
    // An axial beam, thin against the ball of radius 1: behind it the light is as if it came to a
    // focus at 1.5 radii from the middle, 0.5 behind the ball (n = 1.5), and a third as wide where it
    // leaves it. Spherical aberration is (h/2)² of lengths, 1e-4 for h = 0.02.
    let host = scene(
        r#"lights = [{ kind = "beam", position = [0, 0, -5], direction = [0, 0, 1], radius = 0.02,
            power = 1 }]
        materials.glass = { kind = "dielectric", ior = 1.5, inside = "haze" }
        shapes = [{ kind = "sphere", center = [0, 0, 0], radius = 1, material = "glass" }]"#,
    );
    let disc = PI * 0.02 * 0.02;
    let (mut before, mut behind) = (0, 0);
    for (ray, footprint) in flights(&host) {
        if ray.origin.z < -2.0 {
            before += 1;
            check(&footprint, 3.0, disc, 1e-3);
        } else if ray.origin.z > 0.99 && ray.direction.dot(Vec3::Z) > 0.9 {
            behind += 1;
            check(&footprint, 0.0, disc / 9.0, 1e-2);
            check(&footprint, 2.0, disc, 1e-2);
            assert!(footprint.area(0.5) < 1e-3 * disc, "{}", footprint.area(0.5));
        }
    }
    assert!(
        before == 100 && behind > 80,
        "{before} before, {behind} behind"
    );
}

#[test]
fn null_surfaces_change_nothing() {
    let host = scene(
        r#"lights = [{ kind = "point", position = [0, 0, 0], power = 1 }]
        materials.boundary = { kind = "null", inside = "haze" }
        shapes = [{ kind = "sphere", center = [0, 0, 0], radius = 2, material = "boundary" }]"#,
    );
    let flights = flights(&host);
    assert_eq!(flights.len(), 200);
    for (ray, footprint) in flights {
        let before = f64::from(ray.origin.length());
        check(&footprint, 3.0, 4.0 * PI * (before + 3.0).powi(2), TURNED);
    }
}
