//! Nodes of eight boxes, tested together.

use crate::LANES;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;
use tyndall_core::{Aabb, Ray};

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// Another node, so many nodes behind this one: subtrees can be moved as a whole.
    Node(u32),
    /// A leaf.
    Leaf(u32),
}

impl Child {
    /// The same child, seen from so many nodes before.
    pub(crate) fn moved(self, by: usize) -> Self {
        match self {
            Self::Node(offset) => Self::Node(offset + by as u32),
            leaf @ Self::Leaf(_) => leaf,
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
    planes: [[[f32; LANES]; 3]; 2],
    children: [u32; LANES],
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; LANES]; 3], [[f32::NEG_INFINITY; LANES]; 3]],
        children: [LEAF_BIT; LANES],
    };

    /// Sets a child and its box. The box grows by one unit in the last place: a ray in the plane
    /// of a face is inside, and 0·∞ in [`Slabs`] can only arise outside.
    pub(crate) fn set(&mut self, lane: usize, bounds: Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[0][axis][lane] = bounds.min[axis].next_down();
            self.planes[1][axis][lane] = bounds.max[axis].next_up();
        }
        self.children[lane] = match child {
            Child::Node(offset) => offset,
            Child::Leaf(leaf) => leaf | LEAF_BIT,
        };
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
        let corner =
            |side: usize| Vec3::from_array([0, 1, 2].map(|axis| self.planes[side][axis][lane]));
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
    #[inline(always)] // into code for the level of the machine
    pub(crate) fn meets<S: Simd>(&self, ray: &Slabs<S>) -> u32 {
        let simd = ray.t_max.token();
        let mut near = f32x8::splat(simd, 0.0);
        let mut far = ray.t_max;
        for axis in 0..3 {
            let side = ray.negative[axis] & 1;
            let entry = f32x8::from_slice(simd, &self.planes[side][axis]);
            let exit = f32x8::from_slice(simd, &self.planes[1 - side][axis]);
            near = near.max((entry - ray.origin[axis]) * ray.inverse[axis]);
            far = far.min((exit - ray.origin[axis]) * ray.inverse[axis]);
        }
        near.simd_le(far * ROUNDING).to_bitmask() as u32
    }
}

/// Of the three operations of a distance, twice: 1 + 2γ₃ (Ize 2013, "Robust BVH ray traversal"). The
/// end of the ray has it as well: a box may begin there.
const ROUNDING: f32 = 1.0 + 4e-7;

/// A ray, prepared for [`Node::meets`].
pub(crate) struct Slabs<S: Simd> {
    origin: [f32x8<S>; 3],
    /// 1/direction; infinite across the axes that the ray does not move along.
    inverse: [f32x8<S>; 3],
    /// 1 where the direction is negative: the ray enters through the largest plane.
    negative: [usize; 3],
    t_max: f32x8<S>,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &Ray) -> Self {
        let inverse = ray.direction.recip();
        Self {
            origin: splat(simd, ray.origin),
            inverse: splat(simd, inverse),
            negative: inverse.to_array().map(|d| usize::from(d < 0.0)),
            t_max: f32x8::splat(simd, ray.t_max),
        }
    }
}

/// A point eight times. Not by `map`: what is not inlined by force is not for the level.
#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, v: Vec3) -> [f32x8<S>; 3] {
    [
        f32x8::splat(simd, v.x),
        f32x8::splat(simd, v.y),
        f32x8::splat(simd, v.z),
    ]
}
