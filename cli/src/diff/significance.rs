//! Whether images differ by more than chance.

use super::pair::Pair;
use serde::Serialize;
use tyndall_testkit::stats::{ImageComparison, ImageEstimate, compare_images, sidak};

/// The probability that images of one expectation are found to differ.
const FALSE_ALARM: f64 = 1e-3;

/// Tests of every channel: the worst pixel, χ², the mean.
const TESTS: usize = 3;

/// What the z-test found.
#[derive(Debug, Serialize)]
pub(crate) struct ZTest {
    pub(crate) verdict: Verdict,
    pub(crate) false_alarm: f64,
    pub(crate) channels: Vec<Channel>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Verdict {
    Agree,
    Differ,
}

/// The tests of a channel. `None` is what is infinite.
#[derive(Debug, Serialize)]
pub(crate) struct Channel {
    pub(crate) channel: &'static str,
    pub(crate) verdict: Verdict,
    /// Shares of the pixels beyond 2 and 3 standard errors.
    pub(crate) beyond_2: f64,
    pub(crate) beyond_3: f64,
    /// The largest difference in standard errors, its pixel in the whole picture, and the
    /// probability of it in one pixel.
    pub(crate) largest: Option<f64>,
    pub(crate) largest_pixel: [i64; 2],
    pub(crate) largest_p: f64,
    pub(crate) chi2: f64,
    pub(crate) degrees_of_freedom: usize,
    pub(crate) chi2_p: f64,
    /// Difference of the means in standard errors.
    pub(crate) mean_z: Option<f64>,
    pub(crate) mean_p: f64,
}

/// The test, or why there is none.
pub(crate) fn test(pair: &Pair<'_>) -> Result<ZTest, String> {
    let [a, b] = [pair.image, pair.reference].map(|image| &image.metadata);
    if pair.image.variance.is_none() || pair.reference.variance.is_none() {
        return Err("it needs the layer `variance` in both images".into());
    }
    if a.passes < 2 || b.passes < 2 {
        return Err("it needs `tyndall.passes` of 2 or more in both images".into());
    }
    if let Some(shared) = a.shared_passes(b) {
        return Err(format!(
            "it needs independent images, and both hold {shared}"
        ));
    }
    let names = pair.channels();
    let each = sidak(FALSE_ALARM, TESTS * names.len());
    let channels: Vec<_> = (names.iter().enumerate())
        .filter_map(|(c, name)| Some(judge(pair, name, &compare(pair, c)?, each)))
        .collect();
    let differ = channels.iter().any(|c| c.verdict == Verdict::Differ) || pair.left_out() > 0;
    Ok(ZTest {
        verdict: if differ {
            Verdict::Differ
        } else {
            Verdict::Agree
        },
        false_alarm: FALSE_ALARM,
        channels,
    })
}

fn compare(pair: &Pair<'_>, channel: usize) -> Option<ImageComparison> {
    let (a, b): (Vec<_>, Vec<_>) = pair.values(channel).unzip();
    let (va, vb): (Vec<_>, Vec<_>) = pair.variances(channel)?.unzip();
    let estimate = |mean, variance_of_mean, passes| ImageEstimate {
        mean,
        variance_of_mean,
        passes,
    };
    Some(compare_images(
        estimate(&a, &va, pair.image.metadata.passes),
        estimate(&b, &vb, pair.reference.metadata.passes),
    ))
}

fn judge(pair: &Pair<'_>, name: &'static str, found: &ImageComparison, each: f64) -> Channel {
    let differ = found.smallest_p < sidak(each, pair.pixels.len())
        || found.chi2_p < each
        || found.mean_p < each;
    let finite = |x: f64| x.is_finite().then_some(x);
    Channel {
        channel: name,
        verdict: if differ {
            Verdict::Differ
        } else {
            Verdict::Agree
        },
        beyond_2: found.beyond[0],
        beyond_3: found.beyond[1],
        largest: finite(found.max_z),
        largest_pixel: pair.place(pair.pixels[found.worst_pixel]),
        largest_p: found.smallest_p,
        chi2: found.chi2,
        degrees_of_freedom: found.varying,
        chi2_p: found.chi2_p,
        mean_z: finite(found.mean_z),
        mean_p: found.mean_p,
    }
}
