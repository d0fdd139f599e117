//! From leaves to primitives: what a ray meets in blocks of eight.

use crate::{Bvh, LANES, LEAF};
use tyndall_core::Ray;
use wide::f32x8;

/// Blocks tested together. Their loads overlap, and what they yield is visited in one loop whose
/// length branch prediction need not guess block by block.
const BATCH: usize = 32;

/// What a ray meets in some blocks, each of them with one primitive at least that it does meet.
#[derive(Clone, Copy, Debug)]
pub struct Met<'a, const K: usize> {
    /// Block i holds slots `8i` to `8i + 7`.
    pub blocks: &'a [u32],
    /// A bit for each primitive of a block that is met, the first the lowest.
    pub lanes: &'a [u8],
    /// Values of all eight.
    pub values: [&'a [[f32; LANES]]; K],
}

impl<const K: usize> Met<'_, K> {
    /// Calls `visit` with the slot and the values of each that is met.
    #[inline(always)] // or what `visit` sums would go through memory at every call
    pub fn each(&self, mut visit: impl FnMut(usize, [f32; K])) {
        // Block and lane, of eight each: one loop over them all.
        let mut met = [0; BATCH * LANES];
        let mut count = 0;
        for (block, &lanes) in self.lanes.iter().enumerate() {
            let (lanes, more) = PACKED[lanes as usize];
            let lanes = lanes + block as u64 * ROW;
            met[count..][..LANES].copy_from_slice(&lanes.to_le_bytes());
            count += more;
        }
        for &met in &met[..count] {
            let (block, lane) = (met as usize / LANES, met as usize % LANES);
            let slot = self.blocks[block] as usize * LANES + lane;
            visit(slot, self.values.map(|values| values[block][lane]));
        }
    }
}

impl Bvh {
    /// Calls `visit` with all blocks of primitives that the ray meets, some at a time, each block
    /// once.
    ///
    /// Block i holds the primitives of slots `8i` to `8i + 7`, in the order that [`Bvh::build`]
    /// gave, and leaf i blocks `8i` to `8i + 7`. `screen` gives a bit for each block of a leaf that
    /// the ray may meet, the first the lowest; `test` gives a bit for each primitive of a block
    /// that it does meet, and values of the eight. Higher bits than the lowest eight are ignored.
    ///
    /// The last block may be padded, the last leaf have fewer than eight blocks: there must be no
    /// bit for what is in no slot, and for blocks that are absent.
    #[inline]
    pub fn meet<const K: usize>(
        &self,
        ray: &Ray,
        screen: impl Fn(usize) -> u32,
        test: impl Fn(usize) -> (u32, [f32x8; K]),
        mut visit: impl FnMut(&Met<'_, K>),
    ) {
        let mut batch = Batch::new();
        self.traverse(ray, |slots| {
            let leaf = slots.start / LEAF;
            batch.push(leaf, screen(leaf));
            if batch.waits > BATCH - LANES {
                batch.run(&test, &mut visit);
            }
        });
        batch.run(&test, &mut visit);
    }
}

struct Batch<const K: usize> {
    /// Blocks to test, and how many.
    waiting: [u32; BATCH],
    waits: usize,
    /// Blocks tested and what they gave.
    blocks: [u32; BATCH],
    lanes: [u8; BATCH],
    values: [[[f32; LANES]; BATCH]; K],
}

impl<const K: usize> Batch<K> {
    fn new() -> Self {
        Self {
            waiting: [0; BATCH],
            waits: 0,
            blocks: [0; BATCH],
            lanes: [0; BATCH],
            values: [[[0.0; LANES]; BATCH]; K],
        }
    }

    /// Adds the blocks of a leaf; there must be room for eight.
    #[inline]
    fn push(&mut self, leaf: usize, mask: u32) {
        let (lanes, count) = PACKED[mask as usize % PACKED.len()];
        let first = (leaf * LANES) as u32;
        let blocks = lanes.to_le_bytes().map(|lane| first + u32::from(lane));
        self.waiting[self.waits..][..LANES].copy_from_slice(&blocks);
        self.waits += count;
    }

    /// Tests what waits and visits what is met.
    #[inline(always)] // or what `visit` sums would go through memory at every call
    fn run(
        &mut self,
        test: &impl Fn(usize) -> (u32, [f32x8; K]),
        visit: &mut impl FnMut(&Met<'_, K>),
    ) {
        let mut met = 0;
        for &block in &self.waiting[..self.waits] {
            let (lanes, values) = test(block as usize);
            // Written in any case, counted where something is met: no branch to guess.
            self.blocks[met] = block;
            self.lanes[met] = lanes as u8;
            for (all, of_block) in self.values.iter_mut().zip(values) {
                all[met] = of_block.to_array();
            }
            met += usize::from(lanes as u8 != 0);
        }
        self.waits = 0;
        if met > 0 {
            visit(&Met {
                blocks: &self.blocks[..met],
                lanes: &self.lanes[..met],
                values: self.values.each_ref().map(|values| &values[..met]),
            });
        }
    }
}

/// Eight times one, in every byte.
const ROW: u64 = u64::from_le_bytes([LANES as u8; 8]);

/// For every set of lanes: their numbers, a byte each from the lowest, and how many there are.
pub(crate) const PACKED: [(u64, usize); 256] = {
    let mut packed = [(0, 0); 256];
    let mut mask = 0;
    while mask < 256 {
        let mut lane = 0;
        while lane < LANES {
            if mask >> lane & 1 == 1 {
                packed[mask].0 |= (lane as u64) << (8 * packed[mask].1 as u32);
                packed[mask].1 += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    packed
};
