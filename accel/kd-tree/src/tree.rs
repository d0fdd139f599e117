//! The balanced tree over positions.

use glam::Vec3;
use std::ops::Range;
use tyndall_core::Aabb;

/// Most photons of a leaf.
pub(crate) const LEAF: usize = 16;

/// Where a range of photons is divided in two halves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Node {
    /// Largest coordinate of the lower half.
    pub(crate) lower_max: f32,
    /// Smallest coordinate of the upper half.
    pub(crate) upper_min: f32,
    /// The coordinate's axis, below 3.
    pub(crate) axis: u32,
}

/// Positions in the order of the leaves of a balanced kd-tree.
///
/// There are 2^levels leaves of equal size, give or take one photon: leaf j holds the slots from
/// ⌊j n / 2^levels⌋. Nodes lie in depth-first order, so that neither leaves nor nodes need
/// pointers: of a node i over 2h leaves the children are i + 1 and i + h.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) len: usize,
    pub(crate) levels: u32,
    pub(crate) bounds: Aabb,
    pub(crate) nodes: Vec<Node>,
    /// Coordinates, with [`LEAF`] more at the end so that every leaf can be read as a full one.
    pub(crate) coordinates: [Vec<f32>; 3],
}

impl Default for Tree {
    fn default() -> Self {
        Self {
            len: 0,
            levels: 0,
            bounds: Aabb::EMPTY,
            nodes: Vec::new(),
            coordinates: [(); 3].map(|()| vec![0.0; LEAF]),
        }
    }
}

/// The fewest levels that leave no more than [`LEAF`] photons a leaf.
pub(crate) fn levels(len: usize) -> u32 {
    len.div_ceil(LEAF).max(1).next_power_of_two().ilog2()
}

impl Tree {
    /// First slot of a leaf; `len` for the one after the last.
    #[inline]
    pub(crate) fn leaf_start(&self, leaf: usize) -> usize {
        leaf_start(self.len, self.levels, leaf)
    }

    /// Slots of `span` leaves.
    #[inline]
    pub(crate) fn slots(&self, leaf: usize, span: usize) -> Range<usize> {
        self.leaf_start(leaf)..self.leaf_start(leaf + span)
    }

    #[inline]
    pub(crate) fn position(&self, slot: usize) -> Vec3 {
        assert!(slot < self.len, "slot {slot} of {} photons", self.len);
        Vec3::from_array([0, 1, 2].map(|axis| self.coordinates[axis][slot]))
    }

    /// Visits leaves that may hold photons whose squared distance from `center` is below `limit`,
    /// the nearer child first. `visit` takes the first slot, the number of photons and their
    /// squared distances, and returns a new limit.
    pub(crate) fn visit_leaves(
        &self,
        center: Vec3,
        limit: f32,
        visit: impl FnMut(usize, &[f32]) -> f32,
    ) {
        let outside = (self.bounds.min - center).max(center - self.bounds.max);
        let offset = outside.max(Vec3::ZERO).to_array();
        let mut search = Search {
            tree: self,
            center: center.to_array(),
            limit,
            visit,
        };
        if square(offset) < limit {
            search.descend(0, 0, 1 << self.levels, offset);
        }
    }
}

/// ⌊leaf · len / 2^levels⌋.
#[inline]
pub(crate) fn leaf_start(len: usize, levels: u32, leaf: usize) -> usize {
    ((leaf as u64 * len as u64) >> levels) as usize
}

/// The one way in which squares are summed: differences, squares and sums of floating-point
/// numbers are monotonic, so that the distance of a box is never above that of a photon in it.
#[inline]
fn square([x, y, z]: [f32; 3]) -> f32 {
    x * x + y * y + z * z
}

struct Search<'t, F> {
    tree: &'t Tree,
    center: [f32; 3],
    limit: f32,
    visit: F,
}

impl<F: FnMut(usize, &[f32]) -> f32> Search<'_, F> {
    /// Searches the subtree of `node` over `span` leaves; `offset` is how far its box is from the
    /// centre along each axis (Arya & Mount 1993, "Algorithms for fast vector quantization").
    fn descend(&mut self, mut node: usize, mut leaf: usize, mut span: usize, mut offset: [f32; 3]) {
        while span > 1 {
            let half = span / 2;
            let Node {
                lower_max,
                upper_min,
                axis,
            } = self.tree.nodes[node];
            let axis = axis as usize;
            let to_lower = self.center[axis] - lower_max;
            let to_upper = upper_min - self.center[axis];
            let [mut lower, mut upper] = [offset; 2];
            lower[axis] = lower[axis].max(to_lower);
            upper[axis] = upper[axis].max(to_upper);
            let lower = (node + 1, leaf, lower);
            let upper = (node + half, leaf + half, upper);
            let (near, far) = if to_lower < to_upper {
                (lower, upper)
            } else {
                (upper, lower)
            };
            if square(near.2) < self.limit {
                self.descend(near.0, near.1, half, near.2);
            }
            (node, leaf, offset) = far;
            span = half;
            let reached = square(offset) < self.limit;
            if !reached {
                return;
            }
        }
        self.scan(leaf);
    }

    /// Visits one leaf.
    fn scan(&mut self, leaf: usize) {
        let slots = self.tree.slots(leaf, 1);
        let mut distances = [0.0; LEAF];
        let [x, y, z] = &self.tree.coordinates;
        let full = slots.start..slots.start + LEAF;
        let (x, y, z) = (&x[full.clone()], &y[full.clone()], &z[full]);
        for i in 0..LEAF {
            distances[i] = square([
                x[i] - self.center[0],
                y[i] - self.center[1],
                z[i] - self.center[2],
            ]);
        }
        self.limit = (self.visit)(slots.start, &distances[..slots.len()]);
    }
}
