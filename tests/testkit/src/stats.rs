//! Statistical tests that state how often they err.
//!
//! Every test takes a `false_alarm`: the probability that it fails although the code is right.
//! With a fixed seed a test that has passed passes for ever; the rate is the chance that an
//! innocent change of the random numbers breaks it. 1e-6 is a good rate for one test among
//! thousands; its threshold is 4.9 standard errors.
//!
//! | question | test |
//! |---|---|
//! | is this mean the closed form? | [`assert_mean`], [`check_mean`], [`check_means`] and [`Figures`] for many |
//! | do two estimates agree? | [`Estimate::difference`], then [`check_mean`] against 0 |
//! | do two images agree? | [`z_test_images`] |
//! | do samples follow this density of directions? | [`chi2_sphere`] |
//! | do counts follow these expectations? | [`chi2_test`] |
//! | do numbers follow this distribution? | [`kolmogorov_smirnov`] |
//!
//! Errors that fall as a power have no test of their own: [`rmse`] measures them, [`log_log_slope`]
//! the power with its standard error.

mod chi2;
mod figures;
mod image;
mod kolmogorov;
mod mean;
mod slope;
mod sphere;

pub use chi2::chi2_test;
pub use figures::Figures;
pub use image::{ImageComparison, ImageEstimate, compare_images, z_test_images};
pub use kolmogorov::kolmogorov_smirnov;
pub use mean::{
    Estimate, Moments, ROUNDING, assert_mean, check_mean, check_means, extrapolated, p_value,
};
pub use slope::{Slope, log_log_slope, rmse};
pub use sphere::chi2_sphere;
pub(crate) use sphere::integral_near;

/// The false-alarm rate of each of `tests` independent tests, so that together they fail with
/// probability `false_alarm`: 1 − (1 − α)^(1/n).
///
/// Šidák (1967). For dependent estimates of normal error the rate is an upper bound.
///
/// ```
/// let each = tyndall_testkit::stats::sidak(0.01, 10);
/// assert!((each - 0.0010045).abs() < 1e-7);
/// ```
///
/// # Panics
/// If `false_alarm` is not in (0, 1) or `tests` is 0.
pub fn sidak(false_alarm: f64, tests: usize) -> f64 {
    assert!(
        false_alarm > 0.0 && false_alarm < 1.0,
        "a false-alarm rate lies in (0, 1), not at {false_alarm}"
    );
    assert!(tests > 0, "no tests to share the false-alarm rate");
    -((-false_alarm).ln_1p() / tests as f64).exp_m1()
}
