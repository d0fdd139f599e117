//! The pilot of adaptive radii.

use crate::nearest::Nearest;
use crate::photons::{Photons, limit};
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::Spectrum;

/// Photons that a thread takes at once.
const BLOCK: usize = 1024;
/// A radius this many times that of the photon before is nearly always enough.
const GUESS: f32 = 1.2;

impl<S: Spectrum> Photons<S> {
    /// For every photon, in the order of slots, the distance to its `k`-th nearest other photon
    /// of the same medium, or `max_radius` if that is less or there are not so many others: the
    /// pilot of the beam radiance estimate (Jarosz, Zwicker & Jensen 2008, "The beam radiance
    /// estimate for volumetric photon mapping").
    ///
    /// `max_radius` may be infinite, and is then the radius of photons with fewer than `k` others;
    /// if it is negative or NaN, it counts as 0. For `k` = 0, all radii are 0.
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
    ///     medium: MediumId(0),
    /// };
    /// let photons = Photons::build([0.0, 1.0, 3.0].map(photon).to_vec()).unwrap();
    /// for (slot, radius) in photons.nearest_radii(2, 2.5).into_iter().enumerate() {
    ///     let expected = if photons.position(slot).x == 1.0 { 2.0 } else { 2.5 };
    ///     assert_eq!(radius, expected);
    /// }
    /// ```
    pub fn nearest_radii(&self, k: usize, max_radius: f32) -> Vec<f32> {
        let mut radii = vec![0.0; self.len()];
        if k > 0 {
            let max_radius = max_radius.max(0.0);
            radii
                .par_chunks_mut(BLOCK)
                .enumerate()
                .for_each(|(i, block)| self.block_radii(i * BLOCK, k, max_radius, block));
        }
        radii
    }

    /// Radii of the photons from slot `start` on. Those close to each other in space have much the
    /// same radius, so each search starts with that of the photon before.
    fn block_radii(&self, start: usize, k: usize, max_radius: f32, radii: &mut [f32]) {
        let mut nearest = Nearest::new(k);
        let mut before: Option<(Vec3, usize, f32)> = None;
        for (slot, radius) in (start..).zip(radii) {
            let (center, medium) = (self.position(slot), self.medium_index(slot));
            let mut search = |limit| {
                let accept = |other| other != slot && self.medium_index(other) == medium;
                self.nearest_below(center, limit, accept, &mut nearest);
                let farthest = nearest.farthest().filter(|_| nearest.found().len() == k);
                farthest.map(|farthest| farthest.distance_squared.sqrt())
            };
            let most = limit(max_radius);
            let found = match before {
                Some((other, same, radius)) if same == medium => {
                    let guess = limit(GUESS * radius);
                    let again = || (guess < most).then(|| reach(center, other, radius).min(most));
                    search(guess.min(most)).or_else(|| again().and_then(search))
                }
                _ => search(most),
            };
            *radius = found.map_or(max_radius, |found| found.min(max_radius));
            before = Some((center, medium, *radius));
        }
    }
}

/// A bound of the squared distance from `center` to its k-th nearest, given another photon and
/// its distance to its own k-th nearest: by the triangle inequality that ball, drawn around the
/// other, lies in the one around `center` whose radius is longer by their distance. The margin is
/// for rounding.
#[inline]
fn reach(center: Vec3, other: Vec3, radius: f32) -> f32 {
    let reach = radius + center.distance(other);
    reach * reach * (1.0 + 1e-5) + f32::MIN_POSITIVE
}
