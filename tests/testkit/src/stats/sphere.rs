//! χ² test of sampled directions.

mod cells;

use super::{chi2_test, p_value, sidak};
use cells::{CELLS, COLUMNS, Integral, ROWS, cell, integrate};
use glam::Vec3;
use tyndall_core::Sampler;

/// Absolute error of the quadrature over the whole sphere that its own estimate may miss.
const QUADRATURE: f64 = 1e-4;
/// Least probability of a cell: not impossible, since a light may reach into it between the nodes of
/// the quadrature, but pooled with others.
const UNSEEN: f64 = 1e-12;

/// Whether sampled directions follow their density per steradian, at the given false-alarm rate.
///
/// Draws `samples` directions, counts them in 16 × 32 cells of equal solid angle over the whole
/// sphere (cos θ × φ) and compares with the integral of `pdf_w` over every cell by adaptive
/// quadrature ([`chi2_test`]; its rate holds). `None` is an outcome of its own: it expects what
/// `pdf_w` leaves of 1. Its count is tested by itself as well, each test at half the rate, so a
/// density of wrong normalisation fails too. The numbers `u` come from a fixed seed; a `sample`
/// that needs more of them brings its own.
///
/// Resolves |g| to 0.95 of Henyey–Greenstein in any orientation. Where the density jumps, or has an
/// infinite edge (a sphere sampled by area), the quadrature estimates its own error, and counts
/// within it are forgiven.
///
/// ```
/// use std::f32::consts::PI;
/// use tyndall_core::warp::{cosine_hemisphere, cosine_hemisphere_pdf_w};
/// use tyndall_testkit::stats::chi2_sphere;
/// let pdf_w = |w: glam::Vec3| cosine_hemisphere_pdf_w(w.z);
/// chi2_sphere(|u| Some(cosine_hemisphere(u)), pdf_w, 20_000, 1e-6).unwrap();
/// let wrong = |w: glam::Vec3| if w.z > 0.0 { 0.5 / PI } else { 0.0 };
/// assert!(chi2_sphere(|u| Some(cosine_hemisphere(u)), wrong, 20_000, 1e-6).is_err());
/// ```
///
/// # Errors
/// A sentence if the counts disagree, if `pdf_w` is negative or not finite or integrates to more
/// than 1, or if a direction is no unit vector.
pub fn chi2_sphere(
    mut sample: impl FnMut([f32; 2]) -> Option<Vec3>,
    pdf_w: impl Fn(Vec3) -> f32,
    samples: usize,
    false_alarm: f64,
) -> Result<(), String> {
    let mut sampler = crate::rng(samples as u64);
    let mut observed = vec![0.0; CELLS + 1];
    for _ in 0..samples {
        match sample(sampler.next()) {
            Some(w) if (w.length() - 1.0).abs() < 1e-3 => observed[cell(w)] += 1.0,
            Some(w) => return Err(format!("sampled {w}, which is no unit vector")),
            None => observed[CELLS] += 1.0,
        }
    }
    let integrals = integrate(&pdf_w)?;
    let total: Integral = integrals.iter().copied().sum();
    let error = total.error + QUADRATURE;
    if total.value > 1.0 + error {
        let Integral { value, .. } = total;
        return Err(format!("the density integrates to {value:.5}, more than 1"));
    }
    let none = Integral {
        value: 1.0 - total.value,
        error,
    };
    let n = samples as f64;
    let mut expected: Vec<f64> = integrals
        .iter()
        .chain([&none])
        .zip(&observed)
        .map(|(integral, o)| n * integral.nearest(o / n))
        .collect();
    let half = sidak(false_alarm, 2);
    check_none(observed[CELLS], expected[CELLS], n, half)?;
    expected[..CELLS]
        .iter_mut()
        .for_each(|e| *e = e.max(UNSEEN * n));
    let drift = n / expected.iter().sum::<f64>();
    expected.iter_mut().for_each(|e| *e *= drift);
    chi2_test(&observed, &expected, half).map_err(describe)
}

/// The value nearest to `guess` that ∫ f dω over the sphere can have, by the quadrature of
/// [`chi2_sphere`] and its error; for an integral of order 1.
///
/// # Errors
/// If `f` is negative or not finite.
pub(crate) fn integral_near(f: impl Fn(Vec3) -> f32, guess: f64) -> Result<f64, String> {
    let total: Integral = integrate(&f)?.into_iter().sum();
    let error = total.error + QUADRATURE;
    Ok(Integral { error, ..total }.nearest(guess))
}

/// Binomial test of the number of `None`, where the normal distribution approximates it.
fn check_none(observed: f64, expected: f64, n: f64, false_alarm: f64) -> Result<(), String> {
    let variance = expected * (1.0 - expected / n);
    let deviation = (observed - expected) / variance.sqrt();
    if variance < 25.0 || p_value(deviation, f64::INFINITY) >= false_alarm {
        return Ok(());
    }
    Err(format!(
        "{observed} of {n} samples are `None`, {expected:.1} expected of what the density leaves of 1"
    ))
}

/// Says where the cells of a message are.
fn describe(message: String) -> String {
    format!(
        "{message} (cell i: cos θ from 2·⌊i/{COLUMNS}⌋/{ROWS} − 1, \
         φ from 2π·(i mod {COLUMNS})/{COLUMNS}; cell {CELLS} is `None`)"
    )
}
