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
    /// For every photon, in the order of slots, the distance to its `k`-th nearest other photon, or
    /// `max_radius` if that is less: the pilot of the beam radiance estimate (Jarosz, Zwicker &
    /// Jensen 2008, "The beam radiance estimate for volumetric photon mapping").
    ///
    /// Where there are no `k` others it is `max_radius`, or if that is infinite the diagonal of the
    /// box around all. A `max_radius` that is negative or NaN counts as 0.
    ///
    /// A radius is 0 for `k` = 0, for a photon alone if `max_radius` is infinite, and where more
    /// than `k` photons coincide, as they do far from the origin, where positions are rounded:
    /// there they have no density. What cannot use that may take the rounding of the position for
    /// the least radius:
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
    /// let photons = Photons::build(&[1e6, 1e6, 1e6 + 3.0].map(photon)).unwrap();
    /// assert_eq!(photons.nearest_radii(2, 2.5), [2.5; 3]);
    /// let mut radii = photons.nearest_radii(1, 2.5);
    /// for (slot, radius) in radii.iter_mut().enumerate() {
    ///     let rounding = f32::EPSILON * photons.position(slot).abs().max_element();
    ///     *radius = radius.max(rounding); // may now be the radius of a disc
    /// }
    /// radii.sort_by(f32::total_cmp);
    /// assert_eq!(radii[2], 2.5);
    /// assert!(0.1 < radii[0] && radii[1] < 0.2);
    /// ```
    pub fn nearest_radii(&self, k: usize, max_radius: f32) -> Vec<f32> {
        let max_radius = max_radius.max(0.0);
        if k == 0 || self.is_empty() {
            return vec![0.0; self.len()];
        }
        if self.len() <= k {
            let infinite = max_radius == f32::INFINITY;
            let diagonal = || self.tree.bounds.size().length();
            let radius = if infinite { diagonal() } else { max_radius };
            return vec![radius; self.len()];
        }
        let mut radii = vec![0.0; self.len()];
        radii
            .par_chunks_mut(BLOCK)
            .enumerate()
            .for_each(|(i, block)| self.block_radii(i * BLOCK, k, max_radius, block));
        radii
    }

    /// Radii of the photons from slot `start` on; there are more than `k` photons. Those close to
    /// each other in space have much the same radius, so each search starts with that of the photon
    /// before.
    fn block_radii(&self, start: usize, k: usize, max_radius: f32, radii: &mut [f32]) {
        // A photon finds itself, too.
        let mut nearest = Nearest::new(k + 1);
        let mut before: Option<(Vec3, f32)> = None;
        for (slot, radius) in (start..).zip(radii) {
            let center = self.position(slot);
            let mut search = |limit| {
                self.nearest_below(center, limit, &mut nearest);
                let farthest = nearest.farthest().filter(|_| nearest.found().len() > k);
                farthest.map(|farthest| farthest.distance_squared.sqrt())
            };
            let most = limit(max_radius);
            let found = match before {
                Some((other, radius)) => {
                    let guess = limit(GUESS * radius);
                    let again = || (guess < most).then(|| reach(center, other, radius).min(most));
                    search(guess.min(most)).or_else(|| again().and_then(search))
                }
                None => search(most),
            };
            *radius = found.map_or(max_radius, |found| found.min(max_radius));
            before = Some((center, *radius));
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
