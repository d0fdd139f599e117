//! The loop over passes and tiles.

use crate::{Budget, Film, PassStreams};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tyndall_core::{AnyIntegrator, AnyPixels, HostTypes, PassContext, PassError, Sensor, Tile};

/// Side of a square tile, in pixels.
const TILE: u32 = 16;

/// A render to be run, on the current rayon pool.
pub struct Render<'a, H: HostTypes> {
    host: &'a H,
    integrator: &'a dyn AnyIntegrator<H, PassStreams>,
    seed: u64,
    cancelled: &'a AtomicBool,
}

/// How far a render is, after each pass.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Passes done.
    pub passes: u64,
    /// Share of the budget that is spent, 1 at the end.
    pub spent: f64,
    /// Since the start.
    pub elapsed: Duration,
    /// See [`Film::relative_error`].
    pub relative_error: f64,
}

/// Why a render has no film.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The sensor has no pixels.
    #[error("the sensor has no pixels: give it a width and a height of at least 1")]
    EmptySensor,
    /// Nothing was asked for.
    #[error(
        "the budget is zero or not a number: ask for at least one pass, some time, or a positive error"
    )]
    EmptyBudget,
    /// Nothing was finished. A cancelled render with a finished pass is no error.
    #[error("cancelled before the first pass was prepared: there is no image")]
    Cancelled,
    /// The integrator gave up.
    #[error("the integrator could not prepare a pass: {0}")]
    Pass(#[from] PassError),
}

/// A tile with what its pixels remember and what the current pass adds.
struct Workplace<S> {
    tile: Tile,
    pixels: AnyPixels,
    radiance: Vec<S>,
}

impl<'a, H: Sensor> Render<'a, H> {
    /// Of `host` by `integrator`, with seed 0.
    pub fn new(host: &'a H, integrator: &'a dyn AnyIntegrator<H, PassStreams>) -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self {
            host,
            integrator,
            seed: 0,
            cancelled: &NEVER,
        }
    }

    /// Another seed gives an independent render.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Stops soon after the flag is set; the film then holds the passes finished until then.
    #[must_use]
    pub fn cancelled_by(self, cancelled: &'a AtomicBool) -> Self {
        Self { cancelled, ..self }
    }

    /// Renders until the budget is spent, and reports after each pass.
    ///
    /// # Errors
    /// See [`RenderError`].
    pub fn run(
        &self,
        budget: Budget,
        mut report: impl FnMut(Progress),
    ) -> Result<Film<H::Spectrum>, RenderError> {
        let empty = match budget {
            Budget::Passes(passes) => passes == 0,
            Budget::Time(time) => time.is_zero(),
            Budget::RelativeError(error) => error.is_nan() || error <= 0.0,
        };
        if empty {
            return Err(RenderError::EmptyBudget);
        }
        let start = Instant::now();
        let resolution = self.host.resolution();
        let mut film = Film::new(resolution);
        let mut places = self.workplaces(resolution);
        if places.is_empty() {
            return Err(RenderError::EmptySensor);
        }
        let mut previous = None;
        loop {
            let pass = film.passes();
            let streams = PassStreams::new(self.seed, pass);
            let cx = PassContext::new(pass, &streams, self.cancelled);
            let prepared = match self.integrator.begin_any(self.host, &cx, previous.take()) {
                Err(PassError::Cancelled) if pass > 0 => return Ok(film),
                Err(PassError::Cancelled) => return Err(RenderError::Cancelled),
                prepared => prepared?,
            };
            places.par_iter_mut().for_each(|place| {
                if !self.stops(pass) {
                    self.integrator.estimate_tile(
                        self.host,
                        &cx,
                        &prepared,
                        &mut place.pixels,
                        place.tile,
                        &mut place.radiance,
                    );
                }
            });
            if self.stops(pass) {
                return Ok(film);
            }
            film.add_pass(
                places.iter().map(|p| (p.tile, p.radiance.as_slice())),
                self.integrator.splats_any(&prepared),
            );
            previous = Some(prepared);
            let elapsed = start.elapsed();
            let spent = budget.spent(&film, elapsed);
            report(Progress {
                passes: film.passes(),
                spent,
                elapsed,
                relative_error: film.relative_error(),
            });
            if spent >= 1.0 || self.cancelled.load(Ordering::Relaxed) {
                return Ok(film);
            }
        }
    }

    /// A cancelled pass is dropped whole, so that all pixels have as many samples; the first pass
    /// is finished, so that there is a picture.
    fn stops(&self, pass: u64) -> bool {
        pass > 0 && self.cancelled.load(Ordering::Relaxed)
    }

    fn workplaces(&self, [width, height]: [u32; 2]) -> Vec<Workplace<H::Spectrum>> {
        let rows = (0..height).step_by(TILE as usize);
        rows.flat_map(|y| (0..width).step_by(TILE as usize).map(move |x| [x, y]))
            .map(|[x, y]| Tile {
                min: [x, y],
                size: [TILE.min(width - x), TILE.min(height - y)],
            })
            .map(|tile| Workplace {
                tile,
                pixels: self.integrator.pixels(tile.len()),
                radiance: vec![H::Spectrum::default(); tile.len()],
            })
            .collect()
    }
}
