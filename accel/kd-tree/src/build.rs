//! How the tree is built.

use crate::tree::{LEAF, Node, Tree, leaf_start, levels};
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::Aabb;

/// Fewer photons are not worth another thread.
const SEQUENTIAL: usize = 4096;

/// A position with its index in the list that was given.
#[derive(Clone, Copy)]
struct Item {
    position: [f32; 3],
    index: u32,
}

impl Tree {
    /// The tree of these positions, and the index of each in the order of slots.
    pub(crate) fn build(len: usize, position: impl Fn(usize) -> Vec3 + Sync) -> (Self, Vec<u32>) {
        let mut items: Vec<Item> = (0..len)
            .into_par_iter()
            .map(|i| Item {
                position: position(i).to_array(),
                index: i as u32,
            })
            .collect();
        let levels = levels(len);
        let mut nodes = vec![Node::default(); (1 << levels) - 1];
        let bounds = bounds_of(&items);
        let splitter = Splitter { len, levels };
        splitter.split(&mut items, &mut nodes, 0, bounds);
        let coordinates = [0, 1, 2].map(|axis| {
            let mut all = Vec::with_capacity(len + LEAF);
            all.par_extend(items.par_iter().map(|item| item.position[axis]));
            all.resize(len + LEAF, 0.0);
            all
        });
        let tree = Self {
            len,
            levels,
            bounds,
            nodes,
            coordinates,
        };
        (tree, items.par_iter().map(|item| item.index).collect())
    }
}

struct Splitter {
    len: usize,
    levels: u32,
}

impl Splitter {
    /// Divides the items of the leaves from `leaf` on, one more than `nodes`, at the median of
    /// the widest axis of their bounds.
    fn split(&self, items: &mut [Item], nodes: &mut [Node], leaf: usize, bounds: Aabb) {
        let half = nodes.len().div_ceil(2);
        let Some((node, below)) = nodes.split_first_mut() else {
            return;
        };
        let start = |leaf| leaf_start(self.len, self.levels, leaf);
        let middle = start(leaf + half) - start(leaf);
        let axis = bounds.size().max_position();
        items.select_nth_unstable_by(middle, |a, b| a.position[axis].total_cmp(&b.position[axis]));
        let (lower, upper) = items.split_at_mut(middle);
        let [lower_bounds, upper_bounds] = [bounds_of(lower), bounds_of(upper)];
        *node = Node {
            lower_max: lower_bounds.max[axis],
            upper_min: upper_bounds.min[axis],
            axis: axis as u32,
        };
        let (lower_nodes, upper_nodes) = below.split_at_mut(half - 1);
        let parallel = lower.len() >= SEQUENTIAL;
        let mut lower = || self.split(lower, lower_nodes, leaf, lower_bounds);
        let mut upper = || self.split(upper, upper_nodes, leaf + half, upper_bounds);
        if parallel {
            rayon::join(lower, upper);
        } else {
            lower();
            upper();
        }
    }
}

fn bounds_of(items: &[Item]) -> Aabb {
    Aabb::of_points(items.iter().map(|item| Vec3::from_array(item.position)))
}
