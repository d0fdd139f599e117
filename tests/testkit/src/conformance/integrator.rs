//! What every integrator must hold.

use super::{FALSE_ALARM, ensure};
use crate::stats::{ImageEstimate, sidak, z_test_images};
use rayon::ThreadPoolBuilder;
use tyndall_core::{AnyIntegrator, Sensor, Spectrum};
use tyndall_driver::{Budget, Film, PassStreams, Render};

/// Passes of a render that is compared bit by bit.
const FEW: u64 = 3;
/// Passes of a render that is compared by statistics.
const MANY: u64 = 64;
/// Scales against which scale 1 is held.
const SCALES: [f32; 2] = [1e-3, 1e3];

/// An integrator behind the driver's trait object.
type Erased<'a, H> = &'a dyn AnyIntegrator<H, PassStreams>;

fn render<H: Sensor>(
    integrator: Erased<'_, H>,
    host: &H,
    seed: u64,
    passes: u64,
) -> Result<Film<H::Spectrum>, String> {
    Render::new(host, integrator)
        .seed(seed)
        .run(Budget::Passes(passes), |_| {})
        .map_err(|why| format!("the render failed: {why}"))
}

/// The film is the same to the bit on 1, 2 and 7 threads.
///
/// # Errors
/// A sentence with the first pixel that differs.
pub fn determinism<H: Sensor>(
    integrator: Erased<'_, H>,
    host: impl Fn(f32) -> H,
) -> Result<(), String> {
    let host = host(1.0);
    let on = |threads: usize| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|why| why.to_string())?;
        pool.install(|| render(integrator, &host, 1, FEW))
    };
    let one = on(1)?;
    for threads in [2, 7] {
        let many = on(threads)?;
        let pairs = one.mean().iter().zip(many.mean());
        let different = pairs.clone().position(|(a, b)| a.to_bits() != b.to_bits());
        ensure(different.is_none(), || {
            let i = different.unwrap_or(0);
            format!(
                "value {i} of the film is {:e} on one thread and {:e} on {threads}",
                one.mean()[i],
                many.mean()[i]
            )
        })?;
    }
    Ok(())
}

/// No sample is NaN or infinite, and the image is not black.
///
/// # Errors
/// A sentence with their number.
pub fn finiteness<H: Sensor>(
    integrator: Erased<'_, H>,
    host: impl Fn(f32) -> H,
) -> Result<(), String> {
    let film = render(integrator, &host(1.0), 2, MANY)?;
    ensure(film.non_finite() == 0, || {
        format!("{} samples are not finite", film.non_finite())
    })?;
    ensure(film.mean().iter().any(|v| *v > 0.0), || {
        "the image is black: light the host".to_owned()
    })
}

fn image<'a, S: Spectrum>(film: &'a Film<S>, variance: &'a [f64]) -> ImageEstimate<'a> {
    ImageEstimate {
        mean: film.mean(),
        variance_of_mean: variance,
        passes: film.passes(),
    }
}

/// Scaling all lengths by 1/1000 and by 1000 leaves the image as it is ([`z_test_images`], with
/// independent seeds).
///
/// # Errors
/// A sentence with the scale and the worst pixel, or the difference of the means.
pub fn scale_invariance<H: Sensor>(
    integrator: Erased<'_, H>,
    host: impl Fn(f32) -> H,
) -> Result<(), String> {
    let reference = render(integrator, &host(1.0), 3, MANY)?;
    for (seed, scale) in (4..).zip(SCALES) {
        let scaled = render(integrator, &host(scale), seed, MANY)?;
        let variances = [&scaled, &reference].map(|f| f.variance_of_mean().collect::<Vec<_>>());
        z_test_images(
            image(&scaled, &variances[0]),
            image(&reference, &variances[1]),
            sidak(FALSE_ALARM, SCALES.len()),
        )
        .map_err(|why| format!("at scale {scale}, against scale 1: {why}"))?;
    }
    Ok(())
}
