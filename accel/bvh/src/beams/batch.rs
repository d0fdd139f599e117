//! Blocks that a ray may come near, tested together.

use super::leaf::{Block, Grid, Leaf, Line};
use crate::meet::PACKED;
use crate::{LANES, LEAF};
use fearless_simd::Simd;

/// Blocks tested together: what one test waits for, others can use.
const BATCH: usize = 64;

/// Blocks whose lines the ray passes. Only these are tested for the pieces on them.
pub(super) struct Batch {
    waiting: [Waiting; BATCH + LEAF / LANES],
    waits: usize,
    /// What was found.
    slots: [u32; BATCH * LANES + LEAF],
}

/// A block, its pieces as far as they are there, and where it is.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    block: u32,
    lanes: u32,
    grid: Grid,
}

impl Batch {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let none = Waiting {
            block: 0,
            lanes: 0,
            grid: Grid::default(),
        };
        Self {
            waiting: [none; BATCH + LEAF / LANES],
            waits: 0,
            slots: [0; BATCH * LANES + LEAF],
        }
    }

    /// Whether there is no room for another leaf.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.waits >= BATCH
    }

    /// Adds those blocks of a leaf whose lines the ray passes.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn push<S: Simd>(&mut self, leaf: &Leaf, blocks: &[Block], line: &Line<S>) {
        let first = leaf.first as usize;
        let pieces = leaf.pieces as usize;
        let blocks = &blocks[first..first + pieces.div_ceil(LANES)];
        let mut grid = leaf.grid(line);
        for (index, block) in blocks.iter().enumerate() {
            grid.reach = leaf.reach(index);
            let lanes = 0xff >> LANES.saturating_sub(pieces - index * LANES);
            // Written in any case, counted where something is near: no branch to guess.
            self.waiting[self.waits] = Waiting {
                block: (first + index) as u32,
                lanes,
                grid,
            };
            self.waits += usize::from(block.lines_near(line, grid) & lanes != 0);
        }
    }

    /// The slots of all pieces that the ray comes near, of the blocks added since the last time.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn run<S: Simd>(&mut self, blocks: &[Block], line: &Line<S>) -> &[u32] {
        let mut met = 0;
        for &Waiting { block, lanes, grid } in &self.waiting[..self.waits] {
            let near = blocks[block as usize].near(line, grid) & lanes;
            let (lanes, count) = PACKED[near as usize % PACKED.len()];
            let first = block * LANES as u32;
            let slots = &mut self.slots[met..met + LANES];
            for (slot, lane) in slots.iter_mut().zip(lanes.to_le_bytes()) {
                *slot = first + u32::from(lane);
            }
            met += count;
        }
        self.waits = 0;
        &self.slots[..met]
    }
}
