//! The light paths of a pass: emission in strata, on all threads, in order.

use crate::footprint::Beside;
use crate::{Event, Footprint, Vertex, Walk};
use rayon::prelude::*;
use sobol_burley::sample_4d;
use std::sync::atomic::{AtomicU64, Ordering};
use tyndall_core::{
    Collision, Domain, Geometry, HostTypes, LightEmission, Media, MediumId, PassContext, PassError,
    Ray, Sampler, Shading, Spectrum, Streams,
};

/// Points of one low-discrepancy sequence: what `sobol_burley` has.
const SEQUENCE: u64 = 1 << 16;
/// Paths that a thread traces at a time.
const BATCH: u64 = 1 << 10;

/// The light paths of one pass.
///
/// What is emitted is stratified: the `u` of
/// [`sample_emission`](LightEmission::sample_emission) are a scrambled Sobol sequence in six
/// dimensions (Owen 1995; Burley 2020, "Practical Hash-based Owen Scrambling"), a new one for every
/// 65,536 paths and every pass. Each point is uniform, so that all means are as with independent
/// numbers; lights, places on them and directions are only chosen more evenly. What comes after the
/// emission takes the independent numbers of the path's own stream.
#[derive(Debug)]
pub struct LightPaths<'a, 'c, R> {
    cx: &'a PassContext<'c, R>,
    paths: u64,
    max_bytes: u64,
    footprints: bool,
}

impl<'a, 'c, R: Streams> LightPaths<'a, 'c, R> {
    /// `paths` of them, of which what is collected may take `max_bytes`.
    pub fn new(cx: &'a PassContext<'c, R>, paths: u64, max_bytes: u64) -> Self {
        Self {
            cx,
            paths,
            max_bytes,
            footprints: false,
        }
    }

    /// Follows rays beside the paths too, for [`Flight::footprint`].
    #[must_use]
    pub fn footprints(self, footprints: bool) -> Self {
        Self { footprints, ..self }
    }

    /// Traces them on the current rayon pool and collects what `trace` makes of each, in batches in
    /// the order of the paths: the same on any number of threads. The walks carry flux divided by
    /// the number of paths.
    ///
    /// # Errors
    /// [`PassError::Cancelled`]; [`PassError::Memory`] as soon as what is collected takes more than
    /// is allowed, but for that of one path a thread.
    pub fn collect<'h, H, T: Send>(
        &self,
        host: &'h H,
        trace: impl Fn(Walk<'h, H>, &mut R::Sampler, &mut Vec<T>) + Sync,
    ) -> Result<Vec<Vec<T>>, PassError>
    where
        H: Geometry + Shading + Media + LightEmission,
    {
        let (share, bytes) = (1.0 / self.paths as f32, AtomicU64::new(0));
        let batch = |batch| {
            let (mut found, mut of_path) = (Vec::new(), Vec::new());
            let seed = self.seed(batch * BATCH / SEQUENCE);
            for path in batch * BATCH..self.paths.min((batch + 1) * BATCH) {
                if self.cx.cancelled() {
                    return Err(PassError::Cancelled);
                }
                if let Some(mut start) = host.sample_emission(point(path, seed)) {
                    start.flux *= share;
                    let mut sampler = self.cx.streams.sampler(Domain::LIGHT, path);
                    let mut walk = Walk::from_light(host, &start);
                    walk.beside = self.footprints.then(|| Box::new(Beside::of(&start)));
                    trace(walk, &mut sampler, &mut of_path);
                }
                let (room, needed) = (found.capacity(), found.len() + of_path.len());
                if needed > room {
                    let more = needed.max(2 * room) - room;
                    self.count(&bytes, (size_of::<T>() * more) as u64)?;
                    found.reserve_exact(room + more - found.len());
                }
                found.append(&mut of_path);
            }
            Ok(found)
        };
        let batches = 0..self.paths.div_ceil(BATCH);
        batches.into_par_iter().map(batch).collect()
    }

    /// Counts `more` bytes.
    fn count(&self, bytes: &AtomicU64, more: u64) -> Result<(), PassError> {
        let needed = bytes.fetch_add(more, Ordering::Relaxed) + more;
        if needed > self.max_bytes {
            return Err(PassError::Memory {
                needed,
                allowed: self.max_bytes,
            });
        }
        Ok(())
    }

    /// The scrambling of a sequence; the streams of paths have smaller indices.
    fn seed(&self, sequence: u64) -> u32 {
        let mut stream = (self.cx.streams).sampler(Domain::LIGHT, u64::MAX - sequence);
        let [high, low] = stream.next().map(|u| (u * 65_536.0) as u32);
        high << 16 | low
    }
}

/// The point of the unit cube from which a path starts.
fn point(path: u64, seed: u32) -> [f32; 6] {
    let index = (path % SEQUENCE) as u32;
    let ([a, b, c, d], [e, f, ..]) = (sample_4d(index, 0, seed), sample_4d(index, 1, seed));
    [a, b, c, d, e, f]
}

/// What light has met since it left its source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Nothing: it is what [`sample_direct`](tyndall_core::LightDirect::sample_direct) finds.
    Direct,
    /// Surfaces that sent it on in discrete directions, and nothing else: a caustic.
    Specular,
    /// A surface or a medium that scattered it into many directions.
    Diffuse,
}

/// What a walk of light tells on its way.
pub enum Visit<'a, H: HostTypes> {
    /// A flight through a medium.
    Flight(Flight<H::Spectrum>),
    /// A collision or a surface that scatters, and the flux that arrives there: before the
    /// scattering, in W.
    Vertex(&'a Vertex<H>, H::Spectrum),
}

/// A flight through a medium, from one vertex or boundary up to a collision or the next surface.
#[derive(Clone, Copy, Debug)]
pub struct Flight<S> {
    /// Up to the next surface, whether the flight got there or not.
    pub ray: Ray,
    /// What it runs through.
    pub medium: MediumId,
    /// Where it collided, if it did.
    pub collision: Option<Collision<S>>,
    /// Flux at its start, in W.
    pub start: S,
    /// Flux at its end. As a constant from the start on up to where the flight got, and 0 behind,
    /// it has at every distance the mean `start` × transmittance: see [`Flights`](crate::Flights).
    pub end: S,
    /// How wide the light is, if that was [asked for](LightPaths::footprints), nothing has scattered
    /// it into many directions, and what is beside it met the same.
    pub footprint: Option<Footprint>,
}

impl<H: Geometry + Shading + Media> Walk<'_, H> {
    /// Walks to the end. `visit` is told every flight through a medium and the vertex after it,
    /// and what the light has met before. The first vertex where the flux or the place is not
    /// finite is the last: Russian roulette would not end such a walk.
    pub fn visit<T: Sampler>(
        mut self,
        sampler: &mut T,
        mut visit: impl FnMut(Visit<'_, H>, Route, &mut T),
    ) {
        let mut route = Route::Direct;
        loop {
            let segment = self.segment();
            let (ray, medium, start) = (segment.ray, segment.medium, self.throughput);
            let footprint = (self.beside.as_ref()).map(|beside| beside.footprint(&ray));
            let event = self.fly(segment, sampler);
            if self.host.medium(medium).is_some() {
                let flight = Flight {
                    ray,
                    medium,
                    collision: event.collision(),
                    start,
                    end: self.throughput,
                    footprint,
                };
                visit(Visit::Flight(flight), route, sampler);
            }
            match event {
                Event::Interface(_) if !self.throughput.is_black() => {}
                Event::Interface(_) | Event::Escape(_) => return,
                Event::Scattering(vertex) => {
                    visit(Visit::Vertex(&vertex, self.throughput), route, sampler);
                    if !(self.throughput.is_finite() && vertex.position.is_finite()) {
                        return;
                    }
                    let Some(scattered) = self.scatter(&vertex, sampler) else {
                        return;
                    };
                    route = match (route, scattered.pdf_w) {
                        (Route::Diffuse, _) | (_, Some(_)) => Route::Diffuse,
                        (_, None) => Route::Specular,
                    };
                }
            }
        }
    }
}
