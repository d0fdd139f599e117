//! Nodes from the root to the leaves. What is in a leaf, its owner knows.

use crate::builder::MAX_DEPTH;
use crate::node::{Child, Node, Slabs};
use crate::{BrokenTree, LANES};
use tyndall_core::{Aabb, Ray};

/// What waits on the way down: seven siblings a level, and the root.
const STACK: usize = (LANES - 1) * MAX_DEPTH + 1;

/// Nodes, the root first.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
}

impl Tree {
    /// Calls `visit` with every leaf whose box the ray meets in `[0, t_max]`, once each and in no
    /// particular order.
    #[inline(always)] // into code for the level of the machine
    pub(crate) fn traverse(&self, ray: &Ray, mut visit: impl FnMut(usize)) {
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
                    Child::Leaf(leaf) => visit(leaf as usize),
                }
            }
        }
    }

    /// Bytes of the nodes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Whether every node and every one of so many leaves is met once and lies in the box above
    /// it.
    pub(crate) fn validate(
        &self,
        leaves: usize,
        bounds: impl Fn(usize) -> Aabb,
    ) -> Result<(), BrokenTree> {
        let mut nodes = vec![false; self.nodes.len()];
        let mut leaves = vec![false; leaves];
        if let Some(root) = nodes.first_mut() {
            *root = true;
        }
        for (index, node) in self.nodes.iter().enumerate() {
            let lanes = (0..LANES).map(|lane| (lane, node.bounds(lane), node.child(lane)));
            for (lane, above, child) in lanes.filter(|(_, above, _)| !above.is_empty()) {
                let (met, below) = match child {
                    Child::Node(offset) => {
                        let behind = index + offset as usize;
                        let below = self.nodes.get(behind).filter(|_| offset > 0);
                        let met = nodes.get_mut(behind);
                        (met, below.map_or(Aabb::EMPTY, Node::whole))
                    }
                    Child::Leaf(leaf) => {
                        let leaf = leaf as usize;
                        let exists = leaf < leaves.len();
                        let below = if exists { bounds(leaf) } else { Aabb::EMPTY };
                        (leaves.get_mut(leaf), below)
                    }
                };
                match met {
                    Some(met) if !*met => *met = true,
                    _ => return Err(BrokenTree::Child { node: index, lane }),
                }
                if below.is_empty() || above.union(below) != above {
                    return Err(BrokenTree::Outside { node: index, lane });
                }
            }
        }
        match nodes.iter().chain(&leaves).filter(|met| !**met).count() {
            0 => Ok(()),
            count => Err(BrokenTree::Unreachable { count }),
        }
    }
}
