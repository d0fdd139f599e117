//! What a ray gathers of the photons that it passes.

use crate::depth::{DepthTable, OPAQUE};
use crate::discs::{Hit, Payload, PhotonDiscs};
use crate::flights::Flights;
use crate::{Blur, Transmittance};
use tyndall_core::{Medium, Ray, Sampler, Spectrum};
use tyndall_density::{Kernel, exp_negative, in_scattered};

/// Photons that are taken together.
const BLOCK: usize = 128;
/// Room for the photons of a ray, at first.
const ROOM: usize = 1024;
/// Fraction of the golden ratio: its multiples, modulo 1, are spread evenly.
const GOLDEN: f32 = 0.618_034;

/// Room for what rays meet, reused from one to the next.
#[derive(Debug)]
pub(crate) struct BeamGather<S> {
    kernel: Kernel,
    transmittance: Transmittance,
    hits: Vec<Hit>,
    /// Transmittance to the photons of a block, channel by channel.
    rows: Vec<[f32; BLOCK]>,
    table: DepthTable<S>,
    flights: Flights<S>,
    /// Largest error of transmittance met.
    pub(crate) error: f32,
}

/// Where the transmittance of a ray comes from.
enum Attenuation<'a, S> {
    Even(S),
    Table(&'a DepthTable<S>),
    Flights(&'a Flights<S>),
}

impl<S: Spectrum> BeamGather<S> {
    /// Room for nothing yet.
    pub(crate) fn new(kernel: Kernel, transmittance: Transmittance) -> Self {
        Self {
            kernel,
            transmittance,
            hits: Vec::new(),
            rows: Vec::new(),
            table: DepthTable::default(),
            flights: Flights::default(),
            error: 0.0,
        }
    }

    /// Radiance that the medium scatters towards the origin of the ray, of all photons along it:
    /// Σ Tr p αΦ K₂ over discs (Jarosz et al. 2008, eq. 13), Σ p αΦ K₃ ∫Tr dt over balls.
    pub(crate) fn along<M: Medium<Spectrum = S>>(
        &mut self,
        photons: &PhotonDiscs<S>,
        medium: &M,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> S {
        if self.rows.is_empty() {
            self.hits.reserve(ROOM);
            self.rows.resize(S::CHANNELS, [0.0; BLOCK]);
        }
        let even = medium.homogeneous().map(|c| c.sigma_t());
        let ray = match even {
            Some(sigma_t) => ray.up_to(ray.t_max.min(reach(sigma_t))),
            None => *ray,
        };
        photons.along(&ray, &mut self.hits);
        if self.hits.is_empty() {
            return S::default();
        }
        let Self {
            kernel,
            hits,
            rows,
            table,
            flights,
            ..
        } = self;
        let wo = -ray.direction;
        if let Some(sigma_t) = even {
            let phase = medium.phase(ray.origin);
            let block = Block {
                photons,
                kernel: *kernel,
                attenuation: Attenuation::Even(sigma_t),
                shift: 0.0,
            };
            return block.sum(hits, rows, |_, photon| {
                in_scattered(&phase, wo, photon.direction, 1.0)
            });
        }
        let end = hits
            .iter()
            .fold(0.0, |end: f32, hit| end.max(hit.t + hit.length));
        let ray = ray.up_to(end.min(ray.t_max));
        let attenuation = match self.transmittance {
            Transmittance::Table { max_error } => {
                self.error = self.error.max(table.measure(medium, &ray, max_error));
                Attenuation::Table(table)
            }
            Transmittance::Tracking { flights: count } => {
                flights.fly(medium, &ray, count, importance, sampler);
                Attenuation::Flights(flights)
            }
        };
        let shift = match photons.blur() {
            Blur::Disc => 0.0,
            Blur::Ball => sampler.next_1d(),
        };
        let block = Block {
            photons,
            kernel: *kernel,
            attenuation,
            shift,
        };
        block.sum(hits, rows, |hit, photon| {
            in_scattered(&medium.phase(ray.at(hit.t)), wo, photon.direction, 1.0)
        })
    }
}

/// Distance from where on nothing is seen in any channel.
fn reach<S: Spectrum>(sigma_t: S) -> f32 {
    OPAQUE / sigma_t.fold(f32::INFINITY, f32::min)
}

/// How the photons of a block are weighted.
struct Block<'a, S> {
    photons: &'a PhotonDiscs<S>,
    kernel: Kernel,
    attenuation: Attenuation<'a, S>,
    /// Where in a ball its transmittance is taken, if there is no closed form: the first of a
    /// sequence that is spread evenly. The mean over it is the integral.
    shift: f32,
}

impl<S: Spectrum> Block<'_, S> {
    /// The sum over all photons, with `phase` per steradian.
    #[inline]
    fn sum(
        &self,
        hits: &[Hit],
        rows: &mut [[f32; BLOCK]],
        phase: impl Fn(&Hit, &Payload<S>) -> f32,
    ) -> S {
        let mut radiance = S::default();
        for hits in hits.chunks(BLOCK) {
            let grey = self.attenuate(hits, rows);
            let mut sum = S::default();
            for (i, hit) in hits.iter().enumerate() {
                let photon = self.photons.photon(hit.slot);
                let weight = self.weight(hit, photon) * phase(hit, photon);
                sum += if grey {
                    photon.flux * (weight * rows[0][i])
                } else {
                    photon.flux * S::from_channels(|c| rows[c][i]) * weight
                };
            }
            radiance += sum;
        }
        radiance
    }

    /// Fills the rows with the transmittance to each photon, its mean over the chord of a ball.
    /// Returns whether the first row is good for all channels.
    #[inline]
    fn attenuate(&self, hits: &[Hit], rows: &mut [[f32; BLOCK]]) -> bool {
        match &self.attenuation {
            Attenuation::Even(sigma_t) => {
                let grey = *sigma_t == S::splat(sigma_t.channel(0));
                let rows = if grey { &mut rows[..1] } else { rows };
                for (c, row) in rows.iter_mut().enumerate() {
                    let (row, sigma_t) = (&mut row[..hits.len()], sigma_t.channel(c));
                    for (depth, hit) in row.iter_mut().zip(hits) {
                        *depth = sigma_t * hit.t;
                    }
                    exp_negative(row);
                    if self.photons.blur() == Blur::Ball {
                        for (transmittance, hit) in row.iter_mut().zip(hits) {
                            *transmittance *= mean_transmittance(sigma_t * hit.length);
                        }
                    }
                }
                grey
            }
            Attenuation::Table(table) => {
                let grey = table.is_grey();
                self.fill(hits, rows, grey, |t| table.depth(t));
                let rows = if grey { &mut rows[..1] } else { rows };
                for row in rows {
                    exp_negative(&mut row[..hits.len()]);
                }
                grey
            }
            Attenuation::Flights(flights) => {
                let grey = flights.is_grey();
                self.fill(hits, rows, grey, |t| flights.transmittance(t));
                grey
            }
        }
    }

    /// Fills the rows with what `value` is where each photon is met.
    #[inline]
    fn fill(&self, hits: &[Hit], rows: &mut [[f32; BLOCK]], grey: bool, value: impl Fn(f32) -> S) {
        for (i, hit) in hits.iter().enumerate() {
            let share = (self.shift + i as f32 * GOLDEN).fract();
            let value = value(hit.t + share * hit.length);
            let rows = if grey { &mut rows[..1] } else { &mut *rows };
            for (c, row) in rows.iter_mut().enumerate() {
                row[i] = value.channel(c);
            }
        }
    }

    /// The kernel, over what [`Payload::flux`] has of it.
    #[inline]
    fn weight(&self, hit: &Hit, photon: &Payload<S>) -> f32 {
        match self.photons.blur() {
            Blur::Disc => {
                let squared = hit.distance_squared * photon.inverse_squared;
                self.kernel.weight_2d(squared, 1.0)
            }
            Blur::Ball => hit.length,
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
