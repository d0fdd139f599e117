//! What a ray gathers of the photons that it passes.

use crate::discs::{Hits, PhotonDiscs, each};
use crate::{Blur, Transmittance};
use glam::Vec3;
use tyndall_bvh::LANES;
use tyndall_core::{Medium, PhaseFunction, Ray, Sampler, Spectrum};
use tyndall_density::{Kernel, exp_negative, in_scattered};
use tyndall_walk::{DepthTable, Flights, OPAQUE};

/// Fraction of the golden ratio: its multiples, modulo 1, are spread evenly.
const GOLDEN: f32 = 0.618_034;

/// Gathers photons along rays of sight. Room for what rays meet is reused from one to the next.
#[derive(Debug)]
pub struct AlongRay<S> {
    kernel: Kernel,
    transmittance: Transmittance,
    hits: Hits,
    /// Transmittance to the photons of a ray, in one row if all channels are the same.
    rows: Vec<Vec<[f32; LANES]>>,
    table: DepthTable<S>,
    flights: Flights<S>,
    /// Largest error of transmittance met, an absolute one: see [`Transmittance::Table`].
    pub error: f32,
}

/// Where the transmittance of a ray comes from.
enum Attenuation<'a, S> {
    Even(S),
    Table(&'a DepthTable<S>),
    Flights(&'a Flights<S>),
}

impl<S: Spectrum> AlongRay<S> {
    /// Room for nothing yet.
    pub fn new(kernel: Kernel, transmittance: Transmittance) -> Self {
        Self {
            kernel,
            transmittance,
            hits: Hits::default(),
            rows: Vec::new(),
            table: DepthTable::default(),
            flights: Flights::default(),
            error: 0.0,
        }
    }

    /// Radiance that the medium scatters towards the origin of the ray, of all photons along it:
    /// Σ Tr p αΦ K₂ over discs (Jarosz et al. 2008, eq. 13), Σ p αΦ K₃ ∫Tr dt over balls.
    pub fn gather<M: Medium<Spectrum = S>>(
        &mut self,
        photons: &PhotonDiscs<S>,
        medium: &M,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> S {
        let even = medium.homogeneous().map(|c| c.sigma_t());
        let ray = match even {
            Some(sigma_t) => ray.up_to(ray.t_max.min(reach(sigma_t))),
            None => *ray,
        };
        photons.along(&ray, self.kernel, &mut self.hits);
        if self.hits.blocks.is_empty() {
            return S::default();
        }
        let Self {
            hits,
            rows,
            table,
            flights,
            ..
        } = self;
        let attenuation = match (even, self.transmittance) {
            (Some(sigma_t), _) => Attenuation::Even(sigma_t),
            (None, Transmittance::Table { max_error }) => {
                let ray = ray.up_to(hits.end().min(ray.t_max));
                self.error = self.error.max(table.measure(medium, &ray, max_error));
                Attenuation::Table(table)
            }
            (None, Transmittance::Tracking { flights: count }) => {
                let ray = ray.up_to(hits.end().min(ray.t_max));
                flights.fly(medium, &ray, count, importance, sampler);
                Attenuation::Flights(flights)
            }
        };
        let shift = match (even, photons.blur()) {
            (None, Blur::Ball) => sampler.next_1d(),
            _ => 0.0,
        };
        attenuation.rows(hits, shift, rows);
        let scale = scatter(hits, photons, medium, &ray);
        for row in rows.iter_mut() {
            let weights = hits.weight.as_flattened();
            for (value, weight) in row.as_flattened_mut().iter_mut().zip(weights) {
                *value *= weight;
            }
        }
        let row = |c: usize| rows.get(c).unwrap_or(&rows[0]);
        S::from_channels(|c| photons.flux(c, hits, row(c))) * scale
    }
}

/// Multiplies the weights by the phase function, per steradian; returns what it has for all.
fn scatter<M: Medium>(
    hits: &mut Hits,
    photons: &PhotonDiscs<M::Spectrum>,
    medium: &M,
    ray: &Ray,
) -> f32 {
    let wo = -ray.direction;
    if medium.homogeneous().is_none() {
        weigh(hits, photons, |t, direction| {
            in_scattered(&medium.phase(ray.at(t)), wo, direction, 1.0)
        });
        return 1.0;
    }
    let phase = medium.phase(ray.origin);
    if phase.is_isotropic() {
        return phase.eval(wo, wo);
    }
    weigh(hits, photons, |_, direction| {
        in_scattered(&phase, wo, direction, 1.0)
    });
    1.0
}

/// Multiplies the weights by a function of distance and direction of travel.
#[inline]
fn weigh<S: Spectrum>(hits: &mut Hits, photons: &PhotonDiscs<S>, phase: impl Fn(f32, Vec3) -> f32) {
    for (block, lane) in each(&hits.lanes) {
        let direction = photons.direction(hits.blocks[block], lane);
        hits.weight[block][lane] *= phase(hits.t[block][lane], direction);
    }
}

/// Distance from where on nothing is seen in any channel.
fn reach<S: Spectrum>(sigma_t: S) -> f32 {
    OPAQUE / sigma_t.fold(f32::INFINITY, f32::min)
}

impl<S: Spectrum> Attenuation<'_, S> {
    /// Fills `rows` with the transmittance to each photon, its mean over the chord of a ball: a row
    /// for each channel, or one if all are the same.
    ///
    /// Where there is no closed form, it is that at one place of the chord, by a sequence which is
    /// spread evenly and starts at `shift`: the mean over it is the integral.
    fn rows(&self, hits: &Hits, shift: f32, rows: &mut Vec<Vec<[f32; LANES]>>) {
        let grey = match self {
            Self::Even(sigma_t) => *sigma_t == S::splat(sigma_t.channel(0)),
            Self::Table(table) => table.is_grey(),
            Self::Flights(flights) => flights.is_grey(),
        };
        rows.resize_with(if grey { 1 } else { S::CHANNELS }, Vec::new);
        match self {
            Self::Even(sigma_t) => {
                for (c, row) in rows.iter_mut().enumerate() {
                    even(hits, sigma_t.channel(c), row);
                }
            }
            Self::Table(table) => {
                fill(hits, shift, rows, |t| table.depth(t));
                for row in rows {
                    exp_negative(row.as_flattened_mut());
                }
            }
            Self::Flights(flights) => fill(hits, shift, rows, |t| flights.transmittance(t)),
        }
    }
}

/// Fills a row with the transmittance of one extinction.
fn even(hits: &Hits, sigma_t: f32, row: &mut Vec<[f32; LANES]>) {
    row.clone_from(&hits.t);
    let row = row.as_flattened_mut();
    row.iter_mut().for_each(|depth| *depth *= sigma_t);
    exp_negative(row);
    for (transmittance, length) in row.iter_mut().zip(hits.length.as_flattened()) {
        *transmittance *= mean_transmittance(sigma_t * length);
    }
}

/// Fills rows with what `value` is where each photon is met.
fn fill<S: Spectrum>(
    hits: &Hits,
    shift: f32,
    rows: &mut [Vec<[f32; LANES]>],
    value: impl Fn(f32) -> S,
) {
    for row in rows.iter_mut() {
        row.clear();
        row.resize(hits.blocks.len(), [0.0; LANES]);
    }
    for (i, (block, lane)) in each(&hits.lanes).enumerate() {
        let share = (shift + i as f32 * GOLDEN).fract();
        let length = hits.length.get(block).map_or(0.0, |lengths| lengths[lane]);
        let value = value(hits.t[block][lane] + share * length);
        for (c, row) in rows.iter_mut().enumerate() {
            row[block][lane] = value.channel(c);
        }
    }
}

/// Mean of e^−x over x from 0 to `depth`: (1 − e^−x)/x, near 0 by its series.
#[inline]
fn mean_transmittance(depth: f32) -> f32 {
    if depth < 0.25 {
        let x = -depth;
        let terms = [1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0];
        return 1.0
            + x * (terms[0] + x * (terms[1] + x * (terms[2] + x * (terms[3] + x * terms[4]))));
    }
    -(-depth).exp_m1() / depth
}
