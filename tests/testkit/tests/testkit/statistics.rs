//! The statistical tests err as often as they state, and find what they should.

use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{Frame, PhaseFunction, Sampler, warp};
use tyndall_media::Phase;
use tyndall_testkit::stats::{
    Estimate, ImageEstimate, Moments, check_mean, check_means, chi2_sphere, chi2_test,
    compare_images, kolmogorov_smirnov, log_log_slope, p_value, rmse, sidak, z_test_images,
};
use tyndall_testkit::{TestSampler, rng};

const TRIALS: usize = 2000;
const RATE: f64 = 0.05;

/// Runs `TRIALS` trials that fail by chance with probability `RATE` and bounds their number: five
/// standard deviations of the binomial, 49 (false alarm 6e-7), plus a bias of the test of
/// `relative_bias`.
fn assert_false_alarms(relative_bias: f64, mut trial: impl FnMut(&mut TestSampler) -> bool) {
    let mut sampler = rng(20);
    let alarms = (0..TRIALS).filter(|_| !trial(&mut sampler)).count() as f64;
    let expected = TRIALS as f64 * RATE;
    let bound = 5.0 * (expected * (1.0 - RATE)).sqrt() + relative_bias * expected;
    assert!(
        (alarms - expected).abs() < bound,
        "{alarms} false alarms, {expected} ± {bound:.0} expected"
    );
}

fn uniform(sampler: &mut TestSampler) -> f64 {
    f64::from(sampler.next_1d())
}

/// Box & Muller (1958).
fn normal(sampler: &mut TestSampler) -> f64 {
    let radius = (-2.0 * (1.0 - uniform(sampler)).ln()).sqrt();
    radius * (2.0 * PI * uniform(sampler)).cos()
}

fn moments(n: usize, mut sample: impl FnMut() -> f64) -> Estimate {
    let m: Moments = (0..n).map(|_| sample()).collect();
    m.estimate()
}

#[test]
fn mean_of_few_and_of_many_samples_alarms_as_stated() {
    for n in [3, 20, 1000] {
        assert_false_alarms(0.0, |s| {
            let e = moments(n, || 7.0 + normal(s));
            check_mean("", e, 7.0, RATE).is_ok()
        });
    }
}

#[test]
fn difference_of_unequal_variances_alarms_as_stated() {
    // Welch's approximation is within a few per cent here.
    assert_false_alarms(0.1, |s| {
        let a = moments(8, || normal(s));
        let b = moments(20, || 3.0 * normal(s));
        check_mean("", a.difference(&b), 0.0, RATE).is_ok()
    });
}

#[test]
fn many_means_alarm_together_as_stated() {
    assert_false_alarms(0.0, |s| {
        let cases: Vec<_> = (0..10)
            .map(|_| ("", moments(10, || normal(s)), 0.0))
            .collect();
        check_means(&cases, RATE).is_ok()
    });
}

#[test]
fn chi2_alarms_as_stated() {
    // 1,200 samples in cells that expect 200 and more: χ² within a few per cent. A degree of
    // freedom more would alarm 2.0 % of the time, one less 15 %.
    let expected = [200.0, 400.0, 600.0];
    assert_false_alarms(0.02, |s| {
        let mut observed = [0.0; 3];
        for _ in 0..1200 {
            let u = 6.0 * uniform(s);
            observed[usize::from(u >= 1.0) + usize::from(u >= 3.0)] += 1.0;
        }
        chi2_test(&observed, &expected, RATE).is_ok()
    });
}

#[test]
fn kolmogorov_smirnov_alarms_as_stated() {
    assert_false_alarms(0.1, |s| {
        let mut samples: Vec<f64> = (0..100).map(|_| uniform(s).powi(2)).collect();
        kolmogorov_smirnov(&mut samples, f64::sqrt, RATE).is_ok()
    });
}

/// Errors of 10 % around x^−0.4 over two decades: the deviation of the slope in standard errors is
/// Student's t with four degrees of freedom.
#[test]
fn slopes_alarm_as_stated() {
    let points = |s: &mut TestSampler| -> Vec<(f64, f64)> {
        (0..6)
            .map(|i| 10.0_f64.powf(0.4 * f64::from(i)))
            .map(|x| (x, 3.0 * x.powf(-0.4) * (0.1 * normal(s)).exp()))
            .collect()
    };
    assert_false_alarms(0.0, |s| {
        let fit = log_log_slope(&points(s));
        p_value((fit.slope + 0.4) / fit.standard_error, 4.0) >= RATE
    });
    assert_eq!(
        log_log_slope(&[(1.0, 1.0), (2.0, 2.0)]).standard_error,
        f64::INFINITY
    );
}

/// The root of the mean of n squares of normal deviates varies by 1/√(2n): five of those.
#[test]
fn the_error_of_many_runs_is_their_deviation_and_bias() {
    let mut s = rng(24);
    let runs = 20_000;
    let error = rmse((0..runs).map(|_| (7.0 + 0.4 * normal(&mut s), 6.7)));
    let bound = 5.0 / (2.0 * f64::from(runs)).sqrt();
    assert!((error / 0.5 - 1.0).abs() < bound, "{error}");
}

#[test]
#[should_panic(expected = "no power law through (1, 0)")]
fn an_error_of_zero_has_no_slope() {
    log_log_slope(&[(1.0, 0.0), (2.0, 1.0)]);
}

/// An image of normal pixels around 1: means and their variances.
fn image(passes: usize, pixels: usize, shift: f64, s: &mut TestSampler) -> [Vec<f64>; 2] {
    let estimates: Vec<Estimate> = (0..pixels)
        .map(|_| moments(passes, || 1.0 + shift + 0.3 * normal(s)))
        .collect();
    [
        estimates.iter().map(|e| e.mean).collect(),
        estimates.iter().map(|e| e.standard_error.powi(2)).collect(),
    ]
}

fn view<'a>([mean, variance]: &'a [Vec<f64>; 2], passes: usize) -> ImageEstimate<'a> {
    ImageEstimate {
        mean,
        variance_of_mean: variance,
        passes: passes as u64,
    }
}

#[test]
fn images_alarm_as_stated() {
    assert_false_alarms(0.1, |s| {
        let (a, b) = (image(8, 20, 0.0, s), image(16, 20, 0.0, s));
        z_test_images(view(&a, 8), view(&b, 16), RATE).is_ok()
    });
}

/// Against an exact image, Welch's t is Student's: the probabilities of χ² are uniform although
/// four passes are few, with 50 pixels (incomplete Γ) as with 10,000 (cube root). False alarm 1e-6
/// each.
#[test]
fn chi2_of_images_is_chi2() {
    let mut s = rng(5);
    for (pixels, images) in [(50, 400), (10_000, 60)] {
        let exact = [vec![1.0; pixels], vec![0.0; pixels]];
        let mut p: Vec<_> = (0..images)
            .map(|_| {
                let a = image(4, pixels, 0.0, &mut s);
                let found = compare_images(view(&a, 4), view(&exact, 4));
                assert_eq!(found.varying, pixels);
                found.chi2_p
            })
            .collect();
        kolmogorov_smirnov(&mut p, |x| x, 1e-6).unwrap();
    }
}

/// Half a standard error everywhere, up and down in turn: no pixel and no mean shows it. The
/// expected χ² is 1.25 n, 7.9 standard deviations above n for 2,000 pixels.
#[test]
fn chi2_finds_what_no_pixel_shows() {
    let mut s = rng(6);
    let (mut a, exact) = (
        image(64, 2000, 0.0, &mut s),
        [vec![1.0; 2000], vec![0.0; 2000]],
    );
    for (i, mean) in a[0].iter_mut().enumerate() {
        *mean += 0.5 * 0.3 / 8.0 * if i % 2 == 0 { 1.0 } else { -1.0 };
    }
    z_test_images(view(&a, 64), view(&exact, 64), 1e-3).unwrap();
    let found = compare_images(view(&a, 64), view(&exact, 64));
    assert!(found.chi2_p < 1e-6, "{found:?}");
}

#[test]
fn a_shift_of_one_per_cent_is_found() {
    let mut s = rng(3);
    // σ/μ = 0.29: a standard error of 0.05 %.
    let e = moments(300_000, || 1.01 * (0.5 + uniform(&mut s)));
    let why = check_mean("shifted", e, 1.0, 1e-6).unwrap_err();
    assert!(why.contains("shifted") && why.contains("+1.0"), "{why}");

    let mut samples: Vec<f64> = (0..100_000).map(|_| 1.01 * uniform(&mut s)).collect();
    let cdf = |x: f64| x.clamp(0.0, 1.0);
    kolmogorov_smirnov(&mut samples, cdf, 1e-6).unwrap_err();

    let (a, b) = (image(64, 2000, 0.0, &mut s), image(64, 2000, 0.01, &mut s));
    let why = z_test_images(view(&a, 64), view(&b, 64), 1e-6).unwrap_err();
    assert!(why.contains("as a whole"), "{why}");
}

#[test]
fn one_wrong_pixel_is_found() {
    let mut s = rng(4);
    let (mut a, b) = (image(64, 500, 0.0, &mut s), image(64, 500, 0.0, &mut s));
    a[0][123] += 0.5;
    let why = z_test_images(view(&a, 64), view(&b, 64), 1e-6).unwrap_err();
    assert!(why.contains("pixel 123"), "{why}");
}

#[test]
fn pixels_without_variance_must_be_equal() {
    let constant = |value: f64| [vec![value; 4], vec![0.0; 4]];
    let compare = |a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]| compare_images(view(a, 4), view(b, 4));
    assert_eq!(compare(&constant(1.0), &constant(1.0 + 1e-7)).max_z, 0.0);
    assert_eq!(
        compare(&constant(1.0), &constant(1.0001)).max_z,
        f64::INFINITY
    );
    let broken = [vec![f64::NAN; 4], vec![1.0; 4]];
    assert_eq!(compare(&broken, &constant(1.0)).smallest_p, 0.0);
    let single = [vec![1.0; 4], vec![f64::INFINITY; 4]];
    assert_eq!(compare(&single, &constant(1.0)).smallest_p, 0.0);
}

#[test]
fn no_variance_is_no_excuse() {
    let constant = |x: f64| moments(100, || x);
    check_mean("", constant(1.0 + 1e-7), 1.0, 1e-6).unwrap(); // f32 rounding
    check_mean("", constant(0.999), 1.0, 1e-6).unwrap_err();
    check_mean("", constant(0.0), 1.0, 1e-6).unwrap_err();
    check_mean("", constant(0.0), 0.0, 1e-6).unwrap();
    check_mean("", constant(f64::NAN), 1.0, 1e-6).unwrap_err();
    check_mean("", constant(1.0), f64::NAN, 1e-6).unwrap_err();
    check_mean("", moments(1, || 1.0), 1.0, 1e-6).unwrap_err();
}

#[test]
fn merged_moments_are_those_of_all_samples() {
    let samples: Vec<f64> = (0..100).map(|i| f64::from(i * i % 37)).collect();
    let mut merged: Moments = samples[..30].iter().copied().collect();
    merged.merge(&samples[30..].iter().copied().collect());
    merged.merge(&Moments::new());
    let all: Moments = samples.iter().copied().collect();
    assert_eq!(merged.estimate().count, 100);
    assert!((merged.estimate().mean - all.estimate().mean).abs() < 1e-12);
    assert!((merged.variance() / all.variance() - 1.0).abs() < 1e-12);
}

/// Student's t for one and two degrees of freedom is elementary; up to the switch to the normal
/// distribution it must come near it, by the expansion p ≈ p_∞ + (z³ + z) φ(z)/(2ν).
#[test]
fn p_values_are_students() {
    for z in [0.1, 1.0, 5.0, 40.0] {
        let one = 1.0 - 2.0 / PI * f64::atan(z);
        let two = 1.0 - z / (2.0 + z * z).sqrt();
        assert!((p_value(z, 1.0) / one - 1.0).abs() < 1e-9, "{z}");
        assert!((p_value(z, 2.0) / two - 1.0).abs() < 1e-9, "{z}");
    }
    for z in [0.5, 2.0, 5.0_f64] {
        let density = (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
        let p = p_value(z, 1e12) + (z.powi(3) + z) * density / (2.0 * 9999.0);
        assert!((p_value(z, 9999.0) / p - 1.0).abs() < 1e-3, "{z}");
    }
    assert_eq!(p_value(0.0, 5.0), 1.0);
}

#[test]
fn sidak_of_one_test_is_itself() {
    assert!((sidak(1e-6, 1) - 1e-6).abs() < 1e-20);
    assert!((sidak(1e-6, 1_000_000) - 1e-12).abs() < 1e-17);
}

/// A peak of 0.05 rad in an odd direction, and one a fifth wider.
#[test]
fn chi2_sphere_resolves_narrow_peaks() {
    let wo = -Vec3::new(0.3, -0.8, 0.5).normalize();
    let narrow = Phase::henyey_greenstein(0.95).unwrap();
    let wider = Phase::henyey_greenstein(0.94).unwrap();
    let sample = |u| Some(narrow.sample(wo, u).wi);
    chi2_sphere(sample, |wi| narrow.pdf_w(wo, wi), 100_000, 1e-6).unwrap();
    chi2_sphere(sample, |wi| wider.pdf_w(wo, wi), 100_000, 1e-6).unwrap_err();
}

/// A sphere sampled by area has an infinite density at its silhouette.
#[test]
fn chi2_sphere_forgives_infinite_edges() {
    // Seen from distance 2: density d²/(2π cos) on the facing half.
    let eye = Vec3::new(0.0, 1.2, 1.6);
    let axis = Frame::around(eye.normalize());
    let pdf_of = |p: Vec3| {
        let across = p - eye;
        let cosine = -across.normalize().dot(p);
        (across.length_squared() / (2.0 * PI as f32 * cosine), cosine)
    };
    let sample = |u| {
        let p = axis.to_world(warp::uniform_cone(1.0, u));
        (pdf_of(p).1 > 0.0).then(|| (p - eye).normalize())
    };
    let pdf_w = |factor: f32| {
        move |w: Vec3| {
            let middle = -eye.dot(w);
            let half = 1.0 - (eye + middle * w).length_squared();
            if half <= 0.0 || middle < 0.0 {
                return 0.0;
            }
            factor * pdf_of(eye + (middle - half.sqrt()) * w).0
        }
    };
    chi2_sphere(sample, pdf_w(1.0), 200_000, 1e-6).unwrap();
    chi2_sphere(sample, pdf_w(1.1), 200_000, 1e-6).unwrap_err();
    chi2_sphere(sample, pdf_w(0.9), 200_000, 1e-6).unwrap_err();
}

#[test]
fn chi2_sphere_finds_a_density_of_wrong_normalisation() {
    let sample = |u| Some(warp::uniform_sphere(u));
    let pdf = |factor: f32| move |_| factor / (4.0 * PI as f32);
    chi2_sphere(sample, pdf(1.0), 100_000, 1e-6).unwrap();
    chi2_sphere(sample, pdf(1.02), 100_000, 1e-6).unwrap_err();
    chi2_sphere(sample, pdf(0.98), 100_000, 1e-6).unwrap_err();
    // Three quarters of the samples end: `None` takes what the density leaves.
    let some = |u: [f32; 2]| (u[0] < 0.25).then(|| warp::uniform_sphere([4.0 * u[0], u[1]]));
    chi2_sphere(some, pdf(0.25), 100_000, 1e-6).unwrap();
    chi2_sphere(some, pdf(1.0), 100_000, 1e-6).unwrap_err();
}
