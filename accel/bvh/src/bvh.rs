//! The tree.

use crate::tree::Tree;
use crate::{BrokenTree, BuildError, LEAF, Quality, builder, is_within};
use rayon::prelude::*;
use std::ops::Range;
use tyndall_core::{Aabb, Ray};

/// A tree over boxes. Its leaves are ranges of slots; what is in a slot, its owner knows.
#[derive(Clone, Debug)]
pub struct Bvh {
    tree: Tree,
    slots: usize,
}

impl Bvh {
    /// A tree over `bounds`, and the index of the primitive of each slot.
    ///
    /// # Errors
    /// A box is empty, not finite or beyond 1e18, or there are more than `u32::MAX`.
    pub fn build(bounds: &[Aabb], quality: Quality) -> Result<(Self, Vec<u32>), BuildError> {
        let fault = |(index, bounds): (usize, &Aabb)| {
            if bounds.min.is_nan() || bounds.max.is_nan() {
                Some(BuildError::NotFinite { index })
            } else if bounds.is_empty() {
                Some(BuildError::Empty { index })
            } else if !(is_within(bounds.min) && is_within(bounds.max)) {
                Some(BuildError::NotFinite { index })
            } else {
                None
            }
        };
        match bounds.par_iter().enumerate().find_map_first(fault) {
            Some(fault) => Err(fault),
            None => Self::over(bounds, quality),
        }
    }

    /// As [`Bvh::build`], over boxes known to be good.
    pub(crate) fn over(bounds: &[Aabb], quality: Quality) -> Result<(Self, Vec<u32>), BuildError> {
        let (nodes, order) = builder::build(bounds, quality)?;
        let (tree, slots) = (Tree { nodes }, order.len());
        Ok((Self { tree, slots }, order))
    }

    /// Calls `visit` with the slots of every leaf whose box the ray meets in `[0, t_max]`, once
    /// each and in no particular order.
    #[inline]
    pub fn traverse(&self, ray: &Ray, mut visit: impl FnMut(Range<usize>)) {
        self.tree.traverse(ray, |leaf| visit(self.slots_of(leaf)));
    }

    #[inline]
    fn slots_of(&self, leaf: usize) -> Range<usize> {
        let start = leaf * LEAF;
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
        self.tree.bytes()
    }

    /// Whether every node and every leaf is met once and lies in the box above it. `bounds` is the
    /// box of the primitive in a slot.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self, bounds: impl Fn(usize) -> Aabb) -> Result<(), BrokenTree> {
        let of_leaf = |leaf| {
            let slots = self.slots_of(leaf).map(&bounds);
            slots.fold(Aabb::EMPTY, Aabb::union)
        };
        self.tree.validate(self.slots.div_ceil(LEAF), of_leaf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::Child;
    use glam::Vec3;

    fn unit(i: usize) -> Aabb {
        let min = Vec3::new(i as f32, 0.0, 0.0);
        Aabb {
            min,
            max: min + 1.0,
        }
    }

    #[test]
    fn a_broken_tree_is_found() {
        let bounds: Vec<_> = (0..1000).map(unit).collect();
        let (tree, order) = Bvh::build(&bounds, Quality::Fast).expect("boxes are good");
        let of_slot = |slot: usize| bounds[order[slot] as usize];
        assert_eq!(tree.validate(of_slot), Ok(()));
        let broken = |lane, bounds, child| {
            let mut tree = tree.clone();
            tree.tree.nodes[0].set(lane, bounds, child);
            tree.validate(of_slot)
        };
        let [node, lane] = [0, 1];
        let (above, child) = (tree.tree.nodes[0].bounds(1), tree.tree.nodes[0].child(1));
        let outside = Err(BrokenTree::Outside { node, lane });
        assert_eq!(broken(1, unit(500), child), outside);
        let first = tree.tree.nodes[0].child(0);
        let everything = tree.tree.nodes[0].whole();
        let twice = Err(BrokenTree::Child { node: 0, lane: 1 });
        assert_eq!(
            broken(1, everything, first).map_err(|e| matches!(e, BrokenTree::Child { .. })),
            Err(true)
        );
        assert_eq!(broken(1, above, Child::Node(1 << 20)), twice);
        assert_eq!(broken(1, above, Child::Leaf(1 << 20)), twice);
        assert_eq!(broken(1, everything, Child::Node(0)), twice);
        let unreachable = broken(1, Aabb::EMPTY, child);
        assert!(
            matches!(unreachable, Err(BrokenTree::Unreachable { .. })),
            "{unreachable:?}"
        );
        let wrong = tree.validate(|slot| unit(order[slot] as usize + 1));
        assert!(
            matches!(wrong, Err(BrokenTree::Outside { .. })),
            "{wrong:?}"
        );
    }
}
