//! What every integrator must hold.

use super::{FALSE_ALARM, ensure};
use crate::measure::PassMeans;
use crate::stats::{Estimate, ImageEstimate, check_mean, compare_images, sidak};
use rayon::ThreadPoolBuilder;
use tyndall_core::{AnyIntegrator, Sensor, Spectrum};
use tyndall_driver::{Budget, Film, PassStreams, Render, RenderError};

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
        .map_err(failed)
}

fn failed(why: RenderError) -> String {
    format!("the render failed: {why}")
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

/// A render and the means of its pixels, per channel, by pass.
struct Measured<S> {
    film: Film<S>,
    variance: Vec<f64>,
    means: Vec<Estimate>,
}

impl<S: Spectrum> Measured<S> {
    fn new<H: Sensor<Spectrum = S>>(
        integrator: Erased<'_, H>,
        host: &H,
        seed: u64,
    ) -> Result<Self, String> {
        let mut means = PassMeans::new(S::CHANNELS);
        let film = Render::new(host, integrator)
            .seed(seed)
            .run(Budget::Passes(MANY), |progress| {
                means.push(progress.snapshot.film());
            })
            .map_err(failed)?;
        Ok(Self {
            variance: film.variance_of_mean().collect(),
            means: means.estimates(),
            film,
        })
    }

    fn image(&self) -> ImageEstimate<'_> {
        ImageEstimate {
            mean: self.film.mean(),
            variance_of_mean: &self.variance,
            passes: self.film.passes(),
        }
    }
}

/// Scaling all lengths by 1/1000 and by 1000 leaves the image as it is: every pixel by Welch's t, and
/// the mean of all pixels, whose standard error is that of the passes' means, for pixels that share
/// photons depend on each other. Seeds are independent.
///
/// # Errors
/// A sentence with the scale and the worst pixel, or the difference of the means.
pub fn scale_invariance<H: Sensor>(
    integrator: Erased<'_, H>,
    host: impl Fn(f32) -> H,
) -> Result<(), String> {
    let reference = Measured::new(integrator, &host(1.0), 3)?;
    let half = sidak(FALSE_ALARM, 2 * SCALES.len());
    for (seed, scale) in (4..).zip(SCALES) {
        let scaled = Measured::new(integrator, &host(scale), seed)?;
        let pixels = compare_images(scaled.image(), reference.image());
        let each = sidak(half, reference.variance.len());
        ensure(pixels.smallest_p >= each, || {
            format!(
                "at scale {scale}, against scale 1: value {} differs by {:.1} standard errors \
                 (probability {:.1e}, threshold {each:.1e})",
                pixels.worst_pixel, pixels.max_z, pixels.smallest_p
            )
        })?;
        for (a, b) in scaled.means.iter().zip(&reference.means) {
            let name = format!("scale {scale} against scale 1, mean of all pixels");
            check_mean(
                &name,
                a.difference(b),
                0.0,
                sidak(half, H::Spectrum::CHANNELS),
            )?;
        }
    }
    Ok(())
}
