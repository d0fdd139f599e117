//! Values of primitives, in blocks as they are.

use crate::LANES;
use std::marker::PhantomData;
use tyndall_core::Spectrum;
use wide::f32x8;

/// A spectrum for each slot, channel by channel: what is summed over the blocks of a ray.
///
/// ```
/// use tyndall_bvh::Values;
/// let values = Values::new((0..20).map(|slot| slot as f32));
/// let mut weights = [[0.0; 8]; 2];
/// (weights[0][1], weights[1][3]) = (0.5, 2.0); // slots 1 and 19
/// assert_eq!(values.sum(0, &[0, 2], &weights), 0.5 + 38.0);
/// ```
#[derive(Clone, Debug)]
pub struct Values<S> {
    /// The channels of a block follow each other.
    channels: Vec<f32x8>,
    spectrum: PhantomData<S>,
}

impl<S: Spectrum> Values<S> {
    /// In the order of the slots.
    pub fn new(slots: impl ExactSizeIterator<Item = S>) -> Self {
        let blocks = slots.len().div_ceil(LANES);
        let mut channels = vec![f32x8::ZERO; blocks * S::CHANNELS];
        for (slot, value) in slots.enumerate() {
            let block = &mut channels[slot / LANES * S::CHANNELS..][..S::CHANNELS];
            for (c, lanes) in block.iter_mut().enumerate() {
                lanes.as_mut_array()[slot % LANES] = value.channel(c);
            }
        }
        Self {
            channels,
            spectrum: PhantomData,
        }
    }

    /// Sum of a channel over some blocks, each slot of theirs times its weight; the same to the bit
    /// on any machine.
    ///
    /// # Panics
    /// There is no such block.
    #[inline]
    pub fn sum(&self, channel: usize, blocks: &[u32], weights: &[[f32; LANES]]) -> f32 {
        let mut sum = f32x8::ZERO;
        for (&block, &weights) in blocks.iter().zip(weights) {
            sum += self.channels[block as usize * S::CHANNELS + channel] * f32x8::new(weights);
        }
        sum.to_array().iter().sum()
    }

    /// Bytes of the values.
    pub fn bytes(&self) -> usize {
        size_of_val(self.channels.as_slice())
    }
}
