//! Finds the boundaries that a point is inside of, by the crossings of rays.

use crate::boundary::Boundaries;
use crate::look::Look;
use glam::Vec3;
use tyndall_core::{Anchor, Ray, Spectrum};
use tyndall_surface::Surfaces;

/// Directions that no wall of a scene is likely to be parallel to.
const DIRECTIONS: [Vec3; 3] = [
    Vec3::new(0.419, 0.743, 0.522),
    Vec3::new(-0.811, 0.332, 0.482),
    Vec3::new(0.237, -0.591, -0.771),
];

/// The boundaries around `p`: those that most of three rays leave more often than they enter.
/// Open surfaces contain nothing; holes cut by alpha are not crossed.
pub(crate) fn boundaries_around<S: Spectrum>(
    p: Vec3,
    surfaces: &Surfaces,
    boundaries: &Boundaries,
    looks: &[Look<S>],
) -> Vec<u32> {
    let around = boundaries
        .all()
        .filter(|&b| boundaries.bounds(b).contains(p));
    let mut candidates: Vec<_> = around.map(|b| (b, 0)).collect();
    if candidates.is_empty() {
        return Vec::new();
    }
    for direction in DIRECTIONS {
        let direction = direction.normalize();
        let mut crossings: Vec<_> = candidates.iter().map(|&(b, _)| (b, 0)).collect();
        let mut ray = Ray::new(p, direction);
        while let Some((_, hit)) = surfaces.intersect(&ray) {
            let cut = looks[hit.shape as usize].is_cut(surfaces, &hit);
            let crossed = boundaries.of_shape(hit.shape).filter(|_| !cut);
            if let Some((_, n)) = crossings.iter_mut().find(|(b, _)| Some(*b) == crossed) {
                let leaving = surfaces.surface(&hit).geometric_normal.dot(direction) > 0.0;
                *n += if leaving { 1 } else { -1 };
            }
            ray = surfaces.spawn(&Anchor::Surface(hit), direction);
        }
        for ((_, votes), (_, n)) in candidates.iter_mut().zip(crossings) {
            *votes += u32::from(n > 0);
        }
    }
    let inside = candidates.into_iter().filter(|&(_, votes)| votes >= 2);
    inside.map(|(b, _)| b).collect()
}
