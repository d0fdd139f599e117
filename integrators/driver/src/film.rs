//! What the passes of a render add up to.

use serde::{Deserialize, Serialize};
use std::marker::PhantomData;
use tyndall_core::{Spectrum, Splat, Tile};

/// The mean of the passes and its variance, per pixel and channel, in `f64`.
///
/// A pass counts as one sample, whatever is correlated within it. What is serialised is exact:
/// passes added afterwards give the bits that they would have given before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "S: Spectrum", try_from = "Unchecked")]
pub struct Film<S> {
    resolution: [u32; 2],
    passes: u64,
    /// Row by row, channels innermost.
    mean: Vec<f64>,
    /// Sum of squared deviations from the mean (Welford 1962).
    deviations: Vec<f64>,
    non_finite: u64,
    #[serde(skip)]
    channels: PhantomData<S>,
}

/// The values of a [`Film`] as they are read.
#[derive(Deserialize)]
struct Unchecked {
    resolution: [u32; 2],
    passes: u64,
    mean: Vec<f64>,
    deviations: Vec<f64>,
    non_finite: u64,
}

impl<S: Spectrum> TryFrom<Unchecked> for Film<S> {
    type Error = &'static str;

    fn try_from(film: Unchecked) -> Result<Self, Self::Error> {
        let [width, height] = film.resolution.map(u128::from);
        let values = width * height * S::CHANNELS as u128;
        if [&film.mean, &film.deviations].map(|v| v.len() as u128) != [values; 2] {
            return Err("the film's values do not fill its pixels and channels");
        }
        let all = film.mean.iter().chain(&film.deviations);
        if !all.copied().all(f64::is_finite) || film.deviations.iter().any(|d| *d < 0.0) {
            return Err("the film holds values that no render has");
        }
        Ok(Self {
            resolution: film.resolution,
            passes: film.passes,
            mean: film.mean,
            deviations: film.deviations,
            non_finite: film.non_finite,
            channels: PhantomData,
        })
    }
}

/// Films that do not show the same pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a film of {}×{} pixels does not go with one of {}×{}", .0[0], .0[1], .1[0], .1[1])]
pub struct DifferentResolution([u32; 2], [u32; 2]);

impl DifferentResolution {
    pub(crate) fn check(ours: [u32; 2], theirs: [u32; 2]) -> Result<(), Self> {
        match ours == theirs {
            true => Ok(()),
            false => Err(Self(ours, theirs)),
        }
    }
}

impl<S: Spectrum> Film<S> {
    /// An empty film of this width and height in pixels.
    pub fn new(resolution: [u32; 2]) -> Self {
        let values = resolution[0] as usize * resolution[1] as usize * S::CHANNELS;
        Self {
            resolution,
            passes: 0,
            mean: vec![0.0; values],
            deviations: vec![0.0; values],
            non_finite: 0,
            channels: PhantomData,
        }
    }

    /// The film that has this mean and [`Film::variance_of_mean`] after `passes`, row by row,
    /// `CHANNELS` values a pixel: an image read back from a file. The variance after a single pass
    /// is not looked at.
    ///
    /// # Panics
    /// If the numbers of values are not those of the resolution.
    pub fn from_image(
        resolution: [u32; 2],
        passes: u64,
        mean: Vec<f64>,
        variance_of_mean: &[f64],
    ) -> Self {
        let film = Self::new(resolution);
        assert_eq!(mean.len(), film.mean.len(), "values of the mean");
        assert_eq!(variance_of_mean.len(), mean.len(), "values of the variance");
        let n = passes as f64;
        let deviation = |v: &f64| match passes {
            0 | 1 => 0.0,
            _ => v * n * (n - 1.0),
        };
        Self {
            passes,
            mean,
            deviations: variance_of_mean.iter().map(deviation).collect(),
            ..film
        }
    }

    /// Width and height in pixels.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// Passes added so far.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// Samples that were NaN or infinite. They count as black, which is a bias: a render that
    /// reports any has a defect in its host or integrator.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }

    /// Radiance, row by row, `CHANNELS` values a pixel.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Variance of [`Film::mean`] (the squared standard error), in the same order; infinite for a
    /// single pass.
    pub fn variance_of_mean(&self) -> impl Iterator<Item = f64> + '_ {
        let n = self.passes as f64;
        self.deviations.iter().map(move |d| match self.passes {
            0 | 1 => f64::INFINITY,
            _ => d / (n * (n - 1.0)),
        })
    }

    /// Root mean square over pixels and channels of the standard error, over the mean radiance of
    /// the image. 0 where nothing varies (a black image); infinite for a single pass.
    pub fn relative_error(&self) -> f64 {
        let values = self.mean.len() as f64;
        let mean = self.mean.iter().sum::<f64>() / values;
        let variance = self.variance_of_mean().sum::<f64>() / values;
        if variance > 0.0 {
            variance.sqrt() / mean
        } else {
            0.0
        }
    }

    /// What the splats of a pass add to each value of the film, summed in `f64`; nothing where
    /// there are none. One beside the film is dropped.
    fn gather_splats(&mut self, splats: &[Splat<S>]) -> Vec<f64> {
        if splats.is_empty() {
            return Vec::new();
        }
        let mut sums = vec![0.0; self.mean.len()];
        let [width, height] = self.resolution.map(|side| side as f32);
        for Splat { raster, value } in splats {
            let [x, y] = *raster;
            if !(x >= 0.0 && y >= 0.0 && x < width && y < height) {
                continue;
            }
            if !value.is_finite() {
                self.non_finite += 1;
                continue;
            }
            // A width beyond 2²⁴ rounds: the last column takes what falls on it.
            let [x, y] = [
                (x as u32).min(self.resolution[0] - 1),
                (y as u32).min(self.resolution[1] - 1),
            ];
            let pixel = self.pixel([x, y]);
            for channel in 0..S::CHANNELS {
                sums[pixel * S::CHANNELS + channel] += f64::from(value.channel(channel));
            }
        }
        sums
    }

    /// Adds the passes of another render of the same picture: other passes of the same seed, or any
    /// of another seed. The mean is weighted by passes; the squared deviations are
    /// M₂ + M₂′ + δ²·n·n′/(n + n′), δ being the difference of the means (Chan, Golub & LeVeque
    /// 1979, eq. 2.1). Equal to one render of all passes but for rounding.
    ///
    /// # Errors
    /// [`DifferentResolution`].
    pub fn merge(&mut self, other: &Self) -> Result<(), DifferentResolution> {
        DifferentResolution::check(self.resolution, other.resolution)?;
        let passes = self.passes + other.passes;
        let share = match passes {
            0 => 0.0,
            _ => other.passes as f64 / passes as f64,
        };
        let theirs = other.mean.iter().zip(&other.deviations);
        let ours = self.mean.iter_mut().zip(&mut self.deviations);
        for ((mean, deviations), (their_mean, their_deviations)) in ours.zip(theirs) {
            let delta = their_mean - *mean;
            *mean += delta * share;
            *deviations += their_deviations + delta * delta * share * self.passes as f64;
        }
        self.passes = passes;
        self.non_finite += other.non_finite;
        Ok(())
    }

    fn pixel(&self, [x, y]: [u32; 2]) -> usize {
        y as usize * self.resolution[0] as usize + x as usize
    }

    /// Adds one pass, given as tiles that cover the film once, and its splats.
    pub(crate) fn add_pass<'t>(
        &mut self,
        tiles: impl Iterator<Item = (Tile, &'t [S])>,
        splats: &[Splat<S>],
    ) where
        S: 't,
    {
        let splats = self.gather_splats(splats);
        self.passes += 1;
        let n = self.passes as f64;
        for (tile, radiance) in tiles {
            for (px, value) in tile.pixels().zip(radiance) {
                let value = if value.is_finite() {
                    *value
                } else {
                    self.non_finite += 1;
                    S::default()
                };
                let pixel = self.pixel(px);
                for channel in 0..S::CHANNELS {
                    let i = pixel * S::CHANNELS + channel;
                    let splatted = splats.get(i).unwrap_or(&0.0);
                    let value = f64::from(value.channel(channel)) + splatted;
                    let delta = value - self.mean[i];
                    self.mean[i] += delta / n;
                    self.deviations[i] += delta * (value - self.mean[i]);
                }
            }
        }
    }
}
