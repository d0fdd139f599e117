//! The path tracer where media overlap. False alarms: 0.27 % a test (three standard errors of a
//! normal distribution), Šidák-corrected within it; fixed seeds.

use glam::Vec3;
use std::sync::Arc;
use tyndall_core::{Aabb, Coefficients, Rgb};
use tyndall_media::{AnyMedium, Atmosphere, GridMedium, Homogeneous, Overlap, Phase, plume};
use tyndall_path::Path;
use tyndall_testkit::hosts::{AnalyticHost, Interface, View};
use tyndall_testkit::measure_mean;
use tyndall_testkit::stats::check_means;

const FALSE_ALARM: f64 = 0.0027;

fn scattering(sigma_s: Rgb) -> Coefficients<Rgb> {
    Coefficients {
        sigma_a: Rgb::default(),
        sigma_s,
        emission: Rgb::default(),
    }
}

/// Smoke, haze over the ground and fog, of three colours and phase functions.
fn mist() -> Overlap<Rgb> {
    let bounds = Aabb {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };
    let density = plume([24, 24, 24], bounds, 3).expect("a plume");
    let forward = Phase::henyey_greenstein(0.6).expect("a valid mean cosine");
    let smoke = GridMedium::new(density, scattering(Rgb::new(2.0, 9.0, 20.0)), forward);
    let blue = scattering(Rgb::new(0.1, 0.3, 1.0));
    let haze = Atmosphere::new(-Vec3::Y, Vec3::Y, 0.5, blue, Phase::Isotropic);
    let backward = Phase::henyey_greenstein(-0.4).expect("a valid mean cosine");
    let fog = Homogeneous::new(scattering(Rgb::new(0.8, 0.2, 0.0)), backward);
    let parts = vec![
        AnyMedium::Grid(Arc::new(smoke.expect("a medium"))),
        AnyMedium::Atmosphere(haze.expect("a medium")),
        AnyMedium::Homogeneous(fog.expect("a medium")),
    ];
    Overlap::new(parts).expect("three media")
}

/// All albedos are 1: from outside of the ball and from inside of the smoke, in air and in glass,
/// everything looks like the walls of the furnace.
#[test]
fn the_furnace_is_white_where_media_overlap() {
    let mut figures = Vec::new();
    for (name, interface, inside) in [
        ("matched", Interface::Matched, 1.0),
        ("glass", Interface::Dielectric(1.5), 2.25),
    ] {
        for (distance, expected) in [(2.0, 1.0), (0.3, inside)] {
            let view = View::Pinhole {
                eye: Vec3::new(0.0, 0.0, -distance),
                forward: Vec3::Z,
                half_width: 0.4,
                pixels: 4,
            };
            let host = AnalyticHost::furnace(mist(), 1.0, interface, view);
            let channels = measure_mean(&host, &Path::new(), 8_000, 1);
            for (i, estimate) in channels.into_iter().enumerate() {
                let precision = estimate.relative_standard_error();
                assert!(precision <= 0.006, "{name} {distance}: {precision:.4}");
                figures.push((format!("{name} {distance} channel {i}"), estimate, expected));
            }
        }
    }
    let cases: Vec<_> = figures
        .iter()
        .map(|(n, e, x)| (n.as_str(), *e, *x))
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}
