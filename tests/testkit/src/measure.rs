//! What an integrator says of a host, with its standard error.

use crate::stats::Estimate;
use tyndall_core::{AnyIntegrator, Sensor, Spectrum};
use tyndall_driver::{Budget, PassStreams, Render};

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
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let film = pool
        .install(|| {
            Render::new(host, integrator)
                .seed(seed)
                .run(Budget::Passes(passes), |_| {})
        })
        .expect("the render succeeds");
    assert_eq!(film.non_finite(), 0, "samples are not finite");
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
/// # Panics
/// As [`measure`].
pub fn measure_mean<H: Sensor>(
    host: &H,
    integrator: &dyn AnyIntegrator<H, PassStreams>,
    passes: u64,
    seed: u64,
) -> Vec<Estimate> {
    let values = measure(host, integrator, passes, seed);
    let channels = H::Spectrum::CHANNELS;
    let pixels = (values.len() / channels) as f64;
    (0..channels)
        .map(|channel| {
            let of_channel = values.iter().skip(channel).step_by(channels);
            let (mean, variance) = of_channel.fold((0.0, 0.0), |(mean, variance), e| {
                (
                    mean + e.mean,
                    variance + e.standard_error * e.standard_error,
                )
            });
            Estimate {
                mean: mean / pixels,
                standard_error: variance.sqrt() / pixels,
                count: passes,
            }
        })
        .collect()
}
