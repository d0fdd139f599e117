//! The path tracer where numbers run out: every sample is finite ([`measure`] asserts it), and where
//! the answer is known it is right. False alarms: 1e-3 a test, fixed seeds.

use glam::Vec3;
use tyndall_core::{Coefficients, Ray, Rgb, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::{Path, Scattering};
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, Interface, View};
use tyndall_testkit::stats::{check_means, sidak};
use tyndall_testkit::{measure, measure_mean};

fn fog(sigma_a: Rgb, sigma_s: Rgb, g: f32) -> Homogeneous<Rgb> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    };
    let phase = Phase::henyey_greenstein(g).expect("a valid mean cosine");
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}

/// The chord of a unit sphere through the middle, and one that only just touches it.
fn chords(scale: f32) -> View {
    let ray = |x: f32| Ray::new(Vec3::new(x, 0.0, -2.0) * scale, Vec3::Z);
    View::Rays(vec![ray(0.0), ray(0.999_99)])
}

#[test]
fn furnaces_from_empty_to_opaque() {
    let mut figures = Vec::new();
    for sigma_s in [0.0, 1e-12, 1e-6, 1.0, 30.0] {
        for g in [-0.999, 0.0, 0.999] {
            for scale in [1e-6, 1.0, 1e6] {
                let medium = fog(
                    Rgb::default(),
                    Rgb::new(1.0, 0.1, 0.0) * (sigma_s / scale),
                    g,
                );
                let host = AnalyticHost::furnace(medium, scale, Interface::Matched, chords(scale));
                let values = measure(&host, &Path::new(), 500, 1);
                // The grazing chord, 0.009 long, meets too few collisions for statistics.
                assert!(
                    values[3..].iter().all(|e| (0.5..1.5).contains(&e.mean)),
                    "{values:?}"
                );
                for (i, e) in values[..3].iter().enumerate() {
                    figures.push((
                        format!("σs {sigma_s} g {g} scale {scale} channel {i}"),
                        *e,
                        1.0,
                    ));
                }
            }
        }
    }
    let cases: Vec<_> = figures
        .iter()
        .map(|(n, e, x)| (n.as_str(), *e, *x))
        .collect();
    check_means(&cases, 1e-3).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn white_media_a_hundred_mean_free_paths_thick_lose_nothing() {
    // Walks scatter thousands of times here: a roulette that ends them has infinite variance.
    let medium = fog(Rgb::default(), Rgb::new(300.0, 200.0, 100.0), 0.0);
    let view = View::Rays(vec![Ray::new(Vec3::new(0.2, 0.0, -2.0), Vec3::Z)]);
    let host = AnalyticHost::furnace(medium, 1.0, Interface::Matched, view);
    let values = measure(&host, &Path::new(), 5_000, 1);
    let cases: Vec<_> = values.into_iter().map(|e| ("white ball", e, 1.0)).collect();
    check_means(&cases, 1e-3).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn opaque_media_that_absorb_are_black_inside_and_finite() {
    for sigma_a in [1e3, 1e6] {
        for sigma_s in [0.0, 1e3, 1e6] {
            let medium = fog(Rgb::new(sigma_a, 0.0, 1.0), Rgb::splat(sigma_s), 0.9);
            let view = View::Fluence {
                position: Vec3::ZERO,
            };
            let host = AnalyticHost::furnace(medium, 1.0, Interface::Matched, view);
            let fluence = measure(&host, &Path::new().max_depth(200), 200, 1);
            // A ball of optical radius 1000 lets exp(−1000) through.
            assert_eq!(fluence[0].mean, 0.0, "σa {sigma_a}, σs {sigma_s}");
        }
    }
}

#[test]
fn a_light_close_to_the_ray_is_right_and_one_on_it_finite() {
    let medium = fog(Rgb::splat(0.1), Rgb::new(0.5, 1.0, 2.0), 0.0);
    let h = 1e-3;
    let view = View::Rays(vec![Ray::new(Vec3::new(0.0, h, -3.0), Vec3::Z)]);
    let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, Rgb::splat(1.0), view);
    let path = Path::new().scattering(Scattering::Single);
    let cases: Vec<_> = measure(&host, &path, 20_000, 1)
        .into_iter()
        .zip([0.5, 1.0, 2.0])
        .map(|(e, s)| {
            (
                "glow",
                e,
                airlight(s, s + 0.1, f64::from(h), 3.0, f64::INFINITY),
            )
        })
        .collect();
    check_means(&cases, 1e-3).unwrap_or_else(|why| panic!("{why}"));
    // The sensor looks straight at the point light, and stands in it.
    for origin in [Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO] {
        let view = View::Rays(vec![Ray::new(origin, Vec3::Z)]);
        let medium = fog(Rgb::splat(0.1), Rgb::new(0.5, 1.0, 1e6), 0.0);
        let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, Rgb::splat(1.0), view);
        measure(&host, &Path::new().max_depth(50), 2_000, 1);
    }
}

#[test]
fn albedo_zero_scatters_nothing_and_albedo_one_loses_nothing() {
    let light_rays = View::Fluence {
        position: Vec3::new(0.3, 0.0, 0.0),
    };
    let dark = fog(Rgb::new(0.2, 1.0, 4.0), Rgb::default(), 0.3);
    let host = AnalyticHost::infinite_medium(dark, Vec3::ZERO, Rgb::splat(1.0), light_rays);
    let fluence = measure(&host, &Path::new(), 1_000, 1);
    assert!(fluence.iter().all(|e| e.mean == 0.0));
    // A ball without absorption in a furnace has the fluence of the furnace, 4π, inside.
    let white = fog(Rgb::default(), Rgb::new(0.2, 1.0, 4.0), 0.3);
    let view = View::Fluence {
        position: Vec3::new(0.3, 0.0, 0.0),
    };
    let host = AnalyticHost::furnace(white, 1.0, Interface::Matched, view);
    let each = sidak(1e-3, 3);
    for (channel, estimate) in measure_mean(&host, &Path::new(), 20_000, 1)
        .into_iter()
        .enumerate()
    {
        let name = format!("channel {channel} of {}", Rgb::CHANNELS);
        tyndall_testkit::stats::assert_mean(&name, estimate, 4.0 * std::f64::consts::PI, each);
    }
}
