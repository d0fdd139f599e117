//! The closed forms of exponential atmospheres against quadrature, and their extremes.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use glam::{DVec3, Vec3};
use std::ops::ControlFlow;
use tyndall_core::{Coefficients, Majorant, Medium, Ray, Rgb, Sampler, Spectrum, warp};
use tyndall_media::{AnyMedium, Atmosphere, Homogeneous, MediumError, Phase};
use tyndall_testkit::{
    rng,
    stats::{Estimate, Moments, check_means, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;
const ORIGIN: Vec3 = Vec3::new(2.0, -1.0, 0.5);
const UP: Vec3 = Vec3::new(0.6, 0.0, 0.8);
const SIGMA_T: [f64; 3] = [0.05, 1.0, 5.0];
const IMPORTANCE: Rgb = Rgb::new(0.2, 1.0, 0.3);

fn atmosphere<S: Spectrum>(height: f32, sigma_a: S, sigma_s: S, emission: S) -> Atmosphere<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission,
    };
    Atmosphere::new(ORIGIN, 3.0 * UP, height, coefficients, Phase::Isotropic).unwrap()
}

/// Extinctions 0.05, 1 and 5, emission 2, 1 and 0.5.
fn chromatic(height: f32) -> Atmosphere<Rgb> {
    let (sigma_a, sigma_s) = (Rgb::new(0.04, 0.0, 1.0), Rgb::new(0.01, 1.0, 4.0));
    atmosphere(height, sigma_a, sigma_s, Rgb::new(2.0, 1.0, 0.5))
}

/// The density at a point, as the documentation has it.
fn density(p: DVec3, height: f64) -> f64 {
    (-(p - ORIGIN.as_dvec3()).dot(UP.as_dvec3().normalize()) / height).exp()
}

/// Mass and, for each channel, ∫ density·e^{−σt·mass} dt along a ray, by Simpson's rule in cells
/// whose start and middle values of the mass are themselves Simpson sums.
fn quadrature(ray: &Ray, height: f64) -> (f64, [f64; 3]) {
    const CELLS: usize = 20_000;
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let width = f64::from(ray.t_max) / CELLS as f64;
    let rho = |t: f64| density(origin + t * direction, height);
    let simpson = |a: f64, b: f64| (b - a) / 6.0 * (rho(a) + 4.0 * rho(0.5 * (a + b)) + rho(b));
    let (mut mass, mut seen) = (0.0, [0.0; 3]);
    for i in 0..CELLS {
        let [a, b] = [i, i + 1].map(|i| i as f64 * width);
        let middle = 0.5 * (a + b);
        let (half, whole) = (mass + simpson(a, middle), mass + simpson(a, b));
        for (seen, sigma) in seen.iter_mut().zip(SIGMA_T) {
            let glow = |t: f64, mass: f64| rho(t) * (-sigma * mass).exp();
            *seen += width / 6.0 * (glow(a, mass) + 4.0 * glow(middle, half) + glow(b, whole));
        }
        mass = whole;
    }
    (mass, seen)
}

/// Rays up, down, level and nearly level, from above and below the origin.
fn rays(height: f32, sampler: &mut impl Sampler) -> Vec<Ray> {
    let level = Vec3::new(0.8, 0.0, -0.6);
    let tilts = [1.0, 0.3, 1e-3, 1e-7, 0.0, -1e-7, -1e-3, -0.3, -1.0];
    let tilted = tilts.map(|tilt| (level + tilt * UP).normalize());
    let random: [Vec3; 9] = std::array::from_fn(|_| warp::uniform_sphere(sampler.next()));
    let directions = [UP, -UP].into_iter().chain(tilted).chain(random);
    directions
        .map(|direction| {
            let lift = height * (4.0 * sampler.next_1d() - 2.0);
            let length = 3.0 * height * sampler.next_1d();
            Ray::new(ORIGIN + lift * UP + level, direction).up_to(length)
        })
        .collect()
}

/// Tolerance: the rounding of positions and of optical depths to `f32`, each below 1e-6.
#[test]
fn transmittance_and_emission_are_the_integrals() {
    let mut sampler = rng(1);
    for height in [0.1, 1.0, 30.0] {
        let medium = chromatic(height);
        for ray in rays(height, &mut sampler) {
            let (mass, seen) = quadrature(&ray, height.into());
            let transmittance = medium.transmittance(&ray, &mut sampler);
            let emitted = medium.emitted(&ray, &mut sampler);
            for c in 0..3 {
                let tau = SIGMA_T[c] * mass;
                let near = |value: f32, expected: f64, tolerance: f64| {
                    let error = (f64::from(value) / expected - 1.0).abs();
                    assert!(error < tolerance, "{ray:?}: {value} for {expected}");
                };
                if tau < 80.0 {
                    near(transmittance.channel(c), (-tau).exp(), 4e-6 * (1.0 + tau));
                }
                near(emitted.channel(c), [2.0, 1.0, 0.5][c] * seen[c], 4e-6);
            }
        }
    }
}

/// In every direction the distances follow Σ pmf·(1 − Tr)/(1 − Tr(t_max)), and light passes as
/// often as it should.
#[test]
fn distances_follow_the_mixture_of_channels() {
    const COUNT: usize = 100_000;
    let mut sampler = rng(2);
    let medium = chromatic(1.5);
    let pmf = [0.2, 1.0, 0.3].map(|x| x / 1.5);
    for tilt in [1.0, 0.2, 0.0, -0.2, -1.0] {
        let direction = (Vec3::new(0.8, 0.0, -0.6) + tilt * UP).normalize();
        let ray = Ray::new(ORIGIN, direction).up_to(2.0);
        let slope = f64::from(direction.dot(UP)) / 1.5;
        let mass = |t: f64| match slope {
            0.0 => t,
            _ => -(-slope * t).exp_m1() / slope,
        };
        let cdf = |t: f64| -> f64 {
            let each = (0..3).map(|c| pmf[c] * -(-SIGMA_T[c] * mass(t)).exp_m1());
            each.sum()
        };
        let mut t: Vec<f64> = (0..COUNT)
            .filter_map(|_| {
                let flight = medium.sample_free_flight(&ray, IMPORTANCE, &mut sampler);
                flight.collision.map(|collision| f64::from(collision.t))
            })
            .collect();
        let collided = t.len() as f64 / COUNT as f64;
        // Binomial: 5 standard deviations, false alarm 6e-7.
        let deviation = (collided * (1.0 - collided) / COUNT as f64).sqrt();
        assert!((collided - cdf(2.0)).abs() < 5.0 * deviation, "{tilt}");
        let passing = f64::from(medium.pmf_passing(&ray, IMPORTANCE));
        assert!((passing - 1.0 + cdf(2.0)).abs() < 1e-6, "{passing}");
        kolmogorov_smirnov(&mut t, |t| cdf(t) / cdf(2.0), FALSE_ALARM).unwrap();
        for t in [0.0, 0.4, 1.9] {
            let pdf_t = f64::from(medium.pdf_free_flight(&ray, t as f32, IMPORTANCE));
            let rho = (-slope * t).exp();
            let each = (0..3).map(|c| pmf[c] * SIGMA_T[c] * rho * (-SIGMA_T[c] * mass(t)).exp());
            let expected: f64 = each.sum();
            assert!((pdf_t / expected - 1.0).abs() < 1e-5, "{pdf_t}");
        }
        assert_eq!(medium.pdf_free_flight(&ray, 2.0, IMPORTANCE), 0.0);
    }
}

/// Per channel: the weight of collisions before x has mean 1 − Tr(x), that of passing Tr(t_max);
/// and Σ importance·weight is Σ importance whatever happens.
#[test]
fn weights_are_unbiased_in_every_channel() {
    let mut sampler = rng(3);
    let medium = chromatic(0.7);
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for (direction, t_max) in [(UP, f32::INFINITY), (-UP, 1.2), (Vec3::Y, 0.9)] {
        let ray = Ray::new(ORIGIN + 0.2 * UP, direction).up_to(t_max);
        let (mut before, mut passed) = ([Moments::new(); 3], [Moments::new(); 3]);
        for _ in 0..200_000 {
            let flight = medium.sample_free_flight(&ray, IMPORTANCE, &mut sampler);
            let conserved = (IMPORTANCE * flight.weight).sum() / IMPORTANCE.sum();
            assert!((conserved - 1.0).abs() < 1e-5, "{flight:?}");
            let t = flight.collision.map(|collision| collision.t);
            for c in 0..3 {
                let weight = f64::from(flight.weight.channel(c));
                let early = t.is_some_and(|t| t < 0.4);
                before[c].push(if early { weight } else { 0.0 });
                passed[c].push(if t.is_none() { weight } else { 0.0 });
            }
        }
        let (near, _) = quadrature(&ray.up_to(0.4), f64::from(0.7_f32));
        // 30 scale heights leave 1e-13 of the mass.
        let (whole, _) = quadrature(&ray.up_to(t_max.min(21.0)), f64::from(0.7_f32));
        for c in 0..3 {
            let through = |mass: f64| (-SIGMA_T[c] * mass).exp();
            cases.push(("before", before[c].estimate(), 1.0 - through(near)));
            cases.push(("passed", passed[c].estimate(), through(whole)));
        }
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// A scale height of 1e6 over lengths of 1: the density changes by 1e-6.
#[test]
fn a_high_atmosphere_is_a_homogeneous_medium() {
    let high = chromatic(1e6);
    let coefficients = high.coefficients(ORIGIN);
    let homogeneous = Homogeneous::new(coefficients, Phase::Isotropic).unwrap();
    for direction in [UP, -UP, Vec3::Y] {
        let ray = Ray::new(ORIGIN, direction).up_to(1.3);
        let near = |a: Rgb, b: Rgb| {
            let error = (a.ratio(b) - Rgb::splat(1.0)).map(f32::abs).max_channel();
            assert!(error < 1e-5, "{a:?}, {b:?}");
        };
        let (mut a, mut b) = (rng(4), rng(4));
        let [here, there] = [
            high.transmittance(&ray, &mut a),
            homogeneous.transmittance(&ray, &mut b),
        ];
        near(here, there);
        near(
            high.emitted(&ray, &mut a),
            homogeneous.emitted(&ray, &mut b),
        );
        for _ in 0..1000 {
            let flight = high.sample_free_flight(&ray, IMPORTANCE, &mut a);
            let same = homogeneous.sample_free_flight(&ray, IMPORTANCE, &mut b);
            near(flight.weight, same.weight);
            let [t, expected] = [flight, same].map(|f| f.collision.map_or(9.0, |c| c.t));
            assert!((t / expected - 1.0).abs() < 1e-5, "{t}, {expected}");
        }
    }
}

/// Stretches join, at most 300 of them; no coefficient exceeds theirs, and none is left out.
#[test]
fn majorants_bound_the_extinction() {
    let mut sampler = rng(5);
    for height in [1e-6, 1e-3, 1.0, 1e6] {
        let medium = AnyMedium::Atmosphere(chromatic(height));
        let (mut rays, mut stretches) = (rays(height, &mut sampler), 0);
        let endless = rays.iter().map(|ray| ray.up_to(f32::INFINITY));
        rays.extend(endless.collect::<Vec<_>>());
        rays.extend([-200.0, 200.0].map(|h| Ray::new(ORIGIN + h * height * UP, -UP)));
        rays.extend([-200.0, 200.0].map(|h| Ray::new(ORIGIN + h * height * UP, UP)));
        for ray in rays {
            let (mut start, mut end): (_, Option<f32>) = (ray.t_max, None);
            let mut count = 0;
            // Nine points of a stretch, of an endless one near its start.
            let check = |from: f32, to: f32, bound: f32| {
                for i in 0..=8 {
                    let p = ray.at(from + (to - from).min(1e3 * height) * i as f32 / 8.0);
                    // Of the position that a coefficient is asked for.
                    let largest = p.abs().max(ray.origin.abs()).max_element();
                    let rounding = 4e-7 * (largest + 2.0) / height;
                    let limit = f64::from(bound) * f64::from(rounding + 1e-6).exp() + 3e-45;
                    let sigma_t = f64::from(medium.coefficients(p).sigma_t().max_channel());
                    assert!(sigma_t <= limit, "{ray:?}, {p}: {sigma_t} over {limit}");
                }
            };
            medium.majorants(
                &ray,
                |Majorant {
                     t_min,
                     t_max,
                     sigma_bar,
                 }| {
                    assert!(
                        end.is_none_or(|end| end == t_min) && t_min < t_max,
                        "{ray:?}"
                    );
                    assert!(
                        t_max <= ray.t_max && sigma_bar > 0.0 && sigma_bar <= 1e30,
                        "{ray:?}"
                    );
                    start = start.min(t_min);
                    end = Some(t_max);
                    count += 1;
                    check(t_min, t_max, sigma_bar);
                    ControlFlow::Continue(())
                },
            );
            assert!(count <= 300, "{ray:?}: {count}");
            // What is left out is what `f32` cannot tell from 0.
            let least = f32::from_bits(1);
            if start > 0.0 {
                check(0.0, start, least);
            }
            if let Some(end) = end.filter(|&end| end < ray.t_max) {
                check(end, ray.t_max, least);
            }
            stretches += count;
        }
        assert!(stretches > 100, "{stretches}");
    }
}

#[test]
fn extremes_are_finite() {
    let mut sampler = rng(6);
    let levels = [0.0, 1e-38, 1e-6, 1.0, 1e6];
    let importances = [
        Rgb::default(),
        Rgb::new(1.0, 0.0, 0.0),
        Rgb::new(1e-38, 1.0, 1e38),
    ];
    for sigma in (0..125).map(|i| Rgb::new(levels[i % 5], levels[i / 5 % 5], levels[i / 25])) {
        for height in [1e-6, 1e-2, 1.0, 1e6] {
            let medium = atmosphere(height, sigma * 0.5, sigma * 0.5, sigma);
            for h in [-1e6, -1.0, 0.0, 1.0, 1e6] {
                for direction in [UP, -UP, Vec3::Y, Vec3::new(0.8, 1e-8, -0.6), Vec3::X] {
                    let ray = Ray::new(ORIGIN + h * UP, direction);
                    for t_max in [0.0, 1e-6, 1.0, 1e6, f32::INFINITY] {
                        for importance in importances {
                            check_finite(&medium, &ray.up_to(t_max), importance, &mut sampler);
                        }
                    }
                }
            }
        }
    }
}

fn check_finite(medium: &Atmosphere<Rgb>, ray: &Ray, importance: Rgb, sampler: &mut impl Sampler) {
    let flight = medium.sample_free_flight(ray, importance, sampler);
    let context = || format!("{medium:?}, {ray:?}, {importance:?}: {flight:?}");
    assert!(flight.weight.is_finite(), "{}", context());
    let transmittance = medium.transmittance(ray, sampler);
    let bounded = transmittance.is_finite() && transmittance.max_channel() <= 1.0;
    assert!(bounded, "{transmittance:?}, {}", context());
    let emitted = medium.emitted(ray, sampler);
    // The source function is 1 in every channel.
    assert!(
        emitted.is_finite() && emitted.max_channel() <= 1.0,
        "{}",
        context()
    );
    if let Some(collision) = flight.collision {
        let t = collision.t;
        assert!(
            t.is_finite() && (0.0..ray.t_max).contains(&t),
            "{}",
            context()
        );
        let sigma_t = collision.coefficients.sigma_t();
        assert!(
            sigma_t.is_finite() && sigma_t.max_channel() <= 1.01e30,
            "{}",
            context()
        );
    }
    let t = flight.collision.map_or(0.0, |collision| collision.t);
    let pdf_t = medium.pdf_free_flight(ray, t, importance);
    let passing = medium.pmf_passing(ray, importance);
    assert!(pdf_t.is_finite() && pdf_t >= 0.0, "{pdf_t}, {}", context());
    assert!(
        (0.0..=1.000_001).contains(&passing),
        "{passing}, {}",
        context()
    );
    let largest = importance.max_channel();
    let relative = if largest > 0.0 {
        importance / largest
    } else {
        Rgb::splat(1.0)
    };
    let conserved = (relative * flight.weight).sum() / relative.sum();
    assert!((conserved - 1.0).abs() < 1e-4, "{conserved}: {}", context());
}

#[test]
fn rays_without_end_meet_or_pass_what_there_is() {
    let medium = atmosphere(2.0, 0.25_f32, 0.0, 0.0);
    let mut sampler = rng(7);
    let mut through = |direction| medium.transmittance(&Ray::new(ORIGIN, direction), &mut sampler);
    assert!((through(UP) - (-0.5_f32).exp()).abs() < 1e-6);
    assert_eq!(through(-UP), 0.0);
    assert_eq!(through(Vec3::Y), 0.0);
}

#[test]
fn wrong_numbers_are_named() {
    let fog = Coefficients {
        sigma_a: 1.0_f32,
        sigma_s: 1.0,
        emission: 0.0,
    };
    let new = |origin, up, height, fog| {
        Atmosphere::new(origin, up, height, fog, Phase::Isotropic).unwrap_err()
    };
    for scale_height in [0.0, -1.0, f32::INFINITY] {
        let error = new(ORIGIN, UP, scale_height, fog);
        assert_eq!(error, MediumError::ScaleHeight { scale_height });
    }
    let error = new(ORIGIN, Vec3::ZERO, 1.0, fog);
    assert!(
        error
            .to_string()
            .starts_with("`up` of an atmosphere is [0, 0, 0]")
    );
    let error = new(Vec3::NAN, UP, 1.0, fog);
    assert!(matches!(
        error,
        MediumError::Placement {
            field: "origin",
            ..
        }
    ));
    let negative = Coefficients {
        sigma_s: -1.0,
        ..fog
    };
    let error = new(ORIGIN, UP, 1.0, negative);
    assert!(matches!(
        error,
        MediumError::Coefficient {
            field: "sigma_s",
            ..
        }
    ));
}
