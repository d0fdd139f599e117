//! From leaves to primitives: what a ray meets in blocks of eight.

use crate::{Bvh, LANES, LEAF};
use tyndall_core::Ray;
use wide::f32x8;

/// Blocks tested together. Their loads overlap, and what they yield is visited in one loop whose
/// length branch prediction need not guess block by block.
const BATCH: usize = 32;

impl Bvh {
    /// Calls `visit(slot, values)` once for every primitive that the ray meets. `blocks[i]` holds
    /// the primitives of slots `8i` to `8i + 7`. Of the leaf of slots `64i` to `64i + 63`,
    /// `screen(i)` gives a bit for each block that the ray may meet; `test` gives a bit for each
    /// primitive of a block that it does meet, and the values of the eight.
    #[inline]
    pub fn meet<B, const K: usize>(
        &self,
        ray: &Ray,
        blocks: &[B],
        screen: impl Fn(usize) -> u32,
        test: impl Fn(&B) -> (u32, [f32x8; K]),
        mut visit: impl FnMut(usize, [f32; K]),
    ) {
        let mut batch = Batch::new();
        let mut waiting = [0u32; BATCH + LANES];
        let mut count = 0;
        self.traverse(ray, |slots| {
            let leaf = slots.start / LEAF;
            let (lanes, met) = PACKED[screen(leaf) as usize & 0xff];
            let first = (leaf * LANES) as u32;
            let into = &mut waiting[count..count + LANES];
            for (block, lane) in into.iter_mut().zip(lanes.to_le_bytes()) {
                *block = first + u32::from(lane);
            }
            count += met as usize;
            if count > BATCH - LANES {
                batch.run(&waiting[..count], blocks, &test, &mut visit);
                count = 0;
            }
        });
        batch.run(&waiting[..count], blocks, &test, &mut visit);
    }
}

struct Batch<const K: usize> {
    values: [[f32; BATCH * LANES]; K],
    /// Which of the values are those of primitives met.
    met: [u8; BATCH * LANES + LANES],
}

impl<const K: usize> Batch<K> {
    fn new() -> Self {
        Self {
            values: [[0.0; BATCH * LANES]; K],
            met: [0; BATCH * LANES + LANES],
        }
    }

    #[inline]
    fn run<B>(
        &mut self,
        waiting: &[u32],
        blocks: &[B],
        test: &impl Fn(&B) -> (u32, [f32x8; K]),
        visit: &mut impl FnMut(usize, [f32; K]),
    ) {
        let mut count = 0;
        for (i, &block) in waiting.iter().enumerate() {
            let (mask, values) = test(&blocks[block as usize]);
            for (all, of_block) in self.values.iter_mut().zip(values) {
                all[i * LANES..][..LANES].copy_from_slice(of_block.as_array());
            }
            let (lanes, met) = PACKED[mask as usize & 0xff];
            let lanes = lanes + i as u64 * (LANES as u64 * 0x0101_0101_0101_0101);
            self.met[count..][..LANES].copy_from_slice(&lanes.to_le_bytes());
            count += met as usize;
        }
        for &met in &self.met[..count] {
            let met = met as usize;
            let slot = waiting[met / LANES] as usize * LANES + met % LANES;
            visit(slot, std::array::from_fn(|k| self.values[k][met]));
        }
    }
}

/// For every set of lanes: their numbers, a byte each from the lowest, and how many there are.
const PACKED: [(u64, u64); 256] = {
    let mut packed = [(0, 0); 256];
    let mut mask = 0;
    while mask < 256 {
        let mut lane = 0;
        while lane < LANES {
            if mask >> lane & 1 == 1 {
                packed[mask].0 |= (lane as u64) << (8 * packed[mask].1);
                packed[mask].1 += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    packed
};
