//! Nodes of eight boxes, tested together.

use crate::LANES;
use glam::Vec3;
use tyndall_core::{Aabb, Ray};
use wide::f32x8;

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// Another node, so many nodes behind this one: subtrees can be moved as a whole.
    Node(u32),
    /// A leaf.
    Leaf(u32),
}

impl Child {
    /// The same child, seen from so many nodes before, where so many leaves are before it.
    pub(crate) fn moved(self, nodes: usize, leaves: usize) -> Self {
        match self {
            Self::Node(offset) => Self::Node(offset + nodes as u32),
            Self::Leaf(leaf) => Self::Leaf(leaf + leaves as u32),
        }
    }
}

/// Set in children that are leaves; there are no more than 2²⁶.
const LEAF_BIT: u32 = 1 << 31;

/// Eight boxes side by side. Those of missing children hold nothing.
#[derive(Clone, Debug)]
#[repr(align(128))]
pub(crate) struct Node {
    /// Smallest and largest corners: `planes[1][2]` are the largest z.
    planes: [[f32x8; 3]; 2],
    children: [u32; LANES],
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        planes: [
            [f32x8::new([f32::INFINITY; LANES]); 3],
            [f32x8::new([f32::NEG_INFINITY; LANES]); 3],
        ],
        children: [LEAF_BIT; LANES],
    };

    /// Sets a child and its box. The box grows by one unit in the last place: a ray in the plane
    /// of a face is inside, and 0·∞ in [`Slabs`] can only arise outside.
    pub(crate) fn set(&mut self, lane: usize, bounds: Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[0][axis].as_mut_array()[lane] = bounds.min[axis].next_down();
            self.planes[1][axis].as_mut_array()[lane] = bounds.max[axis].next_up();
        }
        self.children[lane] = match child {
            Child::Node(offset) => offset,
            Child::Leaf(leaf) => leaf | LEAF_BIT,
        };
    }

    /// Where so many leaves are before those that it was made with.
    pub(crate) fn move_leaves(&mut self, by: usize) {
        for lane in 0..LANES {
            self.children[lane] = match self.child(lane).moved(0, by) {
                Child::Leaf(leaf) => leaf | LEAF_BIT,
                Child::Node(offset) => offset,
            };
        }
    }

    #[inline]
    pub(crate) fn child(&self, lane: usize) -> Child {
        let child = self.children[lane & (LANES - 1)];
        if child & LEAF_BIT == 0 {
            Child::Node(child)
        } else {
            Child::Leaf(child & !LEAF_BIT)
        }
    }

    /// The box of a child.
    pub(crate) fn bounds(&self, lane: usize) -> Aabb {
        let corner = |side: usize| {
            Vec3::from_array([0, 1, 2].map(|axis| self.planes[side][axis].as_array()[lane]))
        };
        Aabb {
            min: corner(0),
            max: corner(1),
        }
    }

    /// The box of all children.
    pub(crate) fn whole(&self) -> Aabb {
        (0..LANES).fold(Aabb::EMPTY, |all, lane| all.union(self.bounds(lane)))
    }

    /// A bit for every child whose box the ray meets.
    #[inline]
    pub(crate) fn meets(&self, ray: &Slabs) -> u32 {
        let mut near = f32x8::ZERO;
        let mut far = ray.t_max;
        for axis in 0..3 {
            let side = ray.negative[axis] & 1;
            let [entry, exit] = [self.planes[side][axis], self.planes[1 - side][axis]];
            // In this order NaN, see `set`, leaves the bounds as they are.
            near = ((entry - ray.origin[axis]) * ray.inverse[axis]).fast_max(near);
            far = ((exit - ray.origin[axis]) * ray.inverse[axis]).fast_min(far);
        }
        near.simd_le(far * f32x8::splat(ROUNDING)).to_bitmask()
    }
}

/// Of the three operations of a distance, twice: 1 + 2γ₃ (Ize 2013, "Robust BVH ray traversal"). The
/// end of the ray has it as well: a box may begin there.
const ROUNDING: f32 = 1.0 + 4e-7;

/// A ray, prepared for [`Node::meets`].
pub(crate) struct Slabs {
    origin: [f32x8; 3],
    /// 1/direction; infinite across the axes that the ray does not move along.
    inverse: [f32x8; 3],
    /// 1 where the direction is negative: the ray enters through the largest plane.
    negative: [usize; 3],
    t_max: f32x8,
}

impl Slabs {
    #[inline]
    pub(crate) fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.recip();
        Self {
            origin: ray.origin.to_array().map(f32x8::splat),
            inverse: inverse.to_array().map(f32x8::splat),
            negative: inverse.to_array().map(|d| usize::from(d < 0.0)),
            t_max: f32x8::splat(ray.t_max),
        }
    }
}
