//! The Kolmogorov–Smirnov test.

/// Whether samples follow a continuous distribution, at the given false-alarm rate.
///
/// The statistic is the largest distance between the empirical and the given distribution
/// function; its probability is Kolmogorov's (1933) with the correction of Stephens (1970) for
/// finite samples, conservative within a few per cent from 8 samples on. Sorts `samples`.
///
/// ```
/// use tyndall_testkit::stats::kolmogorov_smirnov;
/// let mut even: Vec<f64> = (0..100).map(|i| (i as f64 + 0.5) / 100.0).collect();
/// assert!(kolmogorov_smirnov(&mut even, |x| x, 1e-3).is_ok());
/// assert!(kolmogorov_smirnov(&mut even, |x| x * x, 1e-3).is_err());
/// ```
///
/// # Errors
/// A sentence with the place of the largest distance, or if there are fewer than 8 samples or one
/// is NaN.
pub fn kolmogorov_smirnov(
    samples: &mut [f64],
    cdf: impl Fn(f64) -> f64,
    false_alarm: f64,
) -> Result<(), String> {
    if samples.len() < 8 || samples.iter().any(|x| x.is_nan()) {
        return Err(format!("{} samples: fewer than 8, or NaN", samples.len()));
    }
    samples.sort_by(f64::total_cmp);
    let n = samples.len() as f64;
    let mut worst = (0.0, samples[0]);
    for (i, &x) in samples.iter().enumerate() {
        let below = cdf(x);
        if !(-1e-9..=1.0 + 1e-9).contains(&below) {
            return Err(format!("the distribution function is {below} at {x}"));
        }
        let distance = (below - i as f64 / n).max((i + 1) as f64 / n - below);
        if distance > worst.0 {
            worst = (distance, x);
        }
    }
    let p = kolmogorov((n.sqrt() + 0.12 + 0.11 / n.sqrt()) * worst.0);
    if p >= false_alarm {
        return Ok(());
    }
    Err(format!(
        "the distributions of {n} samples differ by {:.4} at {:.6e} (probability {p:.1e}, \
         threshold {false_alarm:.1e})",
        worst.0, worst.1
    ))
}

/// Probability that Kolmogorov's statistic exceeds `lambda`: 2 Σ (−1)^(k−1) exp(−2k²λ²).
fn kolmogorov(lambda: f64) -> f64 {
    if lambda < 0.2 {
        return 1.0; // 1 − 1e-12; the series converges slowly here
    }
    let term = |k: i32| {
        let k = f64::from(k);
        (-2.0 * k * k * lambda * lambda).exp()
    };
    let sum: f64 = (1..=50)
        .map(|k| if k % 2 == 1 { term(k) } else { -term(k) })
        .sum();
    (2.0 * sum).clamp(0.0, 1.0)
}
