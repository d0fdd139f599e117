//! How fast the error falls: as passes^−1/3 on surfaces and passes^−2/7 in media (Knaus & Zwicker
//! 2011), over two decades.
//!
//! At the optimal α noise and bias fall alike, so that the law holds from the first passes on if
//! nothing else is as large. Hence: passes of so few paths that a radius holds less than one of
//! their photons, for the strata of the emission keep the noise of more below what chance gives;
//! walks of sight without noise of their own, which would fall as
//! passes^−1/2; radii so small that the bias is as their square; and a starting radius that is
//! meant for a single light path, so that radii are a pure power of the paths from the first pass
//! on. Every length has seeds of its own.

use crate::closed_form::floor;
use crate::{fog, render};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{AnyIntegrator, Ray, Sensor};
use tyndall_driver::PassStreams;
use tyndall_progressive_photon_map::ProgressivePhotonMap;
use tyndall_testkit::hosts::{AnalyticHost, Boundary, Light, View};
use tyndall_testkit::stats::{Slope, log_log_slope};

/// Root mean square error over pixels and seeds, after `passes`.
fn error<H: Sensor>(
    host: &H,
    method: &dyn AnyIntegrator<H, PassStreams>,
    reference: &[f64],
    passes: u64,
    seeds: u64,
) -> f64 {
    let squares = (0..seeds).flat_map(|seed| {
        let film = render(host, method, passes, passes * 1_000 + seed);
        film.into_iter()
            .zip(reference)
            .map(|(a, b)| (a - b).powi(2))
    });
    let squares: Vec<f64> = squares.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[expect(clippy::print_stderr, reason = "the figures of the long test")]
fn slope<H: Sensor>(
    host: &H,
    method: &dyn AnyIntegrator<H, PassStreams>,
    reference: &[f64],
    lengths: &[u64],
    seeds: u64,
) -> Slope {
    let points: Vec<_> = lengths
        .iter()
        .map(|&passes| (passes as f64, error(host, method, reference, passes, seeds)))
        .collect();
    let slope = log_log_slope(&points);
    let power = slope.slope;
    eprintln!("{points:?}: {power:.3} ± {:.3}", slope.standard_error);
    slope
}

/// The lamp lights the floor with I/(1 + ρ²)^1.5, of which a pixel shows the mean (Simpson's rule).
fn lit_floor(width: f64, pixels: usize) -> Vec<f64> {
    let side = width / pixels as f64;
    let edge = |i: usize, t: f64| (i as f64 + t) * side - 0.5 * width;
    let nodes = [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
    let pixel = |x: usize, y: usize| -> f64 {
        let terms = nodes.iter().flat_map(|(s, a)| {
            nodes.iter().map(move |(t, b)| {
                let square = edge(x, *s).powi(2) + edge(y, *t).powi(2);
                a * b * (1.0 + square).powf(-1.5)
            })
        });
        0.6 / PI * 4.0 / (4.0 * PI) * terms.sum::<f64>()
    };
    (0..pixels * pixels)
        .map(|i| pixel(i % pixels, i / pixels))
        .collect()
}

/// With a radius of 0.4 after the first length: the bias is 0.4²/2 of the light below the lamp.
fn on_a_floor(lengths: &[u64], seeds: u64) -> Slope {
    let (host, paths) = (floor(3.0), 10);
    let radius = 0.4 * ((lengths[0] * paths) as f32).powf(1.0 / 6.0);
    let method = ProgressivePhotonMap::new().radius(radius).starting_paths(1);
    let reference = lit_floor(3.0, 8);
    slope(&host, &method.paths(paths), &reference, lengths, seeds)
}

/// Six rays across a wide beam in a medium that hardly scatters. Where they see, the light is the
/// same along each: E a exp(−σt x)/4π to the albedo a of 1e-4, and their walks have no noise. With
/// a radius of 0.5 after the first length the bias is 0.5² σt²/14 of the light.
fn in_fog(lengths: &[u64], seeds: u64) -> Slope {
    let paths = 20;
    let (sigma_t, albedo, x) = (3.0_f32, 1e-4, 0.8);
    let rays = (0..6).map(|i| {
        let (sin, cos) = (i as f32 * std::f32::consts::FRAC_PI_3).sin_cos();
        Ray::new(Vec3::new(x, cos, sin), Vec3::new(0.0, -sin, cos))
    });
    let host = AnalyticHost {
        boundary: Boundary::Nowhere,
        medium: fog(sigma_t * (1.0 - albedo), sigma_t * albedo, 0.0),
        light: Light::Beam {
            center: Vec3::ZERO,
            direction: Vec3::X,
            radius: 3.0,
            irradiance: 1.0,
        },
        view: View::Rays(rays.collect()),
    };
    let light = f64::from(albedo * (-sigma_t * x).exp()) / (4.0 * PI);
    let radius = 0.5 * ((lengths[0] * paths) as f32).powf(1.0 / 7.0);
    let method = ProgressivePhotonMap::new().radius(radius).starting_paths(1);
    slope(&host, &method.paths(paths), &[light; 6], lengths, seeds)
}

/// A short render is mostly noise.
#[test]
fn surfaces() {
    let found = on_a_floor(&[20, 200, 2_000], 10);
    assert!((found.slope + 1.0 / 3.0).abs() < 0.05, "{found:?}");
}

/// As on surfaces.
#[test]
fn media() {
    let found = in_fog(&[20, 200, 2_000], 48);
    assert!((found.slope + 2.0 / 7.0).abs() < 0.05, "{found:?}");
}

/// Noise and bias alike.
#[test]
#[ignore = "long: cargo test -p tyndall-progressive-photon-map two_decades -- --ignored --nocapture"]
fn two_decades() {
    let lengths = [100, 316, 1_000, 3_162, 10_000];
    let surfaces = on_a_floor(&lengths, 16);
    let media = in_fog(&lengths, 48);
    assert!((surfaces.slope + 1.0 / 3.0).abs() < 0.05, "{surfaces:?}");
    assert!((media.slope + 2.0 / 7.0).abs() < 0.05, "{media:?}");
}
