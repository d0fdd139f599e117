//! Photons as a structure of arrays.

use crate::nearest::{Nearest, Neighbour};
use crate::octahedral;
use crate::photon::{BuildError, Photon};
use crate::tree::Tree;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::BTreeSet;
use tyndall_core::{MediumId, Spectrum};

/// Photons in a balanced kd-tree.
///
/// A photon is named by its slot, its place in the order of the leaves: slots that follow each
/// other lie close in space and in memory.
#[derive(Clone, Debug, Default)]
pub struct Photons<S> {
    pub(crate) tree: Tree,
    pub(crate) directions: Vec<[i16; 2]>,
    pub(crate) flux: Vec<S>,
    /// Index in `media` of every photon; empty if there are fewer than two media.
    pub(crate) medium_indices: Vec<u16>,
    /// In ascending order.
    pub(crate) media: Vec<MediumId>,
}

impl<S: Spectrum> Photons<S> {
    /// Stores photons, on the threads of the current pool of `rayon`; the same to the bit on any
    /// number of them.
    ///
    /// # Errors
    /// If a position is not finite or beyond 1e18, a direction is not of length 1 ± 0.001, or a
    /// flux is not finite; if there are more than `u32::MAX` photons or 65,535 media.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::MediumId;
    /// use tyndall_kd_tree::{Photon, Photons};
    ///
    /// let photon = |x| Photon {
    ///     position: Vec3::new(x, 0.0, 0.0),
    ///     direction: Vec3::Z,
    ///     flux: 0.25,
    ///     medium: MediumId(1),
    /// };
    /// let photons = Photons::build((0..100).map(|i| photon(i as f32)).collect()).unwrap();
    /// assert_eq!(photons.len(), 100);
    /// let mut flux = 0.0;
    /// photons.within(Vec3::ZERO, 3.0, |slot, _| flux += photons.flux(slot));
    /// assert_eq!(flux, 1.0); // of 0, 1, 2 and 3
    /// assert!(Photons::build(vec![photon(f32::NAN)]).is_err());
    /// ```
    pub fn build(photons: Vec<Photon<S>>) -> Result<Self, BuildError> {
        check(&photons)?;
        let media = distinct_media(&photons)?;
        let (tree, order) = Tree::build(photons.len(), |i| photons[i].position);
        let in_order = || order.par_iter().map(|&i| &photons[i as usize]);
        let medium_indices = if media.len() > 1 {
            in_order()
                .map(|photon| media.partition_point(|&m| m.0 < photon.medium.0) as u16)
                .collect()
        } else {
            Vec::new()
        };
        let (directions, flux) = in_order()
            .map(|photon| (octahedral::pack(photon.direction), photon.flux))
            .unzip();
        Ok(Self {
            tree,
            directions,
            flux,
            medium_indices,
            media,
        })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.tree.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory held, in bytes: at most 32 a photon of three channels.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + held(&self.tree.nodes)
            + held(&self.tree.blocks)
            + held(&self.directions)
            + held(&self.flux)
            + held(&self.medium_indices)
            + held(&self.media)
    }

    /// Position of a photon. This and its siblings panic if `slot` is not below
    /// [`Photons::len`].
    #[inline]
    pub fn position(&self, slot: usize) -> Vec3 {
        self.tree.position(slot)
    }

    /// Direction of travel, unit, within 6.5e-5 rad of the one that was stored and exact along
    /// the axes.
    #[inline]
    pub fn direction(&self, slot: usize) -> Vec3 {
        octahedral::unpack(self.directions[slot])
    }

    /// Power as it was stored.
    #[inline]
    pub fn flux(&self, slot: usize) -> S {
        self.flux[slot]
    }

    /// What fills the space around it.
    #[inline]
    pub fn medium(&self, slot: usize) -> MediumId {
        self.media[self.medium_index(slot)]
    }

    /// The photon, unpacked.
    #[inline]
    pub fn get(&self, slot: usize) -> Photon<S> {
        Photon {
            position: self.position(slot),
            direction: self.direction(slot),
            flux: self.flux(slot),
            medium: self.medium(slot),
        }
    }

    #[inline]
    pub(crate) fn medium_index(&self, slot: usize) -> usize {
        assert!(slot < self.len(), "slot {slot} of {} photons", self.len());
        self.medium_indices.get(slot).map_or(0, |&m| usize::from(m))
    }

    /// Calls `visit` with the slot and the squared distance of every photon in the closed ball
    /// around `center`, once each, in no order.
    ///
    /// Nothing is found if a number is NaN, `radius` is negative or `center` is not finite.
    #[inline]
    pub fn within(&self, center: Vec3, radius: f32, mut visit: impl FnMut(usize, f32)) {
        let limit = limit(radius);
        self.tree.visit(center, limit, |slot, distance_squared| {
            visit(slot, distance_squared);
            limit
        });
    }

    /// Finds the nearest photons, as many as `nearest` has room for, among those in the closed
    /// ball around `center` that `accept` takes by their slots. Of photons equally far from
    /// `center`, any may be the ones left out. Allocates nothing, apart from the first query of
    /// `nearest`.
    ///
    /// Nothing is found if a number is NaN, `radius` is negative or `center` is not finite.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::MediumId;
    /// use tyndall_kd_tree::{Nearest, Photon, Photons};
    ///
    /// let photon = |x: u32| Photon {
    ///     position: Vec3::new(x as f32, 0.0, 0.0),
    ///     direction: Vec3::Z,
    ///     flux: 0.25,
    ///     medium: MediumId(x % 2),
    /// };
    /// let photons = Photons::build((0..100).map(photon).collect()).unwrap();
    /// let mut nearest = Nearest::new(3);
    /// let odd = |slot| photons.medium(slot) == MediumId(1);
    /// photons.nearest(Vec3::ZERO, 10.0, odd, &mut nearest);
    /// assert_eq!(nearest.found().len(), 3); // 1, 3 and 5
    /// assert_eq!(nearest.farthest().unwrap().distance_squared, 25.0);
    /// ```
    #[inline]
    pub fn nearest(
        &self,
        center: Vec3,
        radius: f32,
        accept: impl FnMut(usize) -> bool,
        nearest: &mut Nearest,
    ) {
        self.nearest_below(center, limit(radius), accept, nearest);
    }

    /// As [`Photons::nearest`], for squared distances below `limit`.
    #[inline]
    pub(crate) fn nearest_below(
        &self,
        center: Vec3,
        limit: f32,
        mut accept: impl FnMut(usize) -> bool,
        nearest: &mut Nearest,
    ) {
        nearest.begin(self.len());
        let mut limit = if nearest.k() > 0 { limit } else { 0.0 };
        self.tree.visit(center, limit, |slot, distance_squared| {
            if accept(slot) {
                limit = nearest.add(
                    Neighbour {
                        slot,
                        distance_squared,
                    },
                    limit,
                );
            }
            limit
        });
        nearest.end();
    }
}

/// The bound that squared distances of a closed ball stay below.
#[inline]
pub(crate) fn limit(radius: f32) -> f32 {
    if radius >= 0.0 {
        (radius * radius).next_up()
    } else {
        0.0
    }
}

fn held<T>(vector: &Vec<T>) -> usize {
    vector.capacity() * size_of::<T>()
}

fn check<S: Spectrum>(photons: &[Photon<S>]) -> Result<(), BuildError> {
    if u32::try_from(photons.len()).is_err() {
        return Err(BuildError::TooManyPhotons {
            photons: photons.len(),
        });
    }
    photons
        .par_iter()
        .enumerate()
        .find_map_first(|(i, photon)| photon.check(i).err())
        .map_or(Ok(()), Err)
}

fn distinct_media<S>(photons: &[Photon<S>]) -> Result<Vec<MediumId>, BuildError> {
    let runs = photons.chunk_by(|a, b| a.medium == b.medium);
    let media: BTreeSet<u32> = runs.map(|run| run[0].medium.0).collect();
    if media.len() > usize::from(u16::MAX) {
        return Err(BuildError::TooManyMedia { media: media.len() });
    }
    Ok(media.into_iter().map(MediumId).collect())
}
