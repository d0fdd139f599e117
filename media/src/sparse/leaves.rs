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
    /// 2 bytes a channel: 11 bits of mantissa, rounded to multiples of 6e-8 below 6e-5 and to 0 below
    /// 3e-8. The background is rounded too, tiles are not. Halves end at 65504: a grid with a
    /// finite voxel or background beyond is kept in [`Precision::Single`], as a whole.
    Half,
}

#[derive(Clone, Debug)]
enum Values<T> {
    Single(Vec<T>),
    /// Channel by channel within a voxel.
    Half(Vec<f16>),
}

/// Whether halves do not make it infinite.
fn fits<T: Spectrum>(value: T) -> bool {
    (0..T::CHANNELS).all(|c| {
        let x = value.channel(c);
        !x.is_finite() || f16::from_f32(x).is_finite()
    })
}

fn halves<T: Spectrum>(value: T) -> impl Iterator<Item = f16> {
    (0..T::CHANNELS).map(move |c| f16::from_f32(value.channel(c)))
}

/// Leaves of 8³ voxels, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Leaves<T> {
    values: Values<T>,
    active: Vec<[u64; 8]>,
    ranges: Vec<Range<T>>,
}

/// None, in single precision.
impl<T> Default for Leaves<T> {
    fn default() -> Self {
        Self {
            values: Values::Single(Vec::new()),
            active: Vec::new(),
            ranges: Vec::new(),
        }
    }
}

impl<T: Spectrum> Leaves<T> {
    pub(super) fn len(&self) -> usize {
        self.active.len()
    }

    pub(super) fn precision(&self) -> Precision {
        match self.values {
            Values::Single(_) => Precision::Single,
            Values::Half(_) => Precision::Half,
        }
    }

    /// Keeps all values in this precision, if it can hold them.
    pub(super) fn set_precision(&mut self, precision: Precision) {
        let leaves = 0..self.len() as u32;
        self.values = match (precision, &self.values) {
            (Precision::Half, Values::Single(all)) if all.iter().all(|&value| fits(value)) => {
                Values::Half(all.iter().copied().flat_map(halves).collect())
            }
            (Precision::Single, Values::Half(_)) => Values::Single(
                (leaves.flat_map(|leaf| (0..VOXELS).map(move |slot| (leaf, slot))))
                    .map(|(leaf, slot)| self.value(leaf, slot))
                    .collect(),
            ),
            _ => return,
        };
    }

    /// Makes sure that a value is held without becoming infinite.
    fn widen_for(&mut self, value: T) {
        if self.precision() == Precision::Half && !fits(value) {
            self.set_precision(Precision::Single);
        }
    }

    /// What becomes of a value in a leaf.
    pub(super) fn rounded(&mut self, value: T) -> T {
        self.widen_for(value);
        match self.precision() {
            Precision::Single => value,
            Precision::Half => value.map(|x| f16::from_f32(x).to_f32()),
        }
    }

    /// Adds a leaf.
    pub(super) fn push(&mut self, values: &[T; VOXELS], active: [u64; 8]) {
        if self.precision() == Precision::Half && !values.iter().all(|&value| fits(value)) {
            self.set_precision(Precision::Single);
        }
        match &mut self.values {
            Values::Single(all) => all.extend_from_slice(values),
            Values::Half(all) => all.extend(values.iter().copied().flat_map(halves)),
        }
        self.active.push(active);
    }

    /// Gives back room for leaves that did not come.
    pub(super) fn shrink(&mut self) {
        match &mut self.values {
            Values::Single(all) => all.shrink_to_fit(),
            Values::Half(all) => all.shrink_to_fit(),
        }
        self.active.shrink_to_fit();
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
        self.widen_for(value);
        let i = leaf as usize * VOXELS + slot;
        match &mut self.values {
            Values::Single(all) => all[i] = value,
            Values::Half(all) => {
                for (c, half) in halves(value).enumerate() {
                    all[i * T::CHANNELS + c] = half;
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
