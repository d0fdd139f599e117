//! The balanced tree over positions.

use glam::{Vec3, Vec3A, Vec4};
use tyndall_core::Aabb;

/// Photons of a block.
pub(crate) const LANES: usize = 4;
/// Most blocks of a leaf.
const LEAF: usize = 4;

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

/// The positions of four photons; NaN where there is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) x: Vec4,
    pub(crate) y: Vec4,
    pub(crate) z: Vec4,
}

/// How blocks are shared out among the leaves of a balanced tree.
///
/// There are 2^levels leaves of equal size, give or take one block: leaf j holds the blocks from
/// ⌊j · blocks / 2^levels⌋ on. Nodes lie in depth-first order, so that neither leaves nor nodes
/// need pointers: of a node i over 2h leaves the children are i + 1 and i + h.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Layout {
    blocks: usize,
    levels: u32,
}

impl Layout {
    /// That of `len` photons.
    pub(crate) fn new(len: usize) -> Self {
        let blocks = len.div_ceil(LANES);
        let leaves = blocks.div_ceil(LEAF).max(1).next_power_of_two();
        Self {
            blocks,
            levels: leaves.ilog2(),
        }
    }

    #[inline]
    pub(crate) fn leaves(self) -> usize {
        1 << self.levels
    }

    /// First block of a leaf; for the one after the last, the number of blocks.
    #[inline]
    pub(crate) fn start(self, leaf: usize) -> usize {
        ((leaf as u64 * self.blocks as u64) >> self.levels) as usize
    }
}

/// Positions in the order of the leaves of a balanced kd-tree.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) len: usize,
    pub(crate) layout: Layout,
    pub(crate) bounds: Aabb,
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<Block>,
}

impl Default for Tree {
    fn default() -> Self {
        Self {
            len: 0,
            layout: Layout::default(),
            bounds: Aabb::EMPTY,
            nodes: Vec::new(),
            blocks: Vec::new(),
        }
    }
}

impl Tree {
    #[inline]
    pub(crate) fn position(&self, slot: usize) -> Vec3 {
        assert!(slot < self.len, "slot {slot} of {} photons", self.len);
        self.lanes(slot)
    }

    /// The position at a slot that may lie beyond the last.
    #[inline]
    pub(crate) fn lanes(&self, slot: usize) -> Vec3 {
        let (block, lane) = (&self.blocks[slot / LANES], slot % LANES);
        Vec3::new(block.x[lane], block.y[lane], block.z[lane])
    }

    /// Visits photons whose squared distance from `center` is below `limit`, nearer leaves first.
    /// `visit` takes the slot and the squared distance of a photon, and returns a new limit.
    #[inline]
    pub(crate) fn visit(&self, center: Vec3, limit: f32, visit: impl FnMut(usize, f32) -> f32) {
        let outside = (self.bounds.min - center).max(center - self.bounds.max);
        let offset = Vec3A::from(outside.max(Vec3::ZERO));
        let mut search = Search {
            tree: self,
            center: center.to_array(),
            limit,
            visit,
        };
        if center.is_finite() && square(offset) < limit {
            search.descend(0, 0, self.layout.leaves(), offset);
        }
    }
}

/// The square of a length. Differences, squares and sums of floating-point numbers are monotonic:
/// as long as the sum is taken in one order, the distance of a box is never above that of a
/// photon in it.
#[inline]
fn square(offset: Vec3A) -> f32 {
    let [x, y, z] = (offset * offset).to_array();
    x + y + z
}

struct Search<'t, F> {
    tree: &'t Tree,
    center: [f32; 3],
    limit: f32,
    visit: F,
}

impl<F: FnMut(usize, f32) -> f32> Search<'_, F> {
    /// Searches the subtree of `node` over `span` leaves; `offset` is how far its box is from the
    /// centre along each axis (Arya & Mount 1993, "Algorithms for fast vector quantization").
    fn descend(&mut self, mut node: usize, mut leaf: usize, mut span: usize, mut offset: Vec3A) {
        while span > 1 {
            let half = span / 2;
            let split = self.tree.nodes[node];
            let axis = split.axis as usize;
            let to_lower = self.center[axis] - split.lower_max;
            let to_upper = split.upper_min - self.center[axis];
            let lower = (node + 1, leaf, offset.max(to_lower * Vec3A::AXES[axis]));
            let upper = (
                node + half,
                leaf + half,
                offset.max(to_upper * Vec3A::AXES[axis]),
            );
            let (near, far) = if to_lower < to_upper {
                (lower, upper)
            } else {
                (upper, lower)
            };
            if square(near.2) < self.limit {
                self.descend(near.0, near.1, half, near.2);
            }
            let reached = square(far.2) < self.limit;
            if !reached {
                return;
            }
            (node, leaf, offset) = far;
            span = half;
        }
        self.scan(leaf);
    }

    /// Visits one leaf.
    #[inline]
    fn scan(&mut self, leaf: usize) {
        let [x, y, z] = self.center.map(Vec4::splat);
        let limit = Vec4::splat(self.limit);
        let layout = self.tree.layout;
        let start = layout.start(leaf);
        let mut distances = [[0.0; LANES]; LEAF];
        let mut near = 0;
        let blocks = &self.tree.blocks[start..layout.start(leaf + 1)];
        for (i, (block, distances)) in blocks.iter().zip(&mut distances).enumerate() {
            let (dx, dy, dz) = (block.x - x, block.y - y, block.z - z);
            let squares = dx * dx + dy * dy + dz * dz;
            near |= squares.cmplt(limit).bitmask() << (LANES * i);
            *distances = squares.to_array();
        }
        while near != 0 {
            let i = near.trailing_zeros() as usize;
            let distance_squared = distances.as_flattened()[i];
            self.limit = (self.visit)(LANES * start + i, distance_squared);
            near &= near - 1;
        }
    }
}
