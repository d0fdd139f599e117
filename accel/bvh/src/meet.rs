//! From leaves to primitives: what a ray meets in blocks of eight.

use crate::{Bvh, LANES, LEAF};
use tyndall_core::Ray;
use wide::f32x8;

/// Blocks tested together. Their loads overlap, and what they yield is visited in one loop whose
/// length branch prediction need not guess block by block.
const BATCH: usize = 32;

impl Bvh {
    /// Calls `visit(slot, values)` once for every primitive that the ray meets.
    ///
    /// `blocks[i]` holds the primitives of slots `8i` to `8i + 7`, in the order that
    /// [`Bvh::build`] gave. Of the leaf of slots `64i` to `64i + 63`, `screen(i)` gives a bit for
    /// each block that the ray may meet, block `8i` the lowest; `test` gives a bit for each
    /// primitive of a block that it does meet, and the values of the eight. Higher bits than the
    /// lowest eight are ignored.
    ///
    /// The last block may be padded: `test` must give no bit for what is in no slot, or `visit` is
    /// called with slots from [`Bvh::len`] on. The last leaf may have fewer than eight blocks:
    /// `screen` must give no bit for those absent.
    ///
    /// # Panics
    /// `screen` gave a bit for a block that is not in `blocks`.
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
        self.traverse(ray, |slots| {
            let leaf = slots.start / LEAF;
            batch.push(leaf, screen(leaf));
            if batch.waits > BATCH - LANES {
                batch.run(blocks, &test, &mut visit);
            }
        });
        batch.run(blocks, &test, &mut visit);
    }
}

struct Batch<const K: usize> {
    /// First blocks of the leaves met, and how many.
    leaves: [u32; BATCH],
    open: usize,
    /// Leaf and lane, of eight blocks each, of the blocks to test, and how many.
    waiting: [u8; BATCH],
    waits: usize,
    /// Blocks tested and what they gave.
    blocks: [u32; BATCH],
    values: [[f32; BATCH * LANES]; K],
    /// Block and lane, of eight values each, of the primitives met.
    met: [u8; BATCH * LANES],
}

impl<const K: usize> Batch<K> {
    fn new() -> Self {
        Self {
            leaves: [0; BATCH],
            open: 0,
            waiting: [0; BATCH],
            waits: 0,
            blocks: [0; BATCH],
            values: [[0.0; BATCH * LANES]; K],
            met: [0; BATCH * LANES],
        }
    }

    /// Adds the blocks of a leaf; there must be room for eight.
    #[inline]
    fn push(&mut self, leaf: usize, mask: u32) {
        let (lanes, count) = PACKED[mask as usize % PACKED.len()];
        self.leaves[self.open] = (leaf * LANES) as u32;
        self.waiting[self.waits..][..LANES]
            .copy_from_slice(&(lanes + self.open as u64 * ROW).to_le_bytes());
        self.open += usize::from(count > 0);
        self.waits += count;
    }

    /// Tests what waits and visits what is met.
    #[inline(always)] // or what `visit` sums would go through memory at every call
    fn run<B>(
        &mut self,
        blocks: &[B],
        test: &impl Fn(&B) -> (u32, [f32x8; K]),
        visit: &mut impl FnMut(usize, [f32; K]),
    ) {
        let mut met = 0;
        let waiting = self.waiting.iter().zip(&mut self.blocks);
        for (i, (&waiting, block)) in waiting.take(self.waits).enumerate() {
            let (leaf, lane) = (waiting as usize / LANES, u32::from(waiting) % LANES as u32);
            *block = self.leaves[leaf] + lane;
            let (mask, values) = test(&blocks[*block as usize]);
            for (all, of_block) in self.values.iter_mut().zip(values) {
                all[i * LANES..][..LANES].copy_from_slice(of_block.as_array());
            }
            let (lanes, count) = PACKED[mask as usize % PACKED.len()];
            self.met[met..][..LANES].copy_from_slice(&(lanes + i as u64 * ROW).to_le_bytes());
            met += count;
        }
        (self.open, self.waits) = (0, 0);
        for &met in &self.met[..met] {
            let met = met as usize;
            let slot = self.blocks[met / LANES] as usize * LANES + met % LANES;
            visit(slot, std::array::from_fn(|k| self.values[k][met]));
        }
    }
}

/// Eight times one, in every byte.
const ROW: u64 = u64::from_le_bytes([LANES as u8; 8]);

/// For every set of lanes: their numbers, a byte each from the lowest, and how many there are.
const PACKED: [(u64, usize); 256] = {
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
