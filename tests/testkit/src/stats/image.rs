//! Comparison of images.

use super::{Estimate, ROUNDING, p_value, sidak};
use statrs::function::{
    erf::{erfc, erfc_inv},
    gamma::gamma_ur,
};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// From this many degrees of freedom on, χ² is Wilson and Hilferty's (1931) normal cube root: at
/// five standard deviations the probabilities differ by less than 1 %.
const CUBE_ROOT_FROM: usize = 10_000;

/// An image with its uncertainty, one number a pixel and channel.
#[derive(Clone, Copy, Debug)]
pub struct ImageEstimate<'a> {
    /// Mean of the passes.
    pub mean: &'a [f64],
    /// Variance *of the mean*: the variance of a pass divided by `passes`.
    pub variance_of_mean: &'a [f64],
    /// Independent passes behind every pixel.
    pub passes: u64,
}

impl ImageEstimate<'_> {
    fn pixel(&self, i: usize) -> Estimate {
        Estimate {
            mean: self.mean[i],
            standard_error: self.variance_of_mean[i].sqrt(),
            count: self.passes,
        }
    }

    fn whole(&self) -> Estimate {
        Estimate {
            mean: self.mean.iter().sum(),
            standard_error: self.variance_of_mean.iter().sum::<f64>().sqrt(),
            count: self.passes.saturating_mul(self.mean.len() as u64),
        }
    }
}

/// How two images differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageComparison {
    /// Largest |difference| of a pixel in standard errors; pixels without variance count as 0
    /// where they are equal and as infinite where not.
    pub max_z: f64,
    /// The pixel where it is found.
    pub worst_pixel: usize,
    /// Smallest probability of a pixel's difference, before correction for their number.
    pub smallest_p: f64,
    /// Sum of the squared differences in standard errors over the pixels that vary, each taken
    /// over from Student's t to the normal deviate of the same probability (at most 37.6).
    pub chi2: f64,
    /// Pixels that vary in either image: the degrees of freedom of `chi2`.
    pub varying: usize,
    /// Probability of at least this `chi2`; 1 if no pixel varies.
    pub chi2_p: f64,
    /// Shares of the pixels that vary whose normal deviate is beyond 2 and 3 on either side:
    /// 0.0455 and 0.0027 are expected.
    pub beyond: [f64; 2],
    /// Difference of the sums over all pixels in standard errors, with its sign.
    pub mean_z: f64,
    /// Probability of at least this |`mean_z`|.
    pub mean_p: f64,
    /// The sum of `a` over that of `b`, minus 1.
    pub relative_difference: f64,
}

/// Compares two independent renders pixel by pixel and as a whole.
///
/// Per pixel Welch's t (the variances come from few passes and differ); over the whole, the
/// difference of the sums, with pixels taken as independent. A pixel that varies in neither image
/// must be equal; [`ROUNDING`] is forgiven everywhere.
///
/// # Panics
/// If the four slices differ in length, are empty, or an image has fewer than two passes.
pub fn compare_images(a: ImageEstimate<'_>, b: ImageEstimate<'_>) -> ImageComparison {
    let pixels = a.mean.len();
    assert!(pixels > 0, "an image without pixels");
    for other in [
        a.variance_of_mean.len(),
        b.mean.len(),
        b.variance_of_mean.len(),
    ] {
        assert_eq!(pixels, other, "images of different size");
    }
    assert!(a.passes > 1 && b.passes > 1, "a variance needs two passes");
    let (mut max_z, mut worst_pixel, mut smallest_p) = (0.0, 0, 1.0);
    let (mut chi2, mut varying, mut beyond) = (0.0, 0, [0_usize; 2]);
    for i in 0..pixels {
        let (z, p) = deviation(a.pixel(i), b.pixel(i));
        if p < smallest_p || z > max_z {
            (max_z, worst_pixel, smallest_p) = (z.max(max_z), i, p.min(smallest_p));
        }
        if a.variance_of_mean[i] != 0.0 || b.variance_of_mean[i] != 0.0 {
            let deviate = SQRT_2 * erfc_inv(p.max(f64::MIN_POSITIVE));
            chi2 += deviate * deviate;
            varying += 1;
            beyond[0] += usize::from(deviate > 2.0);
            beyond[1] += usize::from(deviate > 3.0);
        }
    }
    let (whole_a, whole_b) = (a.whole(), b.whole());
    let (mean_z, _) = deviation(whole_a, whole_b);
    ImageComparison {
        max_z,
        worst_pixel,
        smallest_p,
        chi2,
        varying,
        chi2_p: chi2_p(chi2, varying),
        beyond: beyond.map(|n| n as f64 / varying.max(1) as f64),
        mean_z: mean_z.copysign(whole_a.mean - whole_b.mean),
        mean_p: p_value(mean_z, f64::INFINITY),
        relative_difference: whole_a.mean / whole_b.mean - 1.0,
    }
}

/// Probability of at least `chi2` with `freedom` degrees of freedom.
fn chi2_p(chi2: f64, freedom: usize) -> f64 {
    if chi2 == 0.0 {
        return 1.0;
    }
    let k = freedom as f64;
    if freedom < CUBE_ROOT_FROM {
        return gamma_ur(0.5 * k, 0.5 * chi2);
    }
    let variance = 2.0 / (9.0 * k);
    let deviate = ((chi2 / k).cbrt() - (1.0 - variance)) / variance.sqrt();
    0.5 * erfc(deviate * FRAC_1_SQRT_2)
}

/// |a − b| in standard errors and its probability; infinite and 0 for what is no number.
fn deviation(a: Estimate, b: Estimate) -> (f64, f64) {
    let difference = a.difference(&b);
    if !difference.mean.is_finite() || !difference.standard_error.is_finite() {
        return (f64::INFINITY, 0.0);
    }
    let distance = (difference.mean.abs() - ROUNDING * b.mean.abs()).max(0.0);
    if distance == 0.0 {
        return (0.0, 1.0);
    }
    let z = distance / difference.standard_error;
    if z.is_infinite() {
        return (z, 0.0);
    }
    (z, p_value(z, difference.count.max(2) as f64 - 1.0))
}

/// Whether two independent renders show the same picture: [`compare_images`] at the given
/// false-alarm rate, half of it for the worst pixel with Šidák's correction, half for the mean.
///
/// # Errors
/// A sentence with the worst pixel or the difference of the means.
///
/// # Panics
/// As [`compare_images`].
pub fn z_test_images(
    a: ImageEstimate<'_>,
    b: ImageEstimate<'_>,
    false_alarm: f64,
) -> Result<ImageComparison, String> {
    let comparison = compare_images(a, b);
    let half = sidak(false_alarm, 2);
    let each = sidak(half, a.mean.len());
    if comparison.smallest_p < each {
        let i = comparison.worst_pixel;
        return Err(format!(
            "pixel {i}: {} and {} differ by {:.1} standard errors (probability {:.1e}, threshold {each:.1e})",
            a.mean[i], b.mean[i], comparison.max_z, comparison.smallest_p
        ));
    }
    if comparison.mean_p < half {
        return Err(format!(
            "the images differ by {:+.3} % as a whole, {:+.1} standard errors",
            100.0 * comparison.relative_difference,
            comparison.mean_z
        ));
    }
    Ok(comparison)
}
