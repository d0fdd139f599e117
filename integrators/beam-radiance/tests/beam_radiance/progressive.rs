//! Radii that shrink.

use crate::{FALSE_ALARM, fog};
use glam::Vec3;
use tyndall_beam_radiance::{BeamRadiance, Blur};
use tyndall_core::Ray;
use tyndall_media::Homogeneous;
use tyndall_testkit::Run;
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::stats::Figures;
use tyndall_testkit::stats::log_log_slope;

#[test]
fn radiance_does_not_depend_on_how_paths_are_cut_into_passes() {
    let medium = fog(0.3_f32, 1.2, 0.4);
    let light = Light::Point {
        position: Vec3::new(0.5, 1.5, 0.3),
        power: 10.0,
    };
    let view = View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -2.5),
        forward: Vec3::Z,
        half_width: 0.3,
        pixels: 8,
    };
    let host = AnalyticHost::sphere(medium, 1.0, Interface::Matched, light, view);
    let mut figures = Figures::default();
    for method in [
        BeamRadiance::new().radius(0.3),
        BeamRadiance::new().nearest(20).blur(Blur::Ball),
    ] {
        let method = method.starting_paths(2_000);
        let run = |seed, passes, samples| Run {
            passes,
            samples,
            seed,
        };
        let few = run(2, 10, 16).measure(&host, &method.paths(16_000));
        for (paths, passes) in [(1_000, 160), (100, 1_600)] {
            let many = run(1, passes, 1).measure(&host, &method.paths(paths));
            figures.same(format!("{paths}: {method:?}"), many[0], few[0], 0.03);
        }
    }
    figures.check(FALSE_ALARM);
}

const SIGMA_T: f32 = 0.6;
const RARELY: f32 = 1e-4;
/// Distances of rays from the light.
const HEIGHTS: [f32; 4] = [0.5, 0.7, 1.0, 1.4];

fn airlights() -> AnalyticHost<Homogeneous<f32>> {
    let medium = fog(SIGMA_T * (1.0 - RARELY), SIGMA_T * RARELY, 0.0);
    let ray = |y: f32| Ray::new(Vec3::new(0.0, y, 0.0), Vec3::X);
    let view = View::Rays(HEIGHTS.map(ray).to_vec());
    AnalyticHost::infinite_medium(medium, Vec3::new(0.5, 0.0, 0.0), 1.0, view)
}

/// Root of the mean squared relative error after so many passes, over `runs` runs.
fn error(method: &BeamRadiance, passes: u64, runs: u64) -> f64 {
    let host = airlights();
    let expected = HEIGHTS.map(|h| {
        let (sigma_s, sigma_t) = (f64::from(SIGMA_T * RARELY), f64::from(SIGMA_T));
        airlight(sigma_s, sigma_t, f64::from(h), 0.5, f64::INFINITY)
    });
    let mut squares = 0.0;
    for seed in 0..runs {
        let run = Run {
            passes,
            samples: 1,
            seed: 1000 * passes + seed,
        };
        let mut sums = [0.0; HEIGHTS.len()];
        for pass in 0..passes {
            for (sum, value) in sums.iter_mut().zip(run.image(&host, method, pass)) {
                *sum += f64::from(value);
            }
        }
        for (sum, expected) in sums.iter().zip(expected) {
            squares += (sum / passes as f64 / expected - 1.0).powi(2);
        }
    }
    (squares / (runs as usize * HEIGHTS.len()) as f64).sqrt()
}

#[allow(clippy::print_stderr)] // a figure for whoever runs it by hand
fn slope(blur: Blur, lengths: &[u64], runs: u64) -> f64 {
    // The radius is that of a hundredth of a pass: from the first on, it falls as a power.
    let method = BeamRadiance::new()
        .paths(400)
        .starting_paths(4)
        .blur(blur)
        .radius(1.2);
    let points: Vec<_> = lengths
        .iter()
        .map(|&passes| (passes as f64, error(&method, passes, runs)))
        .collect();
    let fit = log_log_slope(&points);
    eprintln!("{blur:?}: {points:.4?} {fit:?}");
    fit.slope
}

/// Of 16 × 4 figures, no more independent than the rays, an error is known to 10 % or so, and the
/// slope over 2.8 e-foldings to 0.05.
#[test]
fn errors_fall_as_they_should() {
    let discs = slope(Blur::Disc, &[2, 8, 32], 16);
    assert!((discs + 1.0 / 3.0).abs() < 0.15, "{discs}");
    let balls = slope(Blur::Ball, &[2, 8, 32], 16);
    assert!((balls + 1.0 / 3.0).abs() < 0.15, "{balls}");
}

#[test]
#[ignore = "long: cargo test -p tyndall-beam-radiance --test beam_radiance slopes -- --ignored --nocapture"]
fn slopes_over_two_decades() {
    let lengths = [4, 12, 40, 120, 400];
    let discs = slope(Blur::Disc, &lengths, 60);
    assert!((discs + 1.0 / 3.0).abs() < 0.05, "{discs}");
    let balls = slope(Blur::Ball, &lengths, 60);
    assert!((balls + 1.0 / 3.0).abs() < 0.05, "{balls}");
}
