//! Statistics of progressive photon mapping.

use tyndall_core::Sampler;
use tyndall_density::{Dimension, Shrinkage, Statistics};
use tyndall_testkit::rng;

/// The flux kept as the paper does against the mean of passes, for counts that vary wildly.
#[test]
fn the_mean_of_passes_is_the_estimate_of_the_paper() {
    let mut sampler = rng(6);
    for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
        let shrinkage = Shrinkage::new(dimension, 0.7).expect("a valid alpha");
        let measure = |radius: f64| radius.powi(i32::from(dimension.number()));
        let mut place = Statistics::new(0.3);
        let (mut flux_kept, mut mean) = (0.0, 0.0);
        for pass in 1..=500 {
            let found = (1000.0 * f64::from(sampler.next_1d()).powi(8)).floor();
            let flux: f64 = (0..found as u32)
                .map(|_| f64::from(sampler.next_1d()))
                .sum();
            let before = place.radius;
            mean += (flux / measure(before) - mean) / f64::from(pass);
            place.update(found, shrinkage);
            flux_kept = (flux_kept + flux) * measure(place.radius) / measure(before);
            let estimate = flux_kept / (measure(place.radius) * f64::from(pass));
            assert!(
                (mean - estimate).abs() <= 1e-10 * estimate,
                "{dimension:?}, pass {pass}: {mean}, {estimate}"
            );
        }
        assert!(place.radius < 0.2, "it shrank to {}", place.radius);
    }
}

/// Where photons are uniform, M ∝ rᵈ, the radii are those of Knaus & Zwicker (2011):
/// rᵈ after i passes is the product of (j + α)/(j + 1) over j < i, and N = i M.
#[test]
fn in_uniform_light_radii_follow_the_memoryless_schedule() {
    for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
        let shrinkage = Shrinkage::optimal(dimension);
        let mut place = Statistics::new(1.0);
        let mut product = 1.0;
        for pass in 0..2000 {
            let pass = f64::from(pass);
            let measure = place.radius.powi(i32::from(dimension.number()));
            assert!((measure / product - 1.0).abs() < 1e-11, "pass {pass}");
            assert!((place.count - pass * 50.0 * measure).abs() <= 1e-10 * place.count);
            place.update(50.0 * measure, shrinkage);
            product *= (pass + shrinkage.alpha()) / (pass + 1.0);
        }
    }
}

#[test]
fn nothing_found_changes_nothing() {
    let two = Shrinkage::optimal(Dimension::Two);
    for found in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for mut place in [
            Statistics::new(0.0),
            Statistics {
                radius: 2.0,
                count: 9.5,
            },
        ] {
            let before = place;
            place.update(found, two);
            assert_eq!(place, before);
        }
    }
    let all = Shrinkage::new(Dimension::Two, 1.0).expect("a valid alpha");
    let mut place = Statistics::new(2.0);
    place.update(7.0, all);
    assert_eq!((place.radius, place.count), (2.0, 7.0));
}
