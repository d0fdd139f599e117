//! The loop over passes and tiles.

use crate::snapshot::Memory;
use crate::{Budget, DifferentResolution, Film, PassStreams, Snapshot};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use tyndall_core::{
    AnyIntegrator, AnyPass, AnyPixels, Figure, HostTypes, PassContext, PassError, Sensor,
    StateError, Tile,
};

/// Side of a square tile, in pixels.
const TILE: u32 = 16;

/// A render to be run, on the current rayon pool.
pub struct Render<'a, H: HostTypes> {
    host: &'a H,
    integrator: &'a dyn AnyIntegrator<H, PassStreams>,
    seed: u64,
    cancelled: &'a AtomicBool,
    watch: &'a (dyn Fn(f64) + Sync),
    start: Start<H::Spectrum>,
}

/// What a render begins with.
enum Start<S> {
    Pass(u64),
    Snapshot(Box<Snapshot<S>>),
}

/// How far a render is, after each pass.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'r, S> {
    /// All that is done; can be kept, to resume from.
    pub snapshot: &'r Snapshot<S>,
    /// Share of the budget that is spent, 1 at the end.
    pub spent: f64,
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
    /// The snapshot to resume from is not one of this integrator.
    #[error("the render cannot be resumed: {0}")]
    State(#[from] StateError),
    /// The snapshot to resume from shows another picture.
    #[error("the render cannot be resumed: {0}")]
    Resolution(#[from] DifferentResolution),
}

/// A tile with what its pixels remember and what the current pass adds.
struct Workplace<S> {
    tile: Tile,
    pixels: AnyPixels,
    radiance: Vec<S>,
}

/// What the loop carries from pass to pass.
struct Begun<S> {
    snapshot: Snapshot<S>,
    places: Vec<Workplace<S>>,
    previous: Option<AnyPass>,
}

impl<'a, H: Sensor> Render<'a, H> {
    /// Of `host` by `integrator`, with seed 0, from pass 0.
    pub fn new(host: &'a H, integrator: &'a dyn AnyIntegrator<H, PassStreams>) -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self {
            host,
            integrator,
            seed: 0,
            cancelled: &NEVER,
            watch: &|_| {},
            start: Start::Pass(0),
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

    /// Calls `watch` with the share of the current pass that is done, from 0 to 1, after each tile
    /// and on any thread.
    #[must_use]
    pub fn watched_by(self, watch: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { watch, ..self }
    }

    /// Begins with this pass: a part of a render whose other passes run elsewhere, to be joined by
    /// [`Film::merge`]. A method that is sequential by nature begins anew.
    #[must_use]
    pub fn first_pass(self, pass: u64) -> Self {
        let start = Start::Pass(pass);
        Self { start, ..self }
    }

    /// Continues an earlier render of the same host, integrator and seed. The budget counts what
    /// was spent on it.
    #[must_use]
    pub fn resume(self, snapshot: Snapshot<H::Spectrum>) -> Self {
        let start = Start::Snapshot(Box::new(snapshot));
        Self { start, ..self }
    }

    /// Renders until the budget is spent, and reports after each pass.
    ///
    /// # Errors
    /// See [`RenderError`].
    pub fn run(
        self,
        budget: Budget,
        report: impl FnMut(&Progress<'_, H::Spectrum>),
    ) -> Result<Film<H::Spectrum>, RenderError> {
        self.advance(budget, report).map(Snapshot::into_film)
    }

    /// As [`Render::run`], and returns what it takes to go on.
    ///
    /// # Errors
    /// See [`RenderError`].
    pub fn advance(
        mut self,
        budget: Budget,
        mut report: impl FnMut(&Progress<'_, H::Spectrum>),
    ) -> Result<Snapshot<H::Spectrum>, RenderError> {
        budget.check()?;
        let begun = Instant::now();
        let Begun {
            mut snapshot,
            mut places,
            mut previous,
        } = self.begin()?;
        let earlier = snapshot.elapsed;
        while !self.done(budget, &snapshot) {
            let streams = PassStreams::new(self.seed, snapshot.next_pass);
            let cx = PassContext::new(snapshot.next_pass, &streams, self.cancelled);
            let first = snapshot.film.passes() == 0;
            let prepared = match self.integrator.begin_any(self.host, &cx, previous.take()) {
                Err(PassError::Cancelled) if !first => break,
                Err(PassError::Cancelled) => return Err(RenderError::Cancelled),
                prepared => prepared?,
            };
            // A cancelled pass is dropped whole, so that all pixels have as many samples; the
            // first pass is finished, so that there is a picture.
            let stops = || !first && self.cancelled.load(Ordering::Relaxed);
            self.estimate(&cx, &prepared, &mut places, stops);
            if stops() {
                break;
            }
            snapshot.film.add_pass(
                places.iter().map(|p| (p.tile, p.radiance.as_slice())),
                self.integrator.splats_any(&prepared),
            );
            let figures = self.integrator.figures_any(&prepared);
            Figure::gather(&mut snapshot.figures, figures);
            snapshot.next_pass += 1;
            // Now, for the next pass changes the pixels, and may be cancelled and dropped.
            snapshot.memory = self.memory(&prepared, &mut places).ok();
            snapshot.elapsed = earlier + begun.elapsed();
            previous = Some(prepared);
            report(&Progress {
                spent: budget.spent(&snapshot.film, snapshot.elapsed),
                relative_error: snapshot.film.relative_error(),
                snapshot: &snapshot,
            });
        }
        Ok(snapshot)
    }

    /// Whether the render ends before another pass: it has at least one.
    fn done(&self, budget: Budget, snapshot: &Snapshot<H::Spectrum>) -> bool {
        let spent = || budget.spent(&snapshot.film, snapshot.elapsed) >= 1.0;
        snapshot.film.passes() > 0 && (self.cancelled.load(Ordering::Relaxed) || spent())
    }

    /// The state before the first pass to be rendered.
    fn begin(&mut self) -> Result<Begun<H::Spectrum>, RenderError> {
        let resolution = self.host.resolution();
        let mut places = self.workplaces(resolution);
        if places.is_empty() {
            return Err(RenderError::EmptySensor);
        }
        let snapshot = match std::mem::replace(&mut self.start, Start::Pass(0)) {
            Start::Snapshot(snapshot) => *snapshot,
            Start::Pass(next_pass) => {
                let fresh = Snapshot {
                    film: Film::new(resolution),
                    next_pass,
                    elapsed: Duration::ZERO,
                    figures: Vec::new(),
                    memory: None,
                };
                return Ok(Begun {
                    snapshot: fresh,
                    places,
                    previous: None,
                });
            }
        };
        DifferentResolution::check(snapshot.film.resolution(), resolution)?;
        let memory = snapshot.memory.as_ref().ok_or(StateError::Unsaved)?;
        if memory.tiles.len() != places.len() {
            return Err(StateError::Corrupt.into());
        }
        for (place, bytes) in places.iter_mut().zip(&memory.tiles) {
            place.pixels = self.integrator.restore_pixels(place.tile.len(), bytes)?;
        }
        let previous = self.integrator.restore_any(self.host, &memory.pass)?;
        Ok(Begun {
            snapshot,
            places,
            previous,
        })
    }

    /// One sample of every pixel, unless it stops.
    fn estimate(
        &self,
        cx: &PassContext<'_, PassStreams>,
        prepared: &AnyPass,
        places: &mut [Workplace<H::Spectrum>],
        stops: impl Fn() -> bool + Sync,
    ) {
        let (tiles, done) = (places.len(), AtomicUsize::new(0));
        places.par_iter_mut().for_each(|place| {
            if !stops() {
                self.integrator.estimate_tile(
                    self.host,
                    cx,
                    prepared,
                    &mut place.pixels,
                    place.tile,
                    &mut place.radiance,
                );
                let done = 1 + done.fetch_add(1, Ordering::Relaxed);
                (self.watch)(done as f64 / tiles as f64);
            }
        });
    }

    /// What the passes so far leave to the next, if the method saves it.
    fn memory(
        &self,
        prepared: &AnyPass,
        places: &mut [Workplace<H::Spectrum>],
    ) -> Result<Memory, StateError> {
        let mut pass = Vec::new();
        self.integrator.save_any(prepared, &mut pass)?;
        let tiles = places.par_iter_mut().map(|place| {
            let mut bytes = Vec::new();
            let saved = self.integrator.save_pixels(&place.pixels, &mut bytes);
            saved.map(|()| bytes)
        });
        let tiles = tiles.collect::<Result<_, _>>()?;
        Ok(Memory { pass, tiles })
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
