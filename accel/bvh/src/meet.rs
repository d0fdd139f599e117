//! From leaves to primitives: what a ray meets in blocks of eight.

use crate::{Bvh, LANES};
use fearless_simd::{Level, Simd, dispatch, f32x8};
use tyndall_core::Ray;

/// Blocks tested together, so that their loads overlap.
const BATCH: usize = 32;

/// What a ray asks the primitives in the slots of a [`Bvh`]. Block i holds those of slots `8i` to
/// `8i + 7`, leaf i blocks `8i` to `8i + 7`.
///
/// Both are called by the thousand, in code for the instructions that the machine has: make them
/// `#[inline(always)]`.
pub trait Query<const K: usize> {
    /// A bit for each block of a leaf that the ray may meet, the first the lowest. The last leaf
    /// may have fewer than eight blocks: there must be no bit for those absent.
    fn screen<S: Simd>(&self, simd: S, leaf: usize) -> u32;

    /// A bit for each primitive of a block that the ray does meet, and values of the eight. The
    /// last block may be padded: there must be no bit for what is in no slot.
    fn test<S: Simd>(&self, simd: S, block: usize) -> (u32, [f32x8<S>; K]);
}

/// What a ray meets in a block.
#[derive(Clone, Copy, Debug)]
pub struct Met<const K: usize> {
    /// The block: it holds slots `8 · block` to `8 · block + 7`.
    pub block: usize,
    /// A bit for each that is met, the first the lowest.
    pub lanes: u32,
    /// Values of all eight.
    pub values: [[f32; LANES]; K],
}

impl<const K: usize> Met<K> {
    /// Slot and values of each that is met.
    #[inline]
    pub fn each(&self) -> impl Iterator<Item = (usize, [f32; K])> {
        let mut lanes = self.lanes;
        std::iter::from_fn(move || {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes.wrapping_sub(1);
            (lane < LANES).then(|| (self.block * LANES + lane, self.values.map(|v| v[lane])))
        })
    }
}

impl Bvh {
    /// Calls `visit` once for every block with primitives that the ray meets.
    #[inline]
    pub fn meet<const K: usize>(
        &self,
        ray: &Ray,
        query: &impl Query<K>,
        mut visit: impl FnMut(Met<K>),
    ) {
        dispatch!(Level::new(), simd => self.meet_with(simd, ray, query, &mut visit));
    }

    #[inline(always)]
    fn meet_with<S: Simd, const K: usize>(
        &self,
        simd: S,
        ray: &Ray,
        query: &impl Query<K>,
        visit: &mut impl FnMut(Met<K>),
    ) {
        let mut waiting = [0; BATCH];
        let mut waits = 0;
        self.leaves(
            simd,
            ray,
            #[inline(always)]
            |leaf| {
                let mask = query.screen(simd, leaf as usize);
                let (lanes, count) = PACKED[mask as usize % PACKED.len()];
                let first = leaf * LANES as u32;
                let blocks = lanes.to_le_bytes().map(|lane| first + u32::from(lane));
                waiting[waits..][..LANES].copy_from_slice(&blocks);
                waits += count;
                if waits > BATCH - LANES {
                    test(simd, query, &waiting[..waits], visit);
                    waits = 0;
                }
            },
        );
        test(simd, query, &waiting[..waits], visit);
    }
}

/// Tests blocks and visits what is met.
#[inline(always)]
fn test<S: Simd, const K: usize>(
    simd: S,
    query: &impl Query<K>,
    blocks: &[u32],
    visit: &mut impl FnMut(Met<K>),
) {
    for &block in blocks {
        let block = block as usize;
        let (lanes, found) = query.test(simd, block);
        if lanes != 0 {
            let mut values = [[0.0; LANES]; K];
            for (values, found) in values.iter_mut().zip(&found) {
                *values = **found;
            }
            visit(Met {
                block,
                lanes,
                values,
            });
        }
    }
}

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
