//! Tables and flights, against what they estimate. False alarms: 1e-4, fixed seeds.

use glam::Vec3;
use tyndall_core::{Aabb, Coefficients, Medium, Ray, Rgb, Sampler, Spectrum};
use tyndall_media::{Atmosphere, DenseGrid, GridMedium, Homogeneous, Phase, plume};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Estimate, Moments, check_means};
use tyndall_walk::{DepthTable, Flights};

const FALSE_ALARM: f64 = 1e-4;

const BOX: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

fn per_density(sigma_a: Rgb, sigma_s: Rgb) -> Coefficients<Rgb> {
    Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    }
}

fn haze(height: f32) -> Atmosphere<Rgb> {
    let coefficients = per_density(Rgb::new(0.1, 0.0, 0.4), Rgb::new(0.9, 0.5, 1.6));
    Atmosphere::new(Vec3::ZERO, Vec3::Y, height, coefficients, Phase::Isotropic)
        .expect("an atmosphere")
}

fn smoke(scale: f32) -> GridMedium<Rgb> {
    let density = plume([32, 32, 32], BOX, 3).expect("a plume");
    let coefficients = per_density(
        Rgb::new(0.5, 0.0, 2.0) * scale,
        Rgb::new(2.0, 5.0, 9.0) * scale,
    );
    GridMedium::new(density, coefficients, Phase::Isotropic).expect("a medium")
}

/// A grid whose voxels have nothing to do with each other, with empty ones.
fn noise() -> GridMedium<Rgb> {
    let mut sampler = rng(5);
    let voxel = |_| (3.0 * sampler.next_1d() - 1.0).max(0.0);
    let grid = DenseGrid::new([12, 12, 12], BOX, (0..1728).map(voxel).collect()).expect("a grid");
    let coefficients = per_density(Rgb::new(0.5, 0.0, 2.0), Rgb::new(1.0, 3.0, 0.0));
    GridMedium::new(grid, coefficients, Phase::Isotropic).expect("a medium")
}

fn rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut sampler = rng(seed);
    let mut ray = || {
        let [a, b, c, d, e, f] = sampler.next().map(|u| 2.0 * u - 1.0);
        let (from, to) = (Vec3::new(a, b, c) * 1.5, Vec3::new(d, e, f));
        Ray::new(from, (to - from).normalize()).up_to(3.0)
    };
    (0..count).map(|_| ray()).collect()
}

/// Transmittance by the midpoints of very many steps; grids may jump where they end.
fn fine<M: Medium<Spectrum = Rgb>>(medium: &M, ray: &Ray, ends: &[f32]) -> Vec<[f64; 3]> {
    let sides = [BOX.min, BOX.max].map(|side| (side - ray.origin) / ray.direction);
    let enter = sides[0].min(sides[1]).max_element();
    let leave = sides[0].max(sides[1]).min_element();
    let mut depth = [0.0; 3];
    let mut before = 0.0_f32;
    let mut at = |&end: &f32| {
        let breaks = [enter, leave.max(enter), end].map(|t| t.clamp(before, end));
        for t in breaks {
            let step = f64::from(t - before) / 512.0;
            for i in 0..512 {
                let t = f64::from(before) + step * (f64::from(i) + 0.5);
                let sigma_t = medium.coefficients(ray.at(t as f32)).sigma_t();
                for (c, depth) in depth.iter_mut().enumerate() {
                    *depth += step * f64::from(sigma_t.channel(c));
                }
            }
            before = t;
        }
        depth.map(|depth| (-depth).exp())
    };
    ends.iter().map(&mut at).collect()
}

/// The largest error reported over many rays; none of the true ones is larger than that of its ray.
fn errors<M: Medium<Spectrum = Rgb>>(medium: &M, max_error: f32) -> f64 {
    let mut table = DepthTable::default();
    let mut largest = 0.0_f64;
    for ray in rays(25, 1) {
        let reported = f64::from(table.measure(medium, &ray, max_error));
        let ends: Vec<f32> = (1..=41).map(|i| i as f32 * (3.0 / 41.0)).collect();
        for (&t, expected) in ends.iter().zip(fine(medium, &ray, &ends)) {
            let depth = table.depth(t);
            for (c, expected) in expected.iter().enumerate() {
                let off = ((-f64::from(depth.channel(c))).exp() - expected).abs();
                assert!(
                    off <= reported + 2e-5,
                    "{off} at {t}, {reported} reported: {ray:?}"
                );
            }
        }
        largest = largest.max(reported);
    }
    largest
}

#[test]
fn a_table_errs_no_more_than_it_says() {
    for max_error in [1e-1, 1e-2, 1e-3, 1e-4] {
        let bound = f64::from(max_error);
        let found = [
            ("haze", errors(&haze(0.5), max_error)),
            ("smoke", errors(&smoke(1.0), max_error)),
            ("dense smoke", errors(&smoke(50.0), max_error)),
            ("noise", errors(&noise(), max_error)),
        ];
        for (name, reported) in found {
            assert!(
                reported <= 1.05 * bound,
                "{name} at {max_error}: {reported}"
            );
        }
    }
}

#[test]
fn a_table_ends_where_nothing_is_seen_and_where_nothing_is() {
    let mut table = DepthTable::default();
    let up = Ray::new(Vec3::ZERO, Vec3::Y).up_to(f32::MAX);
    assert!(table.measure(&haze(1.0), &up, 1e-3) <= 1e-3);
    assert!((table.depth(1e30).channel(0) - 1.0).abs() < 2e-3);
    // Down, its density grows for ever.
    let down = Ray::new(Vec3::ZERO, -Vec3::Y).up_to(f32::MAX);
    assert!(table.measure(&haze(1.0), &down, 1e-3) <= 1e-3);
    assert!(table.depth(1e9).channel(1) > 87.0);
    let beside = Ray::new(5.0 * Vec3::ONE, Vec3::X).up_to(1e9);
    assert_eq!(table.measure(&smoke(1.0), &beside, 1e-3), 0.0);
    assert_eq!(table.depth(3.0), Rgb::default());
    // In the densest a distance in `f32` may be a hundredth of a mean free path.
    for (scale, bound) in [(1e4, 1.0), (1e2, 1e-3), (1e-30, 1e-3)] {
        let through = Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z).up_to(6.0);
        let reported = table.measure(&smoke(scale), &through, 1e-3);
        assert!(reported <= bound, "{scale}: {reported}");
        assert!(table.depth(6.0).is_finite());
    }
}

#[test]
fn flights_are_unbiased_everywhere_at_once() {
    let even = per_density(Rgb::new(0.0, 0.5, 0.0), Rgb::new(0.4, 0.6, 2.0));
    let even = Homogeneous::new(even, Phase::Isotropic).expect("a medium");
    let mut figures = Vec::new();
    check_flights("even", &even, &mut figures);
    check_flights("smoke", &smoke(0.4), &mut figures);
    check_flights("haze", &haze(1.0), &mut figures);
    let cases: Vec<_> = (figures.iter())
        .map(|(name, estimate, expected)| (name.as_str(), *estimate, *expected))
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

fn check_flights<M: Medium<Spectrum = Rgb>>(
    name: &str,
    medium: &M,
    figures: &mut Vec<(String, Estimate, f64)>,
) {
    let ray = Ray::new(
        Vec3::new(-0.1, -0.8, -0.9),
        Vec3::new(0.1, 0.6, 0.8).normalize(),
    )
    .up_to(1.9);
    let ends = [0.3, 0.9, 1.4, 1.899];
    let expected = fine(medium, &ray, &ends);
    let mut moments = vec![[Moments::new(); 3]; ends.len()];
    let (mut flights, mut sampler) = (Flights::default(), rng(3));
    // An importance that no channel deserves.
    let importance = Rgb::new(0.2, 3.0, 1.0);
    for _ in 0..40_000 {
        flights.fly(medium, &ray, 3, importance, &mut sampler);
        for (moments, &t) in moments.iter_mut().zip(&ends) {
            let estimate = flights.transmittance(t);
            for (c, moments) in moments.iter_mut().enumerate() {
                moments.push(f64::from(estimate.channel(c)));
            }
        }
    }
    for ((moments, expected), t) in moments.iter().zip(&expected).zip(ends) {
        for (c, expected) in expected.iter().enumerate() {
            let name = format!("{name} to {t} channel {c}");
            let estimate = moments[c].estimate();
            // Or it would test nothing.
            assert!(estimate.relative_standard_error() <= 0.02, "{name}");
            figures.push((name, estimate, *expected));
        }
    }
}
