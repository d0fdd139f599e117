//! Equiangular sampling against its own density. False alarms: 1e-3 a test, fixed seeds.

use glam::Vec3;
use tyndall_core::{Ray, Sampler};
use tyndall_testkit::{rng, stats::kolmogorov_smirnov};
use tyndall_walk::equiangular::Equiangular;

/// The distribution in closed form: the share of the angle seen from the pivot.
fn cdf(t: f64, foot: f64, height: f64, length: f64) -> f64 {
    let angle = |t: f64| ((t - foot) / height).atan();
    (angle(t) - angle(0.0)) / (angle(length) - angle(0.0))
}

#[test]
fn distances_follow_the_closed_form_at_every_scale() {
    let mut sampler = rng(1);
    for scale in [1e-6_f32, 1.0, 1e6] {
        for (foot, height, length) in [
            (1.0, 0.5, 3.0),
            (-2.0, 0.3, 1.0),
            (5.0, 1e-3, 2.0),
            (0.4, 1e-4, 1.0),
            (1.0, 2.0, f64::INFINITY),
        ] {
            let ray = Ray::new(Vec3::ZERO, Vec3::Z).up_to(length as f32 * scale);
            let pivot = Vec3::new(height as f32, 0.0, foot as f32) * scale;
            let distribution = Equiangular::new(&ray, pivot);
            let mut samples: Vec<f64> = (0..20_000)
                .map(|_| f64::from(distribution.sample(sampler.next_1d()) / scale))
                .collect();
            kolmogorov_smirnov(&mut samples, |t| cdf(t, foot, height, length), 1e-3)
                .unwrap_or_else(|why| panic!("scale {scale}, foot {foot}: {why}"));
        }
    }
}

#[test]
fn the_density_integrates_to_one() {
    for (foot, height, length) in [(1.0, 0.5, 3.0), (-2.0, 0.3, 1.0), (0.5, 0.02, 1.0)] {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z).up_to(length);
        let distribution = Equiangular::new(&ray, Vec3::new(0.0, height, foot));
        let steps = 200_000;
        let sum: f64 = (0..steps)
            .map(|i| f64::from(distribution.pdf_t((i as f32 + 0.5) / steps as f32 * length)))
            .sum();
        // The midpoint rule errs by (Δt)²/24 · |f'|, below 1e-6 here; f32 values by 1e-7 each.
        let integral = sum * f64::from(length) / f64::from(steps);
        assert!((integral - 1.0).abs() < 1e-5, "{integral}");
    }
}

#[test]
fn the_extremes_are_finite() {
    let axis = Vec3::new(0.6, 0.0, 0.8);
    for length in [0.0, 1e-30, 1e-6, 1.0, 1e12, f32::INFINITY] {
        for pivot in [
            Vec3::ZERO,
            axis * 0.5,
            axis * -1e6,
            Vec3::splat(1e-20),
            Vec3::splat(1e9),
        ] {
            let ray = Ray::new(Vec3::ZERO, axis).up_to(length);
            let distribution = Equiangular::new(&ray, pivot);
            for u in [0.0, 0.3, 1.0 - f32::EPSILON / 2.0] {
                let t = distribution.sample(u);
                let pdf = distribution.pdf_t(t);
                assert!((0.0..=length).contains(&t), "{length} {pivot}: t {t}");
                assert!(
                    t.is_finite() && pdf.is_finite() && pdf >= 0.0,
                    "{length} {pivot}: {pdf}"
                );
            }
        }
    }
}
