//! Delta, ratio and regular tracking agree with closed forms and with each other.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::rays::{BOUNDS, awkward_rays, noise, ray};
use glam::Vec3;
use tyndall_core::{Coefficients, Medium, Ray, Rgb, Sampler, Spectrum};
use tyndall_media::{DenseGrid, Filter, GridMedium, Homogeneous, Phase, Tracking};
use tyndall_testkit::{
    rng,
    stats::{Estimate, Moments, check_means, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;

fn grid_medium<S: Spectrum>(
    density: DenseGrid,
    sigma_a: S,
    sigma_s: S,
    emission: S,
) -> GridMedium<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission,
    };
    GridMedium::new(density, coefficients, Phase::Isotropic).unwrap()
}

fn constant(density: f32, resolution: [usize; 3]) -> DenseGrid {
    let voxels = resolution.iter().product();
    DenseGrid::new(resolution, BOUNDS, vec![density; voxels]).unwrap()
}

/// Through the box along +x, entering after 1, 3 long inside.
fn across() -> Ray {
    Ray::new(BOUNDS.center() - 2.5 * Vec3::X, Vec3::X)
}

/// Three channels, extinctions 0.06 to 6 per unit density: a factor of 100.
fn chromatic(density: DenseGrid) -> GridMedium<Rgb> {
    let (sigma_a, sigma_s) = (Rgb::new(0.01, 0.3, 2.0), Rgb::new(0.05, 0.3, 4.0));
    grid_medium(density, sigma_a, sigma_s, Rgb::default())
}

/// Distances of the collisions among `count` free flights.
fn distances(medium: &impl Medium<Spectrum = f32>, ray: &Ray, count: usize) -> Vec<f64> {
    let mut sampler = rng(count as u64);
    (0..count)
        .filter_map(|_| medium.sample_free_flight(ray, 1.0, &mut sampler).collision)
        .map(|collision| f64::from(collision.t))
        .collect()
}

#[test]
fn distances_in_a_constant_grid_are_exponential() {
    let medium = grid_medium(constant(0.8, [20, 9, 3]), 0.25, 1.0, 0.0);
    let cdf = |t: f64| (-(t - 1.0).clamp(0.0, 3.0)).exp_m1() / (-3.0_f64).exp_m1();
    let mut t = distances(&medium, &across(), 200_000);
    kolmogorov_smirnov(&mut t, cdf, FALSE_ALARM).unwrap();
}

/// Density x/3 + ⅙ over x in \[0, 3\] of 30 voxels, constant in the outer half voxels: there the
/// optical depth is a parabola, and the majorant steps three times.
#[test]
fn distances_in_a_ramp_follow_its_distribution() {
    let value = |i: usize| (i as f32 + 0.5) / 30.0 + 1.0 / 6.0;
    let ramp = DenseGrid::new([30, 1, 1], BOUNDS, (0..30).map(value).collect()).unwrap();
    let medium = grid_medium(ramp, 0.0, 2.0, 0.0);
    let depth = |t: f64| {
        let x = (t - 1.0).clamp(0.0, 3.0);
        let (first, last) = (x.min(0.05), (x - 2.95).max(0.0));
        let middle = x.clamp(0.05, 2.95);
        let linear = (middle * middle - 0.05 * 0.05) / 6.0 + (middle - 0.05) / 6.0;
        2.0 * (first * (0.05 / 3.0 + 1.0 / 6.0) + linear + last * (2.95 / 3.0 + 1.0 / 6.0))
    };
    let tau = f64::from(medium.optical_depth(&across()));
    assert!((tau - depth(4.0)).abs() < 1e-6, "{tau} for {}", depth(4.0));
    let cdf = |t: f64| (-depth(t)).exp_m1() / (-depth(4.0)).exp_m1();
    let mut t = distances(&medium, &across(), 200_000);
    kolmogorov_smirnov(&mut t, cdf, FALSE_ALARM).unwrap();
}

#[test]
fn ratio_tracking_is_unbiased() {
    let mut sampler = rng(1);
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for filter in [Filter::Trilinear, Filter::Nearest] {
        let density = noise([25, 11, 18], &mut sampler).with_filter(filter);
        let medium = chromatic(density);
        for _ in 0..30 {
            let ray = ray(&mut sampler);
            let depth = medium.optical_depth(&ray);
            let mut moments = [Moments::new(); 3];
            for _ in 0..10_000 {
                let transmittance = medium.transmittance(&ray, &mut sampler);
                (0..3).for_each(|c| moments[c].push(f64::from(transmittance.channel(c))));
            }
            // Where a transmittance of 1e-3 comes from a few samples, their mean is not normal.
            let thick = |c: &usize| depth.channel(*c) > 4.0;
            cases.extend((0..3).filter(|c| !thick(c)).map(|c| {
                let expected = (-f64::from(depth.channel(c))).exp();
                ("transmittance", moments[c].estimate(), expected)
            }));
        }
    }
    assert!(cases.len() > 100);
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// Optical depths of about 5: most estimates end by Russian roulette.
#[test]
fn ratio_tracking_is_unbiased_where_it_plays_roulette() {
    let mut sampler = rng(8);
    let medium = grid_medium(noise([25, 11, 18], &mut sampler), 1.0, 3.0, 0.0);
    let depth = f64::from(medium.optical_depth(&across()));
    assert!((4.0..7.0).contains(&depth), "{depth}");
    let moments: Moments = (0..400_000)
        .map(|_| f64::from(medium.transmittance(&across(), &mut sampler)))
        .collect();
    let case = ("transmittance", moments.estimate(), (-depth).exp());
    check_means(&[case], FALSE_ALARM).unwrap();
}

#[test]
fn regular_tracking_is_exact() {
    let medium = chromatic(constant(0.8, [5, 6, 7])).with_tracking(Tracking::Regular);
    let transmittance = medium.transmittance(&across(), &mut rng(0));
    for (c, sigma_t) in [0.06, 0.6, 6.0].into_iter().enumerate() {
        let expected = f64::exp(-3.0 * 0.8 * sigma_t);
        assert!((f64::from(transmittance.channel(c)) / expected - 1.0).abs() < 1e-5);
    }
}

/// Per channel: the weight of collisions before x has mean 1 − Tr(x), that of passing Tr(t_max);
/// and Σ importance·weight is Σ importance whatever happens.
#[test]
fn free_flights_are_unbiased_in_every_channel() {
    let mut sampler = rng(2);
    let medium = chromatic(noise([25, 11, 18], &mut sampler));
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for importance in [Rgb::splat(1.0), Rgb::new(2.0, 0.5, 0.1)] {
        for x in [1.5, 2.2, 3.0] {
            let ray = across().up_to(3.5);
            let (before, passed) = flights(&medium, &ray, x, importance, &mut sampler);
            let early = medium.optical_depth(&ray.up_to(x));
            let whole = medium.optical_depth(&ray);
            for c in 0..3 {
                let transmittance = |tau: Rgb| (-f64::from(tau.channel(c))).exp();
                cases.push(("before", before[c].estimate(), 1.0 - transmittance(early)));
                cases.push(("passed", passed[c].estimate(), transmittance(whole)));
            }
        }
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

fn flights(
    medium: &impl Medium<Spectrum = Rgb>,
    ray: &Ray,
    x: f32,
    importance: Rgb,
    sampler: &mut impl Sampler,
) -> ([Moments; 3], [Moments; 3]) {
    let (mut before, mut passed) = ([Moments::new(); 3], [Moments::new(); 3]);
    for _ in 0..100_000 {
        let flight = medium.sample_free_flight(ray, importance, sampler);
        let conserved = (importance * flight.weight).sum() / importance.sum();
        assert!((conserved - 1.0).abs() < 1e-5, "{flight:?}");
        for c in 0..3 {
            let weight = f64::from(flight.weight.channel(c));
            let early = flight.collision.is_some_and(|collision| collision.t < x);
            before[c].push(if early { weight } else { 0.0 });
            passed[c].push(if flight.collision.is_none() {
                weight
            } else {
                0.0
            });
        }
    }
    (before, passed)
}

/// The density of distances is Σ pmf·σt·Tr over the channels, hence their distribution
/// Σ pmf·(1 − Tr) with exact transmittances.
#[test]
fn distances_follow_the_mixture_of_channels() {
    let mut sampler = rng(3);
    let medium = chromatic(noise([12, 4, 4], &mut sampler));
    let (importance, pmf) = (Rgb::new(1.0, 2.0, 0.5), [1.0, 2.0, 0.5].map(|x| x / 3.5));
    let mut t: Vec<f64> = (0..100_000)
        .filter_map(|_| {
            medium
                .sample_free_flight(&across(), importance, &mut sampler)
                .collision
        })
        .map(|collision| f64::from(collision.t))
        .collect();
    let collided = t.len() as f64 / 100_000.0;
    const STEPS: usize = 6000;
    let cdf: Vec<f64> = (0..=STEPS)
        .map(|i| {
            let t = 1.0 + 3.0 * i as f32 / STEPS as f32;
            let depth = medium.optical_depth(&across().up_to(t));
            (0..3)
                .map(|c| pmf[c] * -(-f64::from(depth.channel(c))).exp_m1())
                .sum()
        })
        .collect();
    // Binomial: 5 standard deviations, false alarm 6e-7.
    let deviation = (collided * (1.0 - collided) / 100_000.0).sqrt();
    assert!(
        (cdf[STEPS] - collided).abs() < 5.0 * deviation,
        "{} for {collided}",
        cdf[STEPS]
    );
    let lookup = |t: f64| {
        let x = (t - 1.0) / 3.0 * STEPS as f64;
        let i = (x as usize).min(STEPS - 1);
        (cdf[i] + (x - i as f64) * (cdf[i + 1] - cdf[i])) / cdf[STEPS]
    };
    kolmogorov_smirnov(&mut t, lookup, FALSE_ALARM).unwrap();
}

#[test]
fn a_constant_grid_is_a_homogeneous_medium() {
    let coefficients = Coefficients {
        sigma_a: Rgb::new(0.02, 0.4, 1.0),
        sigma_s: Rgb::new(0.1, 0.3, 2.0),
        emission: Rgb::new(3.0, 2.0, 1.0),
    };
    let homogeneous = Homogeneous::new(coefficients, Phase::Isotropic).unwrap();
    let grid = GridMedium::new(constant(1.0, [9, 20, 3]), coefficients, Phase::Isotropic).unwrap();
    let inside = Ray::new(BOUNDS.min + 0.3, Vec3::new(0.36, 0.48, 0.8)).up_to(1.3);
    assert_eq!(grid.coefficients(inside.at(1.0)), coefficients);
    let importance = Rgb::new(1.0, 0.6, 0.3);
    let mut sampler = rng(4);
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    let (before, passed) = flights(&grid, &inside, 0.7, importance, &mut sampler);
    let transmitted = homogeneous.transmittance(&inside, &mut sampler);
    let early = homogeneous.transmittance(&inside.up_to(0.7), &mut sampler);
    let emitted = homogeneous.emitted(&inside, &mut sampler);
    let mut glow = [Moments::new(); 3];
    let mut ratio = [Moments::new(); 3];
    for _ in 0..100_000 {
        let (g, r) = (
            grid.emitted(&inside, &mut sampler),
            grid.transmittance(&inside, &mut sampler),
        );
        for c in 0..3 {
            glow[c].push(f64::from(g.channel(c)));
            ratio[c].push(f64::from(r.channel(c)));
        }
    }
    for c in 0..3 {
        let [transmitted, early, emitted] =
            [transmitted, early, emitted].map(|s| f64::from(s.channel(c)));
        cases.push(("transmittance", ratio[c].estimate(), transmitted));
        cases.push(("emitted", glow[c].estimate(), emitted));
        cases.push(("before", before[c].estimate(), 1.0 - early));
        cases.push(("passed", passed[c].estimate(), transmitted));
    }
    check_means(&cases, FALSE_ALARM).unwrap();
    for t in [0.0, 0.5, 1.2] {
        let (a, b) = (
            grid.pdf_free_flight(&inside, t, importance),
            homogeneous.pdf_free_flight(&inside, t, importance),
        );
        assert!((a / b - 1.0).abs() < 1e-5, "{t}: {a}, {b}");
    }
}

/// Fire of source function 1, chromatic, in a grid: 1 − e^{−τ}.
#[test]
fn fire_in_a_grid_saturates_at_its_source_function() {
    let mut sampler = rng(5);
    let sigma_a = Rgb::new(0.1, 1.0, 10.0);
    let fire = grid_medium(
        noise([25, 11, 18], &mut sampler),
        sigma_a,
        Rgb::default(),
        sigma_a,
    );
    check_emission(&fire, &across(), &mut sampler, |c| {
        -(-f64::from(fire.optical_depth(&across()).channel(c))).exp_m1()
    });
}

/// A glow without substance, beside and inside smoke that only dims it.
#[test]
fn emission_grids_glow_without_density() {
    let mut sampler = rng(6);
    let glow = noise([5, 6, 7], &mut sampler);
    let expected = glow.line_integral(&across());
    let clear = grid_medium(constant(0.0, [16; 3]), 1.0, 1.0, 0.0)
        .with_emission(glow.clone())
        .unwrap();
    check_emission(&clear, &across(), &mut sampler, |_| expected);
    // Constant smoke over a constant glow: e·(1 − e^{−σt·s})/σt, albedo and all.
    let smoky = grid_medium(constant(0.1, [16; 3]), 1.0, 1.0, 0.0)
        .with_emission(constant(4.0, [1, 1, 1]))
        .unwrap();
    let expected = -4.0 * (-0.6_f64).exp_m1() / 0.2;
    check_emission(&smoky, &across(), &mut sampler, |_| expected);
}

fn check_emission<S: Spectrum>(
    medium: &GridMedium<S>,
    ray: &Ray,
    sampler: &mut impl Sampler,
    expected: impl Fn(usize) -> f64,
) {
    let mut moments = vec![Moments::new(); S::CHANNELS];
    for _ in 0..200_000 {
        let emitted = medium.emitted(ray, sampler);
        for (c, moments) in moments.iter_mut().enumerate() {
            moments.push(f64::from(emitted.channel(c)));
        }
    }
    let cases: Vec<(&str, Estimate, f64)> = (0..S::CHANNELS)
        .map(|c| ("emitted", moments[c].estimate(), expected(c)))
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// An empty grid, one of density 1e6, one of a lone dense voxel; rays through corners and along
/// faces, of length 0 and infinite, from 1e6 away. Where a channel is clear the others are 1e3 at
/// most, for it sees every tentative collision of theirs.
#[test]
fn extremes_are_finite() {
    let mut sampler = rng(7);
    let resolution = [9, 8, 20];
    let mut lone = vec![0.0; 9 * 8 * 20];
    lone[700] = 1e3;
    let lone = DenseGrid::new(resolution, BOUNDS, lone).unwrap();
    let mut rays = awkward_rays(resolution);
    rays.extend((0..100).map(|_| ray(&mut sampler)));
    let far = Vec3::new(0.6, 0.0, 0.8);
    rays.push(Ray::new(BOUNDS.center() - 1e6 * far, far));
    let chromatic = Rgb::new(0.0, 1e-6, 1.0);
    for (grid, scale) in [
        (constant(0.0, resolution), Rgb::splat(1.0)),
        (constant(1e6, resolution), Rgb::splat(1.0)),
        (constant(1e6, resolution), Rgb::default()),
        (constant(1e3, resolution), chromatic),
        (constant(1e-6, resolution), chromatic),
        (lone, chromatic),
    ] {
        let medium = grid_medium(grid, scale, Rgb::default(), scale);
        for ray in &rays {
            check_finite(&medium, ray, &mut sampler);
        }
    }
}

fn check_finite(medium: &GridMedium<Rgb>, ray: &Ray, sampler: &mut impl Sampler) {
    for importance in [Rgb::default(), Rgb::splat(1.0), Rgb::new(1e-38, 0.0, 1e38)] {
        let flight = medium.sample_free_flight(ray, importance, sampler);
        assert!(
            flight.weight.is_finite(),
            "{ray:?}, {importance:?}: {flight:?}"
        );
        let t = flight.collision.map_or(0.0, |collision| collision.t);
        assert!(
            t.is_finite() && (0.0..=ray.t_max).contains(&t),
            "{ray:?}: {flight:?}"
        );
        let pdf_t = medium.pdf_free_flight(ray, t, importance);
        assert!(pdf_t.is_finite() && pdf_t >= 0.0, "{ray:?}, {t}: {pdf_t}");
    }
    let emitted = medium.emitted(ray, sampler);
    let transmittance = medium.transmittance(ray, sampler);
    let depth = medium.optical_depth(ray);
    let finite = emitted.is_finite() && transmittance.is_finite() && depth.is_finite();
    assert!(finite, "{ray:?}: {emitted:?}, {transmittance:?}, {depth:?}");
}
