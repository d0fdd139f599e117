//! The test of a ray against the eight boxes of a compressed node.

use glam::Vec3A;
use obvhs::cwbvh::node::{CwBvhNode, extract_byte64};
use tyndall_core::Ray;

/// What rounding may move a plane of a box by, relative to its distance from the origin of the
/// ray: eight roundings of `f32`, where subtraction, product, reciprocal and the triangle's own
/// test need six.
const DISTANCE_SLACK: f32 = 8.0 / (1 << 24) as f32;

/// The same relative to a step of the node's grid. Quantisation rounds the step's exponent and the
/// planes by less than 2⁻¹⁰ of it.
const GRID_SLACK: f32 = 1.0 / (1 << 8) as f32;

/// Components of a direction below it, relative to the largest, count as this much: the reciprocal
/// must stay finite, and over a length of 1e18 it moves a ray by no more than one.
const FLATTEST: f32 = 1e-18;

/// A ray prepared for boxes.
///
/// Boxes are widened by [`DISTANCE_SLACK`] and [`GRID_SLACK`], so that no box is missed whose
/// primitive is met (after Ize 2013, "Robust BVH Ray Traversal"). The test that comes with the
/// tree is not conservative and starts at a distance of 1e-4.
pub(crate) struct BoxRay {
    pub(crate) direction: Vec3A,
    origin: Vec3A,
    inverse: Vec3A,
    backwards: [bool; 3],
}

impl BoxRay {
    pub(crate) fn new(ray: &Ray) -> Self {
        let flattest = FLATTEST * ray.direction.abs().max_element();
        let inverse = ray
            .direction
            .map(|d| 1.0 / d.abs().max(flattest).copysign(d));
        Self {
            direction: ray.direction.into(),
            origin: ray.origin.into(),
            inverse: inverse.into(),
            backwards: inverse.to_array().map(|i| i < 0.0),
        }
    }

    /// The children met within `[0, t_max]`, as bits in the order of traversal.
    #[inline(always)]
    pub(crate) fn children(&self, node: &CwBvhNode, t_max: f32, octant: u32) -> u32 {
        let step = node.compute_extent();
        let corner = Vec3A::from(node.p) - self.origin;
        let slack = (corner.abs() * DISTANCE_SLACK + step * GRID_SLACK) * self.inverse.abs();
        let scale = (step * self.inverse).to_array();
        let near = (corner * self.inverse - slack).to_array();
        let far = (corner * self.inverse + slack).to_array();

        let planes = [
            (&node.child_min_x, &node.child_max_x),
            (&node.child_min_y, &node.child_max_y),
            (&node.child_min_z, &node.child_max_z),
        ];
        let mut enter = [0.0_f32; 8];
        let mut leave = [t_max; 8];
        for axis in 0..3 {
            let (low, high) = planes[axis];
            let (first, last) = if self.backwards[axis] {
                (high, low)
            } else {
                (low, high)
            };
            for child in 0..8 {
                let a = f32::from(first[child]) * scale[axis] + near[axis];
                let b = f32::from(last[child]) * scale[axis] + far[axis];
                enter[child] = if a > enter[child] { a } else { enter[child] };
                leave[child] = if b < leave[child] { b } else { leave[child] };
            }
        }
        let (bits, places) = node.get_child_and_index_bits(octant);
        let mut mask = 0;
        for child in 0..8 {
            let met = u32::from(enter[child] <= leave[child]);
            mask |= (met * extract_byte64(bits, child)) << extract_byte64(places, child);
        }
        mask
    }
}
