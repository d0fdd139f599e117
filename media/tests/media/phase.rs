//! Every phase function is normalised, has the mean cosine it claims and is sampled exactly.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use glam::Vec3;
use std::f64::consts::{PI, TAU};
use tyndall_core::{PhaseFunction, Sampler};
use tyndall_media::{MediumError, Phase, Rayleigh};
use tyndall_testkit::{
    rng,
    stats::{chi2_sphere, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;

fn hg(g: f32) -> Phase {
    Phase::henyey_greenstein(g).unwrap()
}

/// A table with a zero at one pole and a kink where the phase functions of droplets have theirs.
fn table() -> Phase {
    let cosines = [-1.0, -0.5, 0.0, 0.75, 1.0];
    Phase::tabulated(&cosines, &[0.0, 2.0, 0.5, 0.5, 4.0]).unwrap()
}

fn blend() -> Phase {
    let nested = Phase::blend(vec![(1.0, table()), (1.0, Phase::Isotropic)]).unwrap();
    Phase::blend(vec![
        (3.0, hg(0.8)),
        (0.0, hg(0.1)),
        (2.0, hg(-0.4)),
        (5.0, nested),
    ])
    .unwrap()
}

/// With their mean cosines.
fn phases() -> Vec<(&'static str, Phase, f64)> {
    let mut all: Vec<_> = [0.0, 1e-6, 0.3, -0.3, 0.95, -0.95]
        .map(|g| ("henyey-greenstein", hg(g), f64::from(g)))
        .into();
    let tabulated = table_mean_cosine();
    all.extend([
        ("isotropic", Phase::Isotropic, 0.0),
        ("rayleigh", Phase::Rayleigh(Rayleigh), 0.0),
        ("tabulated", table(), tabulated),
        ("blend", blend(), 0.3 * 0.8 - 0.2 * 0.4 + 0.25 * tabulated),
    ]);
    all
}

/// ∫c·v dc / ∫v dc of `table`, each segment's linear function integrated by hand: with v = m·c + k,
/// ∫v = m(b² − a²)/2 + k(b − a) and ∫c·v = m(b³ − a³)/3 + k(b² − a²)/2.
fn table_mean_cosine() -> f64 {
    let segments = [
        (-1.0, -0.5, 4.0, 4.0),
        (-0.5, 0.0, -3.0, 0.5),
        (0.0, 0.75, 0.0, 0.5),
        (0.75, 1.0, 14.0, -10.0),
    ];
    let (mut area, mut moment) = (0.0, 0.0);
    for (a, b, m, k) in segments {
        let power = |n: i32| (f64::powi(b, n) - f64::powi(a, n)) / f64::from(n);
        area += m * power(2) + k * power(1);
        moment += m * power(3) + k * power(2);
    }
    moment / area
}

/// ∫ f(θ) dθ over \[0, π\] by Simpson on panels that halve towards both poles.
fn integrate(f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 256;
    let simpson = |a: f64, b: f64| {
        let h = (b - a) / STEPS as f64;
        let weight = |i| match i {
            0 | STEPS => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let sum: f64 = (0..=STEPS).map(|i| weight(i) * f(a + h * i as f64)).sum();
        sum * h / 3.0
    };
    let edge = |k: i32| {
        if k == 30 {
            0.0
        } else {
            0.5 * PI * 0.5_f64.powi(k)
        }
    };
    (0..30)
        .map(|k| simpson(edge(k + 1), edge(k)) + simpson(PI - edge(k), PI - edge(k + 1)))
        .sum()
}

#[test]
fn normalised_with_the_mean_cosine_it_claims() {
    let mut all = phases();
    all.extend([0.999, -0.999].map(|g| ("henyey-greenstein", hg(g), f64::from(g))));
    for (name, phase, mean_cosine) in all {
        // θ from straight on: the direction of travel before is −wo = −Z.
        let per_theta = |theta: f64| {
            let wi = Vec3::new(theta.sin() as f32, 0.0, -theta.cos() as f32);
            TAU * theta.sin() * f64::from(phase.eval(Vec3::Z, wi))
        };
        // The rounding of `f32` in the phase function and its argument, and the kinks of the table.
        let tolerance = 2e-5;
        let total = integrate(per_theta);
        assert!((total - 1.0).abs() < tolerance, "{name}: ∫p dω = {total}");
        let mean = integrate(|theta| theta.cos() * per_theta(theta));
        assert!(
            (mean - mean_cosine).abs() < tolerance,
            "{name}: {mean}, not {mean_cosine}"
        );
        let claimed = f64::from(phase.mean_cosine());
        assert!(
            (claimed - mean_cosine).abs() < 1e-6,
            "{name} claims {claimed}"
        );
    }
}

#[test]
fn samples_follow_the_density() {
    for (name, phase, _) in phases() {
        for wo in [Vec3::Z, Vec3::new(-0.48, 0.6, 0.64)] {
            chi2_sphere(
                |u| Some(phase.sample(wo, u).wi),
                |wi| phase.pdf_w(wo, wi),
                200_000,
                FALSE_ALARM,
            )
            .unwrap_or_else(|why| panic!("{name}, wo {wo}: {why}"));
        }
    }
}

/// The peak of |g| = 0.999 is too narrow for cells: its height 1 − |cos| is tested instead, against
/// F(h) = (1 − g²)/(2g)·(1/a − 1/√(a² + 2gh)) with a = 1 − g.
#[test]
fn heights_of_narrow_peaks_follow_their_distribution() {
    for (seed, g) in [(1, 0.999_f32), (2, -0.999), (3, 0.95), (4, 1e-4)] {
        let phase = hg(g);
        let wo = Vec3::new(0.36, -0.48, 0.8);
        let pole = if g < 0.0 { wo } else { -wo };
        let mut sampler = rng(seed);
        let mut heights: Vec<f64> = (0..200_000)
            .map(|_| {
                let wi = phase.sample(wo, sampler.next()).wi;
                0.5 * (wi.as_dvec3() - pole.as_dvec3()).length_squared()
            })
            .collect();
        let g = f64::from(g.abs());
        let a = 1.0 - g;
        let cdf = |h: f64| {
            let inner = 1.0 / a - 1.0 / (a * a + 2.0 * g * h).sqrt();
            ((1.0 - g * g) / (2.0 * g) * inner).min(1.0)
        };
        kolmogorov_smirnov(&mut heights, cdf, FALSE_ALARM).unwrap();
    }
}

/// At the peak, the angle is a thousandth and the components of a direction are rounded at 6e-8:
/// the density, which falls as the cube of the angle at most, is right to 4e-4.
#[test]
fn narrow_peaks_are_evaluated_without_cancellation() {
    for g in [0.999_f64, -0.999] {
        let wo = Vec3::new(0.36, -0.48, 0.8).as_dvec3();
        let aside = wo.any_orthonormal_vector();
        for theta in [0.0, 1e-4, 1e-3, 1e-2, 0.1, 1.0] {
            let pole = -wo * g.signum();
            let wi = (pole * f64::cos(theta) + aside * f64::sin(theta)).as_vec3();
            let p = f64::from(hg(g as f32).eval(wo.as_vec3(), wi));
            let g = f64::from(g.abs() as f32);
            let d = (1.0 - g).powi(2) + 4.0 * g * (0.5 * theta).sin().powi(2);
            let expected = (1.0 - g * g) / (4.0 * PI * d.powf(1.5));
            assert!(
                (p / expected - 1.0).abs() < 1e-3,
                "{g}, {theta}: {p} for {expected}"
            );
        }
    }
}

#[test]
fn a_sample_tells_its_density() {
    let mut all: Vec<_> = phases()
        .into_iter()
        .map(|(name, phase, _)| (name, phase))
        .collect();
    all.extend([("narrow", hg(0.999)), ("narrow", hg(-0.999))]);
    const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
    for (name, phase) in all {
        let mut sampler = rng(5);
        let corners = [
            [0.0, 0.0],
            [BELOW_ONE, BELOW_ONE],
            [0.0, BELOW_ONE],
            [BELOW_ONE, 0.5],
        ];
        let us = corners
            .into_iter()
            .chain((0..10_000).map(|_| sampler.next()));
        for u in us {
            let wo = Vec3::new(0.36, -0.48, 0.8);
            let sample = phase.sample(wo, u);
            let pdf_w = phase.pdf_w(wo, sample.wi);
            assert!((sample.wi.length() - 1.0).abs() < 1e-6, "{name}, {u:?}");
            assert_eq!(sample.weight, 1.0);
            // The table is steep at its poles: absolutely 1e-5 of its peak 4, relatively of HG's.
            let near = (sample.pdf_w - pdf_w).abs() <= 2e-3 * pdf_w + 1e-5;
            assert!(near, "{name}, {u:?}: {} for {pdf_w}", sample.pdf_w);
        }
    }
}

#[test]
fn a_forward_lobe_goes_on() {
    let wi = hg(0.9).sample(Vec3::Z, [0.5, 0.5]).wi;
    assert!(
        wi.z < -0.9,
        "light travelling along −wo = −Z goes on to {wi}"
    );
    let forward = Phase::tabulated(&[-1.0, 1.0], &[0.0, 1.0]).unwrap();
    assert!(forward.eval(Vec3::Z, -Vec3::Z) > forward.eval(Vec3::Z, Vec3::Z));
}

#[test]
fn wrong_numbers_are_named() {
    use MediumError::{Asymmetry, BlendWeight, TableCosines, TableValue};
    for g in [1.0, -0.9991, f32::NAN, f32::INFINITY] {
        assert!(
            matches!(Phase::henyey_greenstein(g), Err(Asymmetry { .. })),
            "{g}"
        );
    }
    let table = |cosines: &[f32], values: &[f32]| Phase::tabulated(cosines, values).unwrap_err();
    assert_eq!(table(&[-1.0], &[1.0]), TableCosines { node: 1 });
    assert_eq!(table(&[-1.0, 1.0], &[1.0]), TableCosines { node: 1 });
    assert_eq!(table(&[-0.9, 1.0], &[1.0; 2]), TableCosines { node: 0 });
    assert_eq!(
        table(&[-1.0, 0.0, 0.0, 1.0], &[1.0; 4]),
        TableCosines { node: 2 }
    );
    assert_eq!(
        table(&[-1.0, f32::NAN, 1.0], &[1.0; 3]),
        TableCosines { node: 1 }
    );
    assert_eq!(
        table(&[-1.0, 1.0], &[1.0, -2.0]),
        TableValue {
            node: 1,
            value: -2.0
        }
    );
    assert_eq!(
        table(&[-1.0, 1.0], &[0.0; 2]),
        TableValue {
            node: 0,
            value: 0.0
        }
    );
    let blend = |weights: &[f32]| {
        Phase::blend(weights.iter().map(|&w| (w, Phase::Isotropic)).collect()).unwrap_err()
    };
    assert_eq!(
        blend(&[]),
        BlendWeight {
            index: 0,
            weight: 0.0
        }
    );
    assert_eq!(
        blend(&[1.0, -1.0]),
        BlendWeight {
            index: 1,
            weight: -1.0
        }
    );
    assert_eq!(
        blend(&[0.0, 0.0]),
        BlendWeight {
            index: 0,
            weight: 0.0
        }
    );
}
