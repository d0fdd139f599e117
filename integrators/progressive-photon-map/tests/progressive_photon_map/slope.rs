//! How fast the error falls: as passes^−1/3 on surfaces and passes^−2/7 in media (Knaus & Zwicker
//! 2011), over two decades.
//!
//! At the optimal α noise and bias fall alike, so that the law holds from the first passes on if
//! nothing else is as large: the noise of the walks of sight falls faster, as passes^−1/2, and is
//! kept small by passes of few light paths. Noise and bias are both there: radii are wide, so that
//! neither a wrong schedule nor a wrong estimate keeps the slope. Every length has seeds of its own.

use crate::closed_form::floor;
use crate::{fog, render, sphere_of_rays};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{AnyIntegrator, Ray, Sensor};
use tyndall_driver::PassStreams;
use tyndall_progressive_photon_map::ProgressivePhotonMap;
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, View};
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

fn on_a_floor(lengths: &[u64], seeds: u64) -> Slope {
    let host = floor(3.0);
    let method = ProgressivePhotonMap::new()
        .radius(0.6)
        .paths(250)
        .starting_paths(250);
    slope(&host, &method, &lit_floor(3.0, 8), lengths, seeds)
}

/// Rays that pass a lamp in a medium that hardly scatters: airlight, to the albedo of 1e-4. Each
/// ray has its own side of the lamp.
fn in_fog(lengths: &[u64], seeds: u64) -> Slope {
    let (sigma_t, albedo) = (1.0_f32, 1e-4);
    let rays = sphere_of_rays(Vec3::ZERO, 12).into_iter().map(|ray| {
        let side = ray.direction;
        let across = side.any_orthonormal_vector();
        Ray::new(side - across, across)
    });
    let medium = fog(sigma_t * (1.0 - albedo), sigma_t * albedo, 0.0);
    let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, 1.0, View::Rays(rays.collect()));
    let light = airlight(
        f64::from(sigma_t * albedo),
        f64::from(sigma_t),
        1.0,
        1.0,
        f64::INFINITY,
    );
    let method = ProgressivePhotonMap::new()
        .radius(0.8)
        .paths(10)
        .starting_paths(10);
    slope(&host, &method, &[light; 12], lengths, seeds)
}

#[test]
fn surfaces() {
    let found = on_a_floor(&[5, 50, 500], 12);
    assert!((found.slope + 1.0 / 3.0).abs() < 0.05, "{found:?}");
}

#[test]
fn media() {
    let found = in_fog(&[5, 50, 500], 60);
    assert!((found.slope + 2.0 / 7.0).abs() < 0.05, "{found:?}");
}

#[test]
#[ignore = "long: cargo test -p tyndall-progressive-photon-map slope -- --ignored"]
fn two_decades() {
    let lengths = [10, 32, 100, 316, 1_000, 3_162];
    let surfaces = on_a_floor(&lengths, 20);
    assert!((surfaces.slope + 1.0 / 3.0).abs() < 0.05, "{surfaces:?}");
    let media = in_fog(&lengths, 100);
    assert!((media.slope + 2.0 / 7.0).abs() < 0.05, "{media:?}");
}
