//! Radii by paths traced.

use statrs::function::gamma::gamma;
use tyndall_core::Sampler;
use tyndall_density::{Dimension, Schedule, ScheduleError, Shrinkage};
use tyndall_testkit::rng;

const DIMENSIONS: [Dimension; 3] = [Dimension::One, Dimension::Two, Dimension::Three];
/// Of a scale in `f32`, squared, and of another it is compared with.
const ROUNDING: f64 = 3e-7;

fn schedule(dimension: Dimension, alpha: f64, starting_paths: u64) -> Schedule {
    let shrinkage = Shrinkage::new(dimension, alpha).expect("a valid alpha");
    Schedule::new(shrinkage, starting_paths).expect("paths")
}

fn square(schedule: &Schedule, first_path: u64, paths: u64) -> f64 {
    f64::from(schedule.scale(first_path, paths)).powi(2)
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value / expected - 1.0).abs() < tolerance,
        "{value} instead of {expected}"
    );
}

/// The product of Knaus & Zwicker over the passes before pass i is Γ(i+α)/(Γ(1+α) Γ(i+1)), and
/// Kershaw (1983) bounds the quotient of gamma functions between (i − 1/2 + √(α + 1/4))^(α−1) and
/// (i + α/2)^(α−1).
#[test]
fn the_power_is_the_limit_of_the_product() {
    let starting_paths = 1_000_000_000;
    for dimension in DIMENSIONS {
        for alpha in [0.1, Shrinkage::optimal(dimension).alpha(), 0.9] {
            let schedule = schedule(dimension, alpha, starting_paths);
            let mut product = 1.0;
            for i in 1..=1000_u64 {
                let scale = schedule.scale((i - 1) * starting_paths, 1);
                let power = f64::from(scale).powi(i32::from(dimension.number()));
                let pass = i as f64;
                let bound = |shift: f64| (1.0 + shift / pass).powf(alpha - 1.0);
                let quotient = product * gamma(1.0 + alpha) / power;
                let lowest = bound((alpha + 0.25).sqrt() - 0.5) - ROUNDING;
                let highest = bound(0.5 * alpha) + ROUNDING;
                assert!(
                    (lowest..highest).contains(&quotient),
                    "{dimension:?} {alpha} {i}: {quotient} not in {lowest}..{highest}"
                );
                product *= (pass + alpha) / (pass + 1.0);
            }
        }
    }
}

/// How paths are cut into passes changes no mean of r²: cuts at random, over ten decades.
#[test]
fn the_mean_square_does_not_depend_on_the_cuts() {
    let mut sampler = rng(5);
    for dimension in DIMENSIONS {
        for alpha in [1e-6, 0.3, 0.5, Shrinkage::optimal(dimension).alpha(), 1.0] {
            let schedule = schedule(dimension, alpha, 10_000);
            for _ in 0..50 {
                let mut number = |most: f32| most.powf(sampler.next_1d()) as u64;
                let start = number(1e10);
                let mut end = start;
                let mut sum = 0.0;
                for _ in 0..10 {
                    let paths = number(1e10);
                    sum += paths as f64 * square(&schedule, end, paths);
                    end += paths;
                }
                let whole = square(&schedule, start, end - start);
                assert_near(sum / (end - start) as f64, whole, ROUNDING);
            }
        }
    }
}

/// ∫ r² by the midpoint rule in ln(1 + n/n₀), whose error for 2,000 panels is below 1e-6.
#[test]
fn the_mean_square_is_that_of_the_power_law() {
    for dimension in DIMENSIONS {
        for alpha in [0.01, 0.5, 0.500_000_1, 2.0 / 3.0] {
            let schedule = schedule(dimension, alpha, 1000);
            let power = 2.0 * (alpha - 1.0) / f64::from(dimension.number());
            let (first, paths) = (500_u64, 10_000_000_u64);
            let (start, end) = (1.5_f64, 10_001.5_f64);
            let step = (end / start).ln() / 2000.0;
            let integral: f64 = (0..2000)
                .map(|panel| start * ((f64::from(panel) + 0.5) * step).exp())
                .map(|x| x.powf(power) * x * step)
                .sum();
            assert_near(
                square(&schedule, first, paths),
                integral / (end - start),
                5e-6,
            );
        }
    }
}

#[test]
fn radii_fall_from_the_starting_one() {
    for dimension in DIMENSIONS {
        let schedule = schedule(dimension, 0.7, 1000);
        assert_eq!(schedule.scale(0, 0), 1.0);
        let mut last = 1.0;
        for pass in 0..10_000 {
            let scale = schedule.scale(pass * 100, 100);
            assert!(
                scale < last,
                "{dimension:?}, pass {pass}: {last} to {scale}"
            );
            last = scale;
        }
    }
}

#[test]
fn extremes_are_exact() {
    for dimension in DIMENSIONS {
        let d = f64::from(dimension.number());
        for alpha in [1e-9, 0.5, 0.99] {
            let schedule = schedule(dimension, alpha, 1);
            for first in [1_000_000_000_000_000, u64::MAX] {
                let law = (first as f64).powf(2.0 * (alpha - 1.0) / d);
                assert_near(square(&schedule, first, 1), law, ROUNDING);
                assert_near(square(&schedule, first, 0), law, ROUNDING);
            }
            let all = schedule.scale(0, u64::MAX);
            assert!(all > 0.0 && all < 1.0, "{all}");
        }
        let kept = schedule(dimension, 1.0, 7);
        assert_eq!(kept.scale(1_000_000_000_000_000, 1), 1.0);
        assert_eq!(kept.scale(3, u64::MAX), 1.0);
    }
}

#[test]
fn what_cannot_shrink_is_refused() {
    for alpha in [0.0, -0.5, 1.000_001, f64::INFINITY, f64::NAN] {
        let error = Shrinkage::new(Dimension::Two, alpha).expect_err("an invalid alpha");
        assert!(error.to_string().contains("`alpha`"), "{error}");
    }
    let two = Shrinkage::optimal(Dimension::Two);
    assert_eq!(Schedule::new(two, 0), Err(ScheduleError::NoPaths));
    for (dimension, alpha) in DIMENSIONS.into_iter().zip([0.8, 2.0 / 3.0, 4.0 / 7.0]) {
        assert_eq!(
            Shrinkage::new(dimension, alpha),
            Ok(Shrinkage::optimal(dimension))
        );
    }
}
