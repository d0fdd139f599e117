//! What the picture should be.

use crate::{Host, Method};
use std::error::Error;
use std::time::Duration;
use tyndall_driver::{Budget, Render};
use tyndall_testkit::stats::{Estimate, ImageEstimate, Moments, z_test_images};

/// Independent renders of a picture: pixels of one share their beams, renders nothing.
const RENDERS: u64 = 12;
/// Sides of the blocks by which pictures are compared, in pixels.
const BLOCK: usize = 10;

/// A picture with its standard errors, those of blocks too.
pub(crate) struct Reference {
    /// Per pixel and channel.
    pixels: Vec<Estimate>,
    blocks: Vec<Estimate>,
}

/// Renders a picture for so long, on seeds from `seed` on.
pub(crate) fn render(
    host: &Host,
    method: &Method,
    seconds: f64,
    seed: u64,
) -> Result<Reference, Box<dyn Error>> {
    let budget = Budget::Time(Duration::from_secs_f64(seconds / RENDERS as f64));
    let (mut pixels, mut blocks) = (Vec::new(), Vec::new());
    for seed in (seed..).take(RENDERS as usize) {
        let film = Render::new(host, method).seed(seed).run(budget, |_| {})?;
        gather(&mut pixels, film.mean().iter().copied());
        gather(&mut blocks, of_blocks(film.resolution(), film.mean()));
    }
    let estimates = |all: Vec<Moments>| all.iter().map(Moments::estimate).collect();
    Ok(Reference {
        pixels: estimates(pixels),
        blocks: estimates(blocks),
    })
}

fn gather(moments: &mut Vec<Moments>, values: impl IntoIterator<Item = f64>) {
    for (i, value) in values.into_iter().enumerate() {
        if i == moments.len() {
            moments.push(Moments::new());
        }
        moments[i].push(value);
    }
}

/// Means over blocks and channels.
fn of_blocks([width, height]: [u32; 2], values: &[f64]) -> Vec<f64> {
    let [width, height] = [width, height].map(|side| side as usize);
    let mut sums = vec![0.0; width.div_ceil(BLOCK) * height.div_ceil(BLOCK)];
    let channels = values.len() / (width * height);
    for (i, value) in values.iter().enumerate() {
        let [x, y] = [i / channels % width, i / channels / width];
        sums[y / BLOCK * width.div_ceil(BLOCK) + x / BLOCK] += value;
    }
    let count = (BLOCK * BLOCK * channels) as f64;
    sums.into_iter().map(|sum| sum / count).collect()
}

impl Reference {
    /// The mean over all pixels and channels.
    fn mean(&self) -> f64 {
        self.pixels.iter().map(|p| p.mean).sum::<f64>() / self.pixels.len() as f64
    }

    /// The squares of its own errors, as those of a picture.
    pub(crate) fn own_squared_errors(&self) -> [f64; 2] {
        self.squared_errors(self.pixels.iter().map(|p| p.standard_error))
    }

    /// The squares of the errors of a picture, without what of them is due to those of the reference.
    pub(crate) fn squared_errors_of(&self, picture: &[f64]) -> [f64; 2] {
        let differences = self.pixels.iter().zip(picture);
        let found = self.squared_errors(differences.map(|(p, found)| found - p.mean));
        let own = self.own_squared_errors();
        [found[0] - own[0], found[1] - own[1]]
    }

    /// Means over the pixels x of differences d: of d² over the squared mean of x, and of
    /// d²/(x² + ε) with ε the square of a tenth of the mean.
    fn squared_errors(&self, differences: impl Iterator<Item = f64>) -> [f64; 2] {
        let mean = self.mean();
        let epsilon = (0.1 * mean).powi(2);
        let mut sums = [0.0; 2];
        for (difference, pixel) in differences.zip(&self.pixels) {
            let square = difference * difference;
            sums[0] += square / (mean * mean);
            sums[1] += square / (pixel.mean * pixel.mean + epsilon);
        }
        sums.map(|sum| sum / self.pixels.len() as f64)
    }

    /// Compares blocks with those of another, in a sentence.
    pub(crate) fn compare(&self, other: &Self) -> String {
        let [ours, theirs] = [self, other].map(|picture| {
            let means: Vec<_> = picture.blocks.iter().map(|b| b.mean).collect();
            let variances = picture.blocks.iter().map(|b| b.standard_error.powi(2));
            (means, variances.collect::<Vec<_>>())
        });
        let [a, b] = [&ours, &theirs].map(|(mean, variance)| ImageEstimate {
            mean,
            variance_of_mean: variance,
            passes: RENDERS,
        });
        match z_test_images(a, b, 1e-3) {
            Ok(same) => format!(
                "the same at a false-alarm rate of 1e-3: worst of {} blocks {:.1} standard errors \
                 off, {:.1} % beyond 2, as a whole {:+.2} % ({:+.1} standard errors)",
                self.blocks.len(),
                same.max_z,
                100.0 * same.beyond[0],
                100.0 * same.relative_difference,
                same.mean_z,
            ),
            Err(why) => format!("not the same: {why}"),
        }
    }
}
