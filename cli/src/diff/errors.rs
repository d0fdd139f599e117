//! How far an image is from its reference.

use super::pair::Pair;
use serde::Serialize;

/// What keeps the relative error of black pixels finite (Rousselle et al. 2011).
pub(crate) const EPSILON: f64 = 0.01;

/// The largest difference of a channel.
#[derive(Debug, Serialize)]
pub(crate) struct Largest {
    pub(crate) difference: f64,
    pub(crate) channel: &'static str,
    /// Column and row in the whole picture.
    pub(crate) pixel: [i64; 2],
    pub(crate) image: f64,
    pub(crate) reference: f64,
}

/// The mean of a channel over that of the reference.
#[derive(Debug, Serialize)]
pub(crate) struct Ratio {
    pub(crate) channel: &'static str,
    /// None if the reference is black.
    pub(crate) ratio: Option<f64>,
    /// Of the ratio; none without variances.
    pub(crate) standard_error: Option<f64>,
}

/// The mean over pixels and channels of (a − b)², and of (a − b)²/(b² + ε).
pub(crate) fn mean_squares(pair: &Pair<'_>) -> (f64, f64) {
    let channels = pair.channels().len();
    let (mut square, mut relative) = (0.0, 0.0);
    for (a, b) in (0..channels).flat_map(|c| pair.values(c)) {
        let error = (a - b).powi(2);
        square += error;
        relative += error / (b * b + EPSILON);
    }
    let values = (channels * pair.pixels.len()) as f64;
    (square / values, relative / values)
}

/// The first of the largest differences.
pub(crate) fn largest(pair: &Pair<'_>) -> Largest {
    let channels = pair.channels();
    let all = (0..channels.len()).flat_map(|c| {
        let values = pair.values(c).zip(&pair.pixels);
        values.map(move |((a, b), &pixel)| (c, pixel, a, b))
    });
    let farther = |x: (usize, usize, f64, f64), y: (usize, usize, f64, f64)| {
        if (y.2 - y.3).abs() > (x.2 - x.3).abs() {
            y
        } else {
            x
        }
    };
    let (channel, pixel, image, reference) = all.reduce(farther).unwrap_or_default();
    Largest {
        difference: (image - reference).abs(),
        channel: channels[channel],
        pixel: pair.place(pixel),
        image,
        reference,
    }
}

/// The ratio r = ā/b̄ of every channel, and its standard error |r|·√(V(ā)/ā² + V(b̄)/b̄²) with
/// pixels taken as independent (the delta method).
pub(crate) fn ratios(pair: &Pair<'_>) -> Vec<Ratio> {
    let ratio = |(c, channel): (usize, &&'static str)| {
        let sums = |(a, b), (x, y)| (a + x, b + y);
        let (a, b): (f64, f64) = pair.values(c).fold((0.0, 0.0), sums);
        let ratio = Some(a / b).filter(|r| r.is_finite());
        let error = |r: f64| {
            let (va, vb): (f64, f64) = pair.variances(c)?.fold((0.0, 0.0), sums);
            // Without the division by ā, which may be 0.
            let error = (va + r * r * vb).sqrt() / b.abs();
            error.is_finite().then_some(error)
        };
        Ratio {
            channel,
            ratio,
            standard_error: ratio.and_then(error),
        }
    };
    pair.channels().iter().enumerate().map(ratio).collect()
}
