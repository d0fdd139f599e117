//! Photons of a medium as discs.

use crate::{Aim, Blur, Search, unsupported};
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;
use tyndall_bvh::{Discs, LANES, Quality, Values};
use tyndall_core::{PassError, Ray, Spectrum};
use tyndall_density::{Chord, Kernel, RADII};
use tyndall_kd_tree::Photons;

/// The photons of one medium, to be met along rays.
#[derive(Clone, Debug)]
pub struct PhotonDiscs<S> {
    blur: Blur,
    discs: Discs,
    /// What is scattered of the flux, over r² (disc) or over the volume (ball); by slot as what follows.
    flux: Values<S>,
    /// Of travel.
    directions: Vec<Vec3>,
}

/// The photons on a ray, in blocks of eight slots of which it meets one at least. What belongs to
/// the others of a block is 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hits {
    pub(crate) blocks: Vec<u32>,
    /// A bit for each photon that is met.
    pub(crate) lanes: Vec<u8>,
    /// Where the ray passes the centre of a disc, or enters a ball.
    pub(crate) t: Vec<[f32; LANES]>,
    /// How much of a ball the ray runs through; nothing at all for discs.
    pub(crate) length: Vec<[f32; LANES]>,
    /// The kernel, over what the flux has of it.
    pub(crate) weight: Vec<[f32; LANES]>,
}

/// Room for the blocks of a ray, at first.
const ROOM: usize = 256;

impl Hits {
    fn clear(&mut self) {
        self.blocks.reserve(ROOM);
        self.lanes.reserve(ROOM);
        self.t.reserve(ROOM);
        self.weight.reserve(ROOM);
        self.blocks.clear();
        self.lanes.clear();
        self.t.clear();
        self.length.clear();
        self.weight.clear();
    }

    /// Where the ray leaves the last photon.
    pub(crate) fn end(&self) -> f32 {
        let starts = self.t.as_flattened().iter();
        let end = starts.fold(0.0, |end: f32, &t| end.max(t));
        let pairs = self.t.as_flattened().iter().zip(self.length.as_flattened());
        pairs.fold(end, |end, (t, length)| end.max(t + length))
    }
}

/// Block, counted from the first, and lane of every bit set.
#[inline]
pub(crate) fn each(lanes: &[u8]) -> impl Iterator<Item = (usize, usize)> {
    let of_block = |(block, &lanes): (usize, &u8)| {
        let mut rest = lanes;
        std::iter::from_fn(move || {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest.wrapping_sub(1);
            (lane < LANES).then_some((block, lane))
        })
    };
    lanes.iter().enumerate().flat_map(of_block)
}

impl<S: Spectrum> PhotonDiscs<S> {
    /// Of all photons but those whose radii, by `search`, are out of [`RADII`]. One alone has none,
    /// unless one is given.
    ///
    /// # Errors
    /// [`PassError::Unsupported`] for positions beyond 1e18.
    pub fn build(photons: &Photons<S>, search: Search, blur: Blur) -> Result<Self, PassError> {
        let radii = radii(search, photons);
        let slots: Vec<u32> = (0..photons.len() as u32)
            .filter(|&slot| RADII.contains(&radii[slot as usize]))
            .collect();
        let center = |&slot: &u32| photons.position(slot as usize);
        let centers: Vec<Vec3> = slots.par_iter().map(center).collect();
        let radius = |&slot: &u32| radii[slot as usize];
        let of_slots: Vec<f32> = slots.par_iter().map(radius).collect();
        let discs = Discs::build(&centers, &of_slots, Quality::Fast).map_err(unsupported)?;
        let order = discs.order().iter();
        let photon = |&index: &u32| {
            let slot = slots[index as usize] as usize;
            (slot, 1.0 / radii[slot])
        };
        let flux = |index| {
            let (slot, inverse) = photon(index);
            let density = match blur {
                Blur::Disc => inverse * inverse,
                Blur::Ball => inverse * inverse * inverse * (0.75 / PI),
            };
            photons.flux(slot) * density
        };
        Ok(Self {
            blur,
            flux: Values::new(order.clone().map(flux)),
            directions: order.map(|i| photons.direction(photon(i).0)).collect(),
            discs,
        })
    }

    /// Of travel, of a photon on a ray.
    #[inline]
    pub(crate) fn direction(&self, block: u32, lane: usize) -> Vec3 {
        self.directions[block as usize * LANES + lane]
    }

    /// Sum of the flux of photons on a ray, each times its weight.
    #[inline]
    pub(crate) fn flux(&self, channel: usize, hits: &Hits, weights: &[[f32; LANES]]) -> f32 {
        self.flux.sum(channel, &hits.blocks, weights)
    }

    pub(crate) fn blur(&self) -> Blur {
        self.blur
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.discs.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        self.discs.bytes() + self.flux.bytes() + size_of_val(self.directions.as_slice())
    }

    /// Puts all photons that the ray meets into `hits`, once each.
    pub(crate) fn along(&self, ray: &Ray, kernel: Kernel, hits: &mut Hits) {
        hits.clear();
        match self.blur {
            Blur::Disc => {
                self.discs.blocks_along(ray, |met| {
                    let [t, squared] = met.values;
                    hits.blocks.extend_from_slice(met.blocks);
                    hits.lanes.extend_from_slice(met.lanes);
                    hits.t.extend_from_slice(t);
                    hits.weight.extend_from_slice(squared);
                });
                kernel.weights_2d(hits.weight.as_flattened_mut());
            }
            Blur::Ball => self.discs.blocks_chords(ray, |met| {
                let first = hits.blocks.len();
                hits.blocks.extend_from_slice(met.blocks);
                hits.lanes.extend_from_slice(met.lanes);
                hits.t.resize(hits.blocks.len(), [0.0; LANES]);
                hits.length.resize(hits.blocks.len(), [0.0; LANES]);
                let [t, squared] = met.values;
                for (i, lane) in each(met.lanes) {
                    let radius = self.discs.radius(met.blocks[i] as usize * LANES + lane);
                    if let Some(chord) = Chord::new(t[i][lane], squared[i][lane], radius, ray.t_max)
                    {
                        hits.t[first + i][lane] = chord.start;
                        hits.length[first + i][lane] = chord.length;
                    }
                }
                hits.weight.extend_from_slice(&hits.length[first..]);
            }),
        }
    }
}

/// The radius of every photon of a medium: to its nearest others.
fn radii<S: Spectrum>(search: Search, photons: &Photons<S>) -> Vec<f32> {
    let Aim { count, limit, part } = match search {
        Search::Within(radius) => return vec![radius; photons.len()],
        Search::Nearest(neighbours) => neighbours.pilot(photons.len().saturating_sub(1)),
    };
    let mut radii = photons.nearest_radii(count, limit);
    radii.par_iter_mut().for_each(|radius| *radius *= part);
    radii
}
