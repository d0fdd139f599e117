//! Pieces of beams while they are sorted.

use glam::DVec3;
use tyndall_core::Aabb;

/// A segment and what is within a radius of it.
pub(super) struct Segment {
    pub ends: [DVec3; 2],
    pub radius: f64,
    /// Where its beam goes, of length 1.
    pub direction: DVec3,
}

impl Segment {
    /// The smallest box around it, rounded to the outside.
    pub(super) fn bounds(&self) -> Aabb {
        let [a, b] = self.ends;
        let [min, max] = [a.min(b) - self.radius, a.max(b) + self.radius].map(DVec3::as_vec3);
        Aabb {
            min: min.map(f32::next_down),
            max: max.map(f32::next_up),
        }
    }
}
