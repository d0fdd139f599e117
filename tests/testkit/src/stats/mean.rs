//! Means and their standard errors.

use super::sidak;
use statrs::function::{beta::beta_reg, erf::erfc};
use std::f64::consts::FRAC_1_SQRT_2;

/// Relative error of a mean that is put down to arithmetic in `f32`, not to chance: 2e-6, 16 units
/// in the last place.
///
/// Without it an estimator of no variance (a furnace that gives 1 ± 1e-7) would fail for its
/// rounding. A defect smaller than this is invisible.
pub const ROUNDING: f64 = 2e-6;

/// From this many degrees of freedom on, Student's t is the normal distribution: at |z| = 5 the
/// probabilities differ by less than 2 %.
const NORMAL_FROM: f64 = 10_000.0;

/// A mean with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean of the samples.
    pub mean: f64,
    /// Standard deviation of the mean.
    pub standard_error: f64,
    /// Independent samples; `count − 1` are the degrees of freedom of the standard error.
    pub count: u64,
}

impl Estimate {
    /// The standard error over |mean|.
    pub fn relative_standard_error(&self) -> f64 {
        self.standard_error / self.mean.abs()
    }

    /// This minus an independent `other`, with the degrees of freedom of Welch (1947) and
    /// Satterthwaite (1946).
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        let (a, b) = (self.standard_error.powi(2), other.standard_error.powi(2));
        let freedom = (a + b).powi(2) / (a * a / self.freedom() + b * b / other.freedom());
        let count = if freedom.is_finite() {
            freedom as u64 + 1
        } else {
            self.count.min(other.count)
        };
        Self {
            mean: self.mean - other.mean,
            standard_error: (a + b).sqrt(),
            count,
        }
    }

    /// This, times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            mean: factor * self.mean,
            standard_error: factor.abs() * self.standard_error,
            ..*self
        }
    }

    fn freedom(&self) -> f64 {
        self.count as f64 - 1.0
    }
}

/// What is left of two independent estimates, the second at twice the radius of the first, without a
/// bias ∝ r^`order` (Richardson 1911).
///
/// ```
/// use tyndall_testkit::stats::{Moments, extrapolated};
/// let [narrow, wide] = [[1.1, 1.1], [1.4, 1.4]].map(|samples| {
///     let moments: Moments = samples.into_iter().collect();
///     moments.estimate()
/// });
/// assert!((extrapolated(narrow, wide, 2).mean - 1.0).abs() < 1e-12);
/// ```
pub fn extrapolated(narrow: Estimate, wide: Estimate, order: i32) -> Estimate {
    let ratio = 2.0_f64.powi(order);
    let share = 1.0 / (ratio - 1.0);
    narrow.scaled(ratio * share).difference(&wide.scaled(share))
}

/// Running mean and variance in `f64` (Welford 1962), mergeable (Chan et al. 1979).
///
/// ```
/// use tyndall_testkit::stats::Moments;
/// let mut m = Moments::new();
/// [1.0, 2.0, 3.0].into_iter().for_each(|x| m.push(x));
/// let e = m.estimate();
/// assert_eq!((e.mean, e.count), (2.0, 3));
/// assert!((e.standard_error - (1.0f64 / 3.0).sqrt()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Of no samples.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a sample. A sample that is not finite makes the estimate so.
    pub fn push(&mut self, sample: f64) {
        self.count += 1;
        let delta = sample - self.mean;
        self.mean += delta / self.count as f64;
        self.squares += delta * (sample - self.mean);
    }

    /// Adds all samples of `other`.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (a, b) = (self.count as f64, other.count as f64);
        let delta = other.mean - self.mean;
        self.mean += delta * b / (a + b);
        self.squares += other.squares + delta * delta * a * b / (a + b);
        self.count += other.count;
    }

    /// Unbiased variance of one sample; infinite for fewer than two.
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            return f64::INFINITY;
        }
        self.squares / (self.count - 1) as f64
    }

    /// The mean and its standard error; the error is infinite for fewer than two samples.
    pub fn estimate(&self) -> Estimate {
        Estimate {
            mean: self.mean,
            standard_error: (self.variance() / self.count.max(1) as f64).sqrt(),
            count: self.count,
        }
    }
}

impl Extend<f64> for Moments {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, samples: I) {
        samples.into_iter().for_each(|x| self.push(x));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(samples: I) -> Self {
        let mut moments = Self::new();
        moments.extend(samples);
        moments
    }
}

/// Probability that a right estimate lies at least `deviation` standard errors from its
/// expectation, on either side: Student's t with `freedom` degrees of freedom, the normal
/// distribution from 10,000 on.
///
/// ```
/// use tyndall_testkit::stats::p_value;
/// assert!((p_value(1.959964, 1e6) - 0.05).abs() < 1e-7);
/// assert!((p_value(2.228139, 10.0) - 0.05).abs() < 1e-7);
/// ```
///
/// # Panics
/// If `freedom` is not positive or `deviation` is NaN.
pub fn p_value(deviation: f64, freedom: f64) -> f64 {
    assert!(freedom > 0.0, "no degrees of freedom: {freedom}");
    assert!(!deviation.is_nan(), "the deviation is NaN");
    if freedom >= NORMAL_FROM {
        return erfc(deviation.abs() * FRAC_1_SQRT_2);
    }
    let x = freedom / (freedom + deviation * deviation);
    beta_reg(0.5 * freedom, 0.5, x)
}

/// Whether `estimate` agrees with `expected`.
///
/// Two-sided t-test at the given false-alarm rate. It presumes that the mean of the samples is
/// normal: heavy tails need more of them. [`ROUNDING`]·|expected| of the deviation is forgiven.
///
/// # Errors
/// A sentence with the figures if they disagree, if the mean or its error is not finite, or if
/// there are fewer than two samples.
pub fn check_mean(
    name: &str,
    estimate: Estimate,
    expected: f64,
    false_alarm: f64,
) -> Result<(), String> {
    let Estimate {
        mean,
        standard_error,
        count,
    } = estimate;
    let finite = mean.is_finite() && expected.is_finite();
    if count < 2 || !finite || !(0.0..f64::INFINITY).contains(&standard_error) {
        return Err(format!(
            "{name}: {mean} ± {standard_error} of {count} samples is no estimate of {expected}"
        ));
    }
    let deviation = ((mean - expected).abs() - ROUNDING * expected.abs()).max(0.0);
    let p = match (deviation, standard_error) {
        (0.0, _) => 1.0,
        (_, 0.0) => 0.0,
        _ => p_value(deviation / standard_error, estimate.freedom()),
    };
    if p >= false_alarm {
        return Ok(());
    }
    Err(format!(
        "{name}: {mean:.7e} ± {standard_error:.1e} of {count} samples, expected {expected:.7e}: \
         {:.1} standard errors off, {:+.3} % (probability {p:.1e}, threshold {false_alarm:.1e})",
        (mean - expected) / standard_error,
        100.0 * (mean / expected - 1.0),
    ))
}

/// [`check_mean`] that panics.
///
/// ```
/// use tyndall_testkit::{rng, stats::{Moments, assert_mean}};
/// use tyndall_core::Sampler;
/// let mut sampler = rng(1);
/// let m: Moments = (0..10_000).map(|_| f64::from(sampler.next_1d())).collect();
/// assert_mean("a uniform number", m.estimate(), 0.5, 1e-6);
/// ```
///
/// # Panics
/// If `estimate` disagrees with `expected`.
#[track_caller]
pub fn assert_mean(name: &str, estimate: Estimate, expected: f64, false_alarm: f64) {
    if let Err(why) = check_mean(name, estimate, expected, false_alarm) {
        panic!("{why}");
    }
}

/// [`check_mean`] of many estimates, with `false_alarm` for all of them together ([`sidak`]).
///
/// # Errors
/// One line for every estimate that disagrees.
///
/// # Panics
/// If there are no cases.
pub fn check_means(cases: &[(&str, Estimate, f64)], false_alarm: f64) -> Result<(), String> {
    let each = sidak(false_alarm, cases.len());
    let wrong: Vec<String> = cases
        .iter()
        .filter_map(|(name, estimate, expected)| check_mean(name, *estimate, *expected, each).err())
        .collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(wrong.join("\n"))
}
