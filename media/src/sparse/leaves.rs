//! The voxels of leaves.

use crate::field::Range;
use half::f16;
use tyndall_core::Spectrum;

/// Voxels in a leaf.
pub(super) const VOXELS: usize = 512;

/// How voxels are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 4 bytes a channel.
    #[default]
    Single,
    /// 2 bytes a channel: 11 bits of mantissa, values to 65504.
    Half,
}

#[derive(Clone, Debug)]
enum Values<T> {
    Single(Vec<T>),
    /// Channel by channel within a voxel.
    Half(Vec<f16>),
}

/// Leaves of 8³ voxels, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Leaves<T> {
    values: Values<T>,
    active: Vec<[u64; 8]>,
    ranges: Vec<Range<T>>,
}

impl<T: Spectrum> Leaves<T> {
    pub(super) fn new(precision: Precision) -> Self {
        Self {
            values: match precision {
                Precision::Single => Values::Single(Vec::new()),
                Precision::Half => Values::Half(Vec::new()),
            },
            active: Vec::new(),
            ranges: Vec::new(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.active.len()
    }

    pub(super) fn precision(&self) -> Precision {
        match self.values {
            Values::Single(_) => Precision::Single,
            Values::Half(_) => Precision::Half,
        }
    }

    /// Adds a leaf; its values are those that are read back.
    pub(super) fn push(&mut self, values: &[T; VOXELS], active: [u64; 8]) {
        match &mut self.values {
            Values::Single(all) => all.extend_from_slice(values),
            Values::Half(all) => all.extend(
                values
                    .iter()
                    .flat_map(|value| (0..T::CHANNELS).map(|c| f16::from_f32(value.channel(c)))),
            ),
        }
        self.active.push(active);
    }

    pub(super) fn set_ranges(&mut self) {
        let range = |leaf| (0..VOXELS).map(|slot| self.value(leaf, slot)).collect();
        self.ranges = (0..self.len() as u32).map(range).collect();
    }

    /// Takes the leaves in this order.
    pub(super) fn reorder(&mut self, order: &[u32]) {
        fn blocks<V: Copy>(values: &[V], order: &[u32], size: usize) -> Vec<V> {
            let block = |&i: &u32| &values[i as usize * size..][..size];
            order.iter().flat_map(block).copied().collect()
        }
        match &mut self.values {
            Values::Single(all) => *all = blocks(all, order, VOXELS),
            Values::Half(all) => *all = blocks(all, order, VOXELS * T::CHANNELS),
        }
        self.active = blocks(&self.active, order, 1);
    }

    #[inline]
    pub(super) fn value(&self, leaf: u32, slot: usize) -> T {
        let i = leaf as usize * VOXELS + slot;
        match &self.values {
            Values::Single(all) => all[i],
            Values::Half(all) => T::from_channels(|c| all[i * T::CHANNELS + c].to_f32()),
        }
    }

    /// Overwrites a voxel and makes it active.
    pub(super) fn set(&mut self, leaf: u32, slot: usize, value: T) {
        let i = leaf as usize * VOXELS + slot;
        match &mut self.values {
            Values::Single(all) => all[i] = value,
            Values::Half(all) => {
                for c in 0..T::CHANNELS {
                    all[i * T::CHANNELS + c] = f16::from_f32(value.channel(c));
                }
            }
        }
        self.active[leaf as usize][slot / 64] |= 1 << (slot % 64);
    }

    pub(super) fn active(&self, leaf: u32) -> &[u64; 8] {
        &self.active[leaf as usize]
    }

    pub(super) fn range(&self, leaf: u32) -> Range<T> {
        self.ranges[leaf as usize]
    }

    pub(super) fn bytes(&self) -> usize {
        let values = match &self.values {
            Values::Single(all) => size_of_val::<[T]>(all),
            Values::Half(all) => size_of_val::<[f16]>(all),
        };
        values + size_of_val::<[[u64; 8]]>(&self.active) + size_of_val::<[Range<T>]>(&self.ranges)
    }
}
