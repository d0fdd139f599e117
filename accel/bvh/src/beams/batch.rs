//! Pieces that a ray may come near, tested together.

use super::leaf::{Eight, Leaf, Line, Slot};
use super::lines::Lines;
use crate::meet::PACKED;
use crate::{LANES, LEAF};
use fearless_simd::Simd;

/// Blocks that wait: what one test waits for, others can use.
const BATCH: usize = 64;
const BLOCKS: usize = BATCH + LEAF / LANES;

/// Pieces whose lines the ray passes. Only these are tested for where they start and end.
pub(super) struct Batch {
    /// Leaves, blocks, and a bit for each piece.
    waiting: [[u32; 3]; BLOCKS],
    waits: usize,
    /// The pieces of these: their leaves, and their slots. What is found takes the first places.
    leaves: [u32; BLOCKS * LANES],
    slots: [u32; BLOCKS * LANES],
}

/// What leaves are of.
#[derive(Clone, Copy)]
pub(super) struct Pieces<'a> {
    pub(super) leaves: &'a [Leaf],
    pub(super) slots: &'a [Slot],
    pub(super) lines: &'a [Lines],
}

impl Batch {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            waiting: [[0; 3]; BLOCKS],
            waits: 0,
            leaves: [0; BLOCKS * LANES],
            slots: [0; BLOCKS * LANES],
        }
    }

    /// Whether there is no room for another leaf.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.waits >= BATCH
    }

    /// Adds those pieces of a leaf whose lines the ray passes.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn push<S: Simd>(&mut self, pieces: Pieces<'_>, index: usize, line: &Line<S>) {
        let leaf = &pieces.leaves[index];
        let Some(seen) = leaf.ball.seen(line) else {
            return;
        };
        let reaches = seen.whole(&leaf.reach);
        let mut waits = self.waits;
        let blocks = leaf.blocks();
        let lines = pieces.lines[blocks.clone()].iter().zip(reaches);
        for (block, (lines, reach)) in blocks.zip(lines) {
            let near = seen.near(lines, reach);
            // Written in any case, counted where something is near: no branch to guess.
            self.waiting[waits] = [index as u32, block as u32, near];
            waits += usize::from(near != 0);
        }
        self.waits = waits;
    }

    /// The slots of all pieces that the ray comes near, of those added since the last time.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn run<S: Simd>(&mut self, pieces: Pieces<'_>, line: &Line<S>) -> &[u32] {
        let mut added = 0;
        for wait in 0..self.waits {
            let [leaf, block, near] = self.waiting[wait];
            self.leaves[added..added + LANES].fill(leaf);
            let near = near & pieces.leaves[leaf as usize].lanes(block as usize);
            added = self.append(added, near, |lane| block * LANES as u32 + lane);
        }
        self.waits = 0;
        let mut met = 0;
        for start in (0..added).step_by(LANES) {
            let mut eight = Eight::default();
            let mut slots = [0; LANES];
            for (lane, slot) in slots.iter_mut().enumerate() {
                let at = (start + lane).min(added - 1);
                *slot = self.slots[at];
                let (leaf, slot) = (self.leaves[at] as usize, *slot as usize);
                eight.set(
                    lane,
                    &pieces.leaves[leaf],
                    &pieces.slots[slot],
                    slot / LANES,
                );
            }
            let there = 0xff >> LANES.saturating_sub(added - start);
            met = self.append(met, eight.near(line) & there, |lane| slots[lane as usize]);
        }
        &self.slots[..met]
    }

    /// Writes the slots of some lanes one behind the other; where the next would be.
    #[inline(always)]
    fn append(&mut self, at: usize, lanes: u32, slot: impl Fn(u32) -> u32) -> usize {
        let (lanes, count) = PACKED[lanes as usize % PACKED.len()];
        let slots = &mut self.slots[at..at + LANES];
        for (next, lane) in slots.iter_mut().zip(lanes.to_le_bytes()) {
            *next = slot(u32::from(lane));
        }
        at + count
    }
}
