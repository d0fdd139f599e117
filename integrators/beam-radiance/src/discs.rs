//! Photons of a medium as discs.

use crate::Blur;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;
use tyndall_bvh::{Discs, Quality};
use tyndall_core::{MediumId, PassError, Ray, Spectrum};
use tyndall_density::{Chord, RADII};
use tyndall_kd_tree::Photons;

use crate::options::unsupported;

/// The photons of one medium, and what is met of them along rays.
#[derive(Clone, Debug)]
pub(crate) struct PhotonDiscs<S> {
    pub(crate) medium: MediumId,
    blur: Blur,
    discs: Discs,
    /// In the order of the slots.
    photons: Vec<Payload<S>>,
}

/// What a photon brings along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Payload<S> {
    /// Of travel.
    pub(crate) direction: Vec3,
    /// 1/r².
    pub(crate) inverse_squared: f32,
    /// What is scattered of its flux, over r² (disc) or over the volume (ball).
    pub(crate) flux: S,
}

/// A photon on a ray.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hit {
    pub(crate) slot: u32,
    /// Where the ray passes the centre of a disc, or enters a ball.
    pub(crate) t: f32,
    /// How much of a ball the ray runs through.
    pub(crate) length: f32,
    /// Squared distance from the centre.
    pub(crate) distance_squared: f32,
}

impl<S: Spectrum> PhotonDiscs<S> {
    /// Of the photons in `medium`, but for those whose radii are out of bounds.
    pub(crate) fn build(
        medium: MediumId,
        photons: &Photons<S>,
        radii: &[f32],
        blur: Blur,
    ) -> Result<Self, PassError> {
        let slots: Vec<u32> = (0..photons.len() as u32)
            .filter(|&slot| RADII.contains(&radii[slot as usize]))
            .collect();
        let center = |&slot: &u32| photons.position(slot as usize);
        let centers: Vec<Vec3> = slots.par_iter().map(center).collect();
        let radius = |&slot: &u32| radii[slot as usize];
        let of_slots: Vec<f32> = slots.par_iter().map(radius).collect();
        let discs = Discs::build(&centers, &of_slots, Quality::Fast).map_err(unsupported)?;
        let payload = |&index: &u32| {
            let slot = slots[index as usize] as usize;
            let inverse = 1.0 / radii[slot];
            let density = match blur {
                Blur::Disc => inverse * inverse,
                Blur::Ball => inverse * inverse * inverse * (0.75 / PI),
            };
            Payload {
                direction: photons.direction(slot),
                inverse_squared: inverse * inverse,
                flux: photons.flux(slot) * density,
            }
        };
        let photons = discs.order().par_iter().map(payload).collect();
        Ok(Self {
            medium,
            blur,
            discs,
            photons,
        })
    }

    #[inline]
    pub(crate) fn photon(&self, slot: u32) -> &Payload<S> {
        &self.photons[slot as usize]
    }

    pub(crate) fn blur(&self) -> Blur {
        self.blur
    }

    pub(crate) fn len(&self) -> usize {
        self.photons.len()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.discs.bytes() + size_of_val(self.photons.as_slice())
    }

    /// Puts all photons that the ray meets into `hits`, once each.
    pub(crate) fn along(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        match self.blur {
            Blur::Disc => self.discs.along(ray, |slot, t, distance_squared| {
                hits.push(Hit {
                    slot: slot as u32,
                    t,
                    length: 0.0,
                    distance_squared,
                });
            }),
            Blur::Ball => self.discs.chords(ray, |slot, t, distance_squared| {
                let radius = self.discs.radius(slot);
                let chord = Chord::new(t, distance_squared, radius, ray.t_max);
                hits.extend(chord.map(|Chord { start, length }| Hit {
                    slot: slot as u32,
                    t: start,
                    length,
                    distance_squared,
                }));
            }),
        }
    }
}
