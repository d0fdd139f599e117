//! Photons as a structure of arrays.

use crate::nearest::{Nearest, Neighbour};
use crate::octahedral;
use crate::photon::{BuildError, Photon};
use crate::tree::Tree;
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::Spectrum;

/// Photons in a balanced kd-tree.
///
/// A photon is named by its slot, its place in the order of the leaves: slots that follow each
/// other lie close in space and in memory.
#[derive(Clone, Debug, Default)]
pub struct Photons<S> {
    pub(crate) tree: Tree,
    pub(crate) directions: Vec<[i16; 2]>,
    pub(crate) flux: Vec<S>,
}

impl<S: Spectrum> Photons<S> {
    /// Stores photons, on the threads of the current pool of `rayon`; the same to the bit on any
    /// number of them.
    ///
    /// While it runs it takes up to 34 bytes a photon of three channels beside the list, no more
    /// than 4.5 above what the tree then holds.
    ///
    /// # Errors
    /// If a position is not finite or beyond 1e18, a direction is not of length 1 ± 0.001, or a
    /// flux is not finite; if there are more than `u32::MAX` photons.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_kd_tree::{Photon, Photons};
    ///
    /// let photon = |x| Photon {
    ///     position: Vec3::new(x, 0.0, 0.0),
    ///     direction: Vec3::Z,
    ///     flux: 0.25,
    /// };
    /// let list: Vec<_> = (0..100).map(|i| photon(i as f32)).collect();
    /// let photons = Photons::build(&list).unwrap();
    /// assert_eq!(photons.len(), 100);
    /// let mut flux = 0.0;
    /// photons.within(Vec3::ZERO, 3.0, |slot, _| flux += photons.flux(slot));
    /// assert_eq!(flux, 1.0); // of 0, 1, 2 and 3
    /// assert!(Photons::build(&[photon(f32::NAN)]).is_err());
    /// ```
    pub fn build(photons: &[Photon<S>]) -> Result<Self, BuildError> {
        check(photons)?;
        let (tree, order) = Tree::build(photons.len(), |i| photons[i].position);
        let (directions, flux) = order
            .par_iter()
            .map(|&i| &photons[i as usize])
            .map(|photon| (octahedral::pack(photon.direction), photon.flux))
            .unzip();
        Ok(Self {
            tree,
            directions,
            flux,
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

    /// Memory held, in bytes: of three channels at most 29.5 a photon, and 400 a tree.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + held(&self.tree.nodes)
            + held(&self.tree.blocks)
            + held(&self.directions)
            + held(&self.flux)
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

    /// The photon, unpacked.
    #[inline]
    pub fn get(&self, slot: usize) -> Photon<S> {
        Photon {
            position: self.position(slot),
            direction: self.direction(slot),
            flux: self.flux(slot),
        }
    }

    /// Calls `visit` with the slot and the squared distance of every photon in the closed ball
    /// around `center`, once each, in no order. `visit` cannot end it early: whether a ball holds k
    /// photons is a question for [`Photons::nearest`], which stops looking where they suffice.
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

    /// Finds the nearest photons, as many as `nearest` has room for, in the closed ball around
    /// `center`. Of photons equally far from `center`, any may be the ones left out.
    ///
    /// Nothing is found if a number is NaN, `radius` is negative or `center` is not finite.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_kd_tree::{Nearest, Photon, Photons};
    ///
    /// let photon = |x: u32| Photon {
    ///     position: Vec3::new(x as f32, 0.0, 0.0),
    ///     direction: Vec3::Z,
    ///     flux: 0.25,
    /// };
    /// let list: Vec<_> = (1..100).map(photon).collect();
    /// let photons = Photons::build(&list).unwrap();
    /// let mut nearest = Nearest::new(3);
    /// photons.nearest(Vec3::ZERO, 10.0, &mut nearest);
    /// assert_eq!(nearest.found().len(), 3); // 1, 2 and 3
    /// assert_eq!(nearest.farthest().unwrap().distance_squared, 9.0);
    /// ```
    #[inline]
    pub fn nearest(&self, center: Vec3, radius: f32, nearest: &mut Nearest) {
        self.nearest_below(center, limit(radius), nearest);
    }

    /// As [`Photons::nearest`], for squared distances below `limit`.
    #[inline]
    pub(crate) fn nearest_below(&self, center: Vec3, limit: f32, nearest: &mut Nearest) {
        nearest.begin(self.len());
        let mut limit = if nearest.k() > 0 { limit } else { 0.0 };
        self.tree.visit(center, limit, |slot, distance_squared| {
            let candidate = Neighbour {
                slot: slot as u32,
                distance_squared,
            };
            limit = nearest.add(candidate, limit);
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
