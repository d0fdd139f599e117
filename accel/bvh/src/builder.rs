//! The builder: leaves of eight blocks of eight slots, nodes of eight children.

mod cost;
mod split;

use crate::node::{Child, Node};
use crate::{BuildError, LEAF};
pub(crate) use cost::area;
use rayon::prelude::*;
use split::{by_cost, evenly, into_blocks};
use tyndall_core::Aabb;

/// How much a tree should cost to build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Halves along the widest axis: for what is rebuilt every pass. Good where neighbours are of
    /// similar size.
    #[default]
    Fast,
    /// Binned surface area heuristic over the three axes and size: for structures that live, and
    /// for primitives of very different size.
    High,
}

/// A primitive while it is sorted.
#[derive(Clone, Copy)]
struct Item {
    /// Twice the centre, and the size: what primitives are split by. Sizes count, since one large
    /// primitive widens the box of all that share its leaf.
    key: [f32; 4],
    index: u32,
}

/// Items below which a task is not worth its start.
pub(crate) const TASK: usize = 8192;
/// Levels after which even `High` splits evenly, so that no tree is deeper than [`MAX_DEPTH`].
pub(crate) const LEVELS_BY_COST: usize = 20;
/// Evenly, 2³² slots are 8⁹ leaves and a little.
pub(crate) const MAX_DEPTH: usize = LEVELS_BY_COST + 10;

/// Nodes, the root first, and the primitive of each slot. Boxes are finite and hold something.
pub(crate) fn build(
    bounds: &[Aabb],
    quality: Quality,
) -> Result<(Vec<Node>, Vec<u32>), BuildError> {
    if bounds.len() > u32::MAX as usize {
        return Err(BuildError::TooMany {
            count: bounds.len(),
        });
    }
    let item = |(index, bounds): (usize, &Aabb)| {
        let [x, y, z] = (bounds.min + bounds.max).to_array();
        Item {
            key: [x, y, z, bounds.size().max_element()],
            index: index as u32,
        }
    };
    let mut items: Vec<_> = bounds.par_iter().enumerate().map(item).collect();
    let mut nodes = Vec::new();
    if !items.is_empty() {
        Builder { bounds, quality }.grow(&mut items, 0, 0, &mut nodes);
    }
    nodes.shrink_to_fit();
    let order = items.par_iter().map(|item| item.index).collect();
    Ok((nodes, order))
}

struct Builder<'a> {
    bounds: &'a [Aabb],
    quality: Quality,
}

impl Builder<'_> {
    /// Appends the subtree over `items`, the first of which is in slot `first`; returns its box.
    fn grow(&self, items: &mut [Item], first: usize, depth: usize, nodes: &mut Vec<Node>) -> Aabb {
        let parallel = items.len() > TASK;
        let parts = self.split(items, first, depth);
        let root = nodes.len();
        nodes.push(Node::EMPTY);
        let mut whole = Aabb::EMPTY;
        let mut adopt = |nodes: &mut Vec<Node>, lane, (bounds, child)| {
            nodes[root].set(lane, bounds, child);
            whole = whole.union(bounds);
        };
        if parallel {
            let grow = |(first, part): (usize, _)| {
                let mut below = Vec::new();
                (self.child(part, first, depth, 0, &mut below), below)
            };
            let grown: Vec<_> = parts.into_par_iter().map(grow).collect();
            for (lane, ((bounds, child), mut below)) in grown.into_iter().enumerate() {
                let child = child.moved(nodes.len() - root, 0);
                nodes.append(&mut below);
                adopt(nodes, lane, (bounds, child));
            }
        } else {
            for (lane, (first, part)) in parts.into_iter().enumerate() {
                let child = self.child(part, first, depth, root, nodes);
                adopt(nodes, lane, child);
            }
        }
        whole
    }

    /// The parts of a node, each with its first slot.
    fn split<'i>(
        &self,
        items: &'i mut [Item],
        first: usize,
        depth: usize,
    ) -> Vec<(usize, &'i mut [Item])> {
        let (ends, count) = match self.quality {
            Quality::High if depth < LEVELS_BY_COST => by_cost(items, self.bounds),
            _ => evenly(items),
        };
        let (mut rest, mut start) = (items, 0);
        let part = |&end: &usize| {
            let (part, behind) = std::mem::take(&mut rest).split_at_mut(end - start);
            let slot = first + start;
            (rest, start) = (behind, end);
            (slot, part)
        };
        ends[..count].iter().map(part).collect()
    }

    /// Makes a leaf, or appends a subtree; its box, and what it is to the node at `root`.
    fn child(
        &self,
        items: &mut [Item],
        first: usize,
        depth: usize,
        root: usize,
        nodes: &mut Vec<Node>,
    ) -> (Aabb, Child) {
        if items.len() <= LEAF {
            into_blocks(items);
            return (self.union(items), Child::Leaf((first / LEAF) as u32));
        }
        let offset = nodes.len() - root;
        let bounds = self.grow(items, first, depth + 1, nodes);
        (bounds, Child::Node(offset as u32))
    }

    fn union(&self, items: &[Item]) -> Aabb {
        items.iter().fold(Aabb::EMPTY, |all, item| {
            all.union(self.bounds[item.index as usize])
        })
    }
}
