//! What the passes of a render add up to.

use std::marker::PhantomData;
use tyndall_core::{Spectrum, Tile};

/// The mean of the passes and its variance, per pixel and channel, in `f64`.
///
/// A pass counts as one sample, whatever is correlated within it.
#[derive(Clone, Debug, PartialEq)]
pub struct Film<S> {
    resolution: [u32; 2],
    passes: u64,
    /// Row by row, channels innermost.
    mean: Vec<f64>,
    /// Sum of squared deviations from the mean (Welford 1962).
    deviations: Vec<f64>,
    non_finite: u64,
    channels: PhantomData<S>,
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
    /// the image. Infinite for a black image or a single pass.
    pub fn relative_error(&self) -> f64 {
        let values = self.mean.len() as f64;
        let mean = self.mean.iter().sum::<f64>() / values;
        let variance = self.variance_of_mean().sum::<f64>() / values;
        if mean > 0.0 {
            variance.sqrt() / mean
        } else {
            f64::INFINITY
        }
    }

    /// Adds one pass, given as tiles that cover the film once.
    pub(crate) fn add_pass<'t>(&mut self, tiles: impl Iterator<Item = (Tile, &'t [S])>)
    where
        S: 't,
    {
        self.passes += 1;
        let n = self.passes as f64;
        for (tile, radiance) in tiles {
            for ([x, y], value) in tile.pixels().zip(radiance) {
                let value = if value.is_finite() {
                    *value
                } else {
                    self.non_finite += 1;
                    S::default()
                };
                let pixel = y as usize * self.resolution[0] as usize + x as usize;
                for channel in 0..S::CHANNELS {
                    let i = pixel * S::CHANNELS + channel;
                    let value = f64::from(value.channel(channel));
                    let delta = value - self.mean[i];
                    self.mean[i] += delta / n;
                    self.deviations[i] += delta * (value - self.mean[i]);
                }
            }
        }
    }
}
