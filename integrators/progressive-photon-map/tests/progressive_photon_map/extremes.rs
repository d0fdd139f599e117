//! Where numbers run out: every sample is finite ([`render`] asserts it), and options that no pass
//! can work with are refused in a sentence.

use crate::{alone, closed_form::floor, fog, measure, render};
use glam::Vec3;
use tyndall_core::{AnyIntegrator, PassError, Ray, Rgb, Sensor, Spectrum};
use tyndall_driver::{Budget, PassStreams, Render, RenderError};
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::stats::check_means;

const BOTH: [Radii; 2] = [Radii::Memoryless, Radii::Statistics];

fn refusal<H: Sensor>(host: &H, method: &dyn AnyIntegrator<H, PassStreams>) -> String {
    let film = alone().install(|| Render::new(host, method).run(Budget::Passes(1), |_| {}));
    match film {
        Err(RenderError::Pass(PassError::Unsupported(why))) => why,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it rendered"),
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let host = floor(1.0);
    let method = ProgressivePhotonMap::new;
    for (name, method) in [
        ("paths", method().paths(0)),
        ("starting", method().starting_paths(0)),
        ("nearest", method().nearest(1)),
        ("in this pass", method().radius(1e-12)),
        ("max_radius", method().max_radius(0.0)),
        ("alpha", method().alpha(0.0)),
    ] {
        let why = refusal(&host, &method);
        assert!(why.contains(name), "{name}: {why}");
    }
}

fn chords(scale: f32) -> View {
    let ray = |x: f32| Ray::new(Vec3::new(x, 0.0, -2.0) * scale, Vec3::Z);
    let inside = Ray::new(Vec3::new(0.1, 0.2, 0.3) * scale, Vec3::X);
    View::Rays(vec![ray(0.0), ray(0.999_99), inside])
}

/// Opaque, empty, white, black, peaked, tiny and huge; the camera outside and inside.
#[test]
fn any_fog_is_finite() {
    for scale in [1e-8, 1.0, 1e8] {
        for (sigma_a, sigma_s) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1e-9, 1e-9), (1e6, 1e2)] {
            for g in [-0.999, 0.0, 0.999] {
                for radii in BOTH {
                    let [a, s] =
                        [sigma_a, sigma_s].map(|s| Rgb::new(s, 0.5 * s, 0.0) * (1.0 / scale));
                    let light = Light::Point {
                        position: Vec3::new(0.2, 0.1, 0.0) * scale,
                        power: Rgb::splat(scale * scale),
                    };
                    let host = AnalyticHost::sphere(
                        fog(a, s, g),
                        scale,
                        Interface::Matched,
                        light,
                        chords(scale),
                    );
                    let method = ProgressivePhotonMap::new().paths(100).radii(radii);
                    let film = render(&host, &method, 4, 1);
                    if sigma_s == 0.0 {
                        assert!(film.iter().all(|v| *v == 0.0));
                    }
                    let method = ProgressivePhotonMap::sampling_lights()
                        .paths(100)
                        .radii(radii);
                    render(&host, &method, 4, 1);
                }
            }
        }
    }
}

/// White fog of 1e6 per unit: walks of light are cut where they enter.
#[test]
fn an_opaque_white_wall_is_finite() {
    let view = View::Rays(vec![Ray::new(Vec3::new(0.0, 0.0, -1.0), Vec3::Z)]);
    let light = Light::Beam {
        center: Vec3::new(0.0, 0.0, -1.0),
        direction: Vec3::Z,
        radius: 0.1,
        irradiance: 1.0,
    };
    let host = AnalyticHost::sphere(fog(1e3, 1e6, 0.0), 0.5, Interface::Matched, light, view);
    for radii in BOTH {
        render(
            &host,
            &ProgressivePhotonMap::new().paths(20).radii(radii),
            2,
            1,
        );
    }
}

/// The energy that a scene of any size shows is the same.
#[test]
fn scale_does_not_matter() {
    let at = |scale: f32| {
        let light = Light::Point {
            position: Vec3::new(0.2, 0.1, 0.0) * scale,
            power: scale * scale,
        };
        let medium = fog(0.4 / scale, 1.6 / scale, 0.3);
        let host = AnalyticHost::sphere(medium, scale, Interface::Matched, light, chords(scale));
        measure(&host, &ProgressivePhotonMap::new().paths(1_000), 4, 0..40)[0]
    };
    let one = at(1.0);
    let cases = [1e-8, 1e8].map(|scale| ("difference", at(scale).difference(&one), 0.0));
    check_means(&cases, crate::FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

/// No light at all, light that misses, one path a pass, more photons asked for than there are.
#[test]
fn few_photons_are_finite() {
    let view = || View::Rays(vec![Ray::new(Vec3::new(0.0, 0.0, -2.0), Vec3::Z)]);
    let away = Light::Beam {
        center: Vec3::new(0.0, 9.0, 0.0),
        direction: Vec3::Z,
        radius: 0.1,
        irradiance: 1.0,
    };
    let lit = Light::Beam {
        center: Vec3::new(0.0, 0.0, -3.0),
        direction: Vec3::Z,
        radius: 0.1,
        irradiance: 1.0,
    };
    for radii in BOTH {
        for (light, dark) in [(Light::None, true), (away, true), (lit, false)] {
            let host =
                AnalyticHost::sphere(fog(0.1, 3.0, 0.0), 1.0, Interface::Matched, light, view());
            for method in [
                ProgressivePhotonMap::new().paths(1),
                ProgressivePhotonMap::new().paths(7).nearest(1_000_000),
                ProgressivePhotonMap::new()
                    .paths(7)
                    .max_radius(f32::INFINITY),
                ProgressivePhotonMap::new().paths(7).max_radius(1e-20),
            ] {
                let film = render(&host, &method.radii(radii), 50, 1);
                if dark {
                    assert!(film.iter().all(|v| *v == 0.0));
                }
            }
        }
    }
}

/// One path a pass finds, in as many passes, what a thousand do: nothing is lost where maps are
/// nearly empty.
#[test]
fn single_paths_add_up() {
    let host = floor(0.4);
    let method = ProgressivePhotonMap::new().radius(0.2).alpha(1.0);
    let single = measure(&host, &method.paths(1), 2_000, 0..12)[0];
    let many = measure(&host, &method.paths(1_000), 2, 100..124)[0];
    let cases = [("single − many", single.difference(&many), 0.0)];
    check_means(&cases, crate::FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

/// All photons of a beam without width that meets a wall lie at one point.
#[test]
fn all_photons_at_one_point_are_finite() {
    let host = floor(0.4);
    let spot = {
        use std::path::Path;
        use tyndall_scene_io::SceneFile;
        let text = r#"
            camera = { kind = "orthographic", position = [0, 0.5, 0], look_at = [0, 0, 0], width = 1e-6 }
            film = { width = 3, height = 3 }
            materials.floor = { kind = "diffuse", reflectance = 0.6 }
            lights = [{ kind = "beam", position = [0, 1, 0], direction = [0, -1, 0], radius = 1e-30, power = 1 }]
            shapes = [{ kind = "quad", corner = [-2, 0, 2], edge_u = [4, 0, 0], edge_v = [0, 0, -4], material = "floor" }]
        "#;
        let file = SceneFile::parse(text, Path::new("spot.toml"), &[]).expect("a scene");
        file.build::<f32>().expect("a host")
    };
    for radii in BOTH {
        let method = ProgressivePhotonMap::new().paths(1_000).radii(radii);
        render(&spot, &method, 5, 1);
        render(&host, &method.radius(1e-10), 5, 1);
        render(&host, &method.radius(1e12), 5, 1);
        let glare = render(&spot, &method.radius(1e-3), 5, 1);
        assert!(glare.iter().any(|v| *v > 0.0));
    }
}
