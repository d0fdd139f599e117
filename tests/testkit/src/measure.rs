//! What an integrator says of a host, with its standard error.

use crate::stats::{Estimate, Moments};
use tyndall_core::{AnyIntegrator, Sensor, Spectrum};
use tyndall_driver::{Budget, Film, PassStreams, Render, RenderError};

/// The value of every pixel and channel, row by row with channels innermost, after `passes` passes.
///
/// Runs on one thread, so that tests beside it have the others.
///
/// # Panics
/// If the render fails or a sample is not finite.
pub fn measure<H: Sensor>(
    host: &H,
    integrator: &dyn AnyIntegrator<H, PassStreams>,
    passes: u64,
    seed: u64,
) -> Vec<Estimate> {
    let film = on_one_thread(|| {
        Render::new(host, integrator)
            .seed(seed)
            .run(Budget::Passes(passes), |_| {})
    });
    film.mean()
        .iter()
        .zip(film.variance_of_mean())
        .map(|(mean, variance)| Estimate {
            mean: *mean,
            standard_error: variance.sqrt(),
            count: passes,
        })
        .collect()
}

/// The mean over all pixels, per channel.
///
/// The standard error is that of the passes' own means: pixels of a pass may depend on each other,
/// as they do where they share photons.
///
/// # Panics
/// As [`measure`].
pub fn measure_mean<H: Sensor>(
    host: &H,
    integrator: &dyn AnyIntegrator<H, PassStreams>,
    passes: u64,
    seed: u64,
) -> Vec<Estimate> {
    let mut means = PassMeans::new(H::Spectrum::CHANNELS);
    on_one_thread(|| {
        Render::new(host, integrator)
            .seed(seed)
            .run(Budget::Passes(passes), |progress| {
                means.push(progress.snapshot.film());
            })
    });
    means.estimates()
}

/// Runs a render on one thread, so that tests beside it have the others.
fn on_one_thread<S: Spectrum>(
    render: impl FnOnce() -> Result<Film<S>, RenderError> + Send,
) -> Film<S> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let film = pool.install(render).expect("the render succeeds");
    assert_eq!(film.non_finite(), 0, "samples are not finite");
    film
}

/// The mean over the pixels of each pass, per channel, from films that grow by a pass each.
pub(crate) struct PassMeans {
    /// Sums over pixels and earlier passes.
    earlier: Vec<f64>,
    means: Vec<Moments>,
}

impl PassMeans {
    pub(crate) fn new(channels: usize) -> Self {
        Self {
            earlier: vec![0.0; channels],
            means: vec![Moments::new(); channels],
        }
    }

    /// Takes in what the last pass has added.
    pub(crate) fn push<S: Spectrum>(&mut self, film: &Film<S>) {
        let channels = self.means.len();
        let pixels = (film.mean().len() / channels) as f64;
        for (i, (earlier, means)) in self.earlier.iter_mut().zip(&mut self.means).enumerate() {
            let of_channel = film.mean().iter().skip(i).step_by(channels);
            let sum = of_channel.sum::<f64>() * film.passes() as f64;
            means.push((sum - *earlier) / pixels);
            *earlier = sum;
        }
    }

    pub(crate) fn estimates(&self) -> Vec<Estimate> {
        self.means.iter().map(Moments::estimate).collect()
    }
}
