//! How values are written: as which numbers, compressed how, with or without inactive ones.

use super::codec::Codec;
use super::cursor::Cursor;
use super::mask;
use half::f16;
use tyndall_core::Spectrum;

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Half,
    Single,
    Double,
}

impl Number {
    pub(super) fn size(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Single => 4,
            Self::Double => 8,
        }
    }

    /// The number in these bytes, of which there are [`Number::size`].
    fn read(self, bytes: &[u8]) -> f32 {
        let mut word = [0; 8];
        word[..bytes.len()].copy_from_slice(bytes);
        let word = u64::from_le_bytes(word);
        match self {
            Self::Half => f16::from_bits(word as u16).to_f32(),
            Self::Single => f32::from_bits(word as u32),
            Self::Double => f64::from_bits(word) as f32,
        }
    }

    /// The value in these bytes, a number for each channel.
    fn value<T: Spectrum>(self, bytes: &[u8]) -> T {
        T::from_channels(|c| self.read(&bytes[c * self.size()..][..self.size()]))
    }
}

/// What a node's inactive values are, where they are not written one by one.
pub(super) mod inactive {
    /// Background.
    pub(crate) const BACKGROUND: u8 = 0;
    /// Minus the background.
    pub(crate) const MINUS: u8 = 1;
    /// One other value, which is written.
    pub(crate) const ONE: u8 = 2;
    /// Minus the background, or by a mask the background.
    pub(crate) const MASK: u8 = 3;
    /// One other value, or by a mask the background.
    pub(crate) const MASK_ONE: u8 = 4;
    /// By a mask one of two others, which are written.
    pub(crate) const MASK_TWO: u8 = 5;
    /// Written one by one.
    pub(crate) const ALL: u8 = 6;
}

/// How the values of a tree are written.
pub(super) struct Format {
    /// A value on its own.
    pub(super) number: Number,
    /// Whether many values together are halves, whatever they are on their own.
    pub(super) saved_as_half: bool,
    /// Whether inactive values may be left out.
    pub(super) active_only: bool,
    pub(super) codec: Codec,
}

impl Format {
    /// Whether voxels are halves.
    pub(super) fn is_half(&self) -> bool {
        self.saved_as_half || self.number == Number::Half
    }

    /// A value on its own.
    pub(super) fn value<T: Spectrum>(&self, cursor: &mut Cursor) -> Result<T, String> {
        let bytes = cursor.take(T::CHANNELS * self.number.size())?;
        Ok(self.number.value(bytes))
    }

    /// The values of a node, a slot each.
    pub(super) fn values<T: Spectrum>(
        &mut self,
        cursor: &mut Cursor,
        active: &[u64],
        background: T,
        values: &mut [T],
    ) -> Result<(), String> {
        let code = cursor.u8()?;
        let minus = background.map(|x| -x);
        let [other, masked] = match code {
            inactive::BACKGROUND | inactive::ALL => [background; 2],
            inactive::MINUS | inactive::MASK => [minus, background],
            inactive::ONE | inactive::MASK_ONE => [self.value(cursor)?, background],
            inactive::MASK_TWO => [self.value(cursor)?, self.value(cursor)?],
            _ => {
                return Err(format!(
                    "has inactive values of kind {code}, there are 0 to 6: the file is broken, export it again"
                ));
            }
        };
        let mask = match code {
            inactive::MASK | inactive::MASK_ONE | inactive::MASK_TWO => {
                cursor.mask(active.len())?
            }
            _ => vec![0; active.len()],
        };
        if !self.active_only || code == inactive::ALL {
            return self.numbers(cursor, values.len(), values.iter_mut());
        }
        for (slot, value) in values.iter_mut().enumerate() {
            *value = if mask::contains(&mask, slot) {
                masked
            } else {
                other
            };
        }
        let count = active.iter().map(|word| word.count_ones() as usize).sum();
        let slots = values.iter_mut().enumerate();
        let slots = slots.filter(|(slot, _)| mask::contains(active, *slot));
        self.numbers(cursor, count, slots.map(|(_, value)| value))
    }

    /// A block of `count` values.
    fn numbers<'v, T: Spectrum + 'v>(
        &mut self,
        cursor: &mut Cursor,
        count: usize,
        values: impl Iterator<Item = &'v mut T>,
    ) -> Result<(), String> {
        let number = if self.saved_as_half {
            // Of none, not even a size is written.
            if count == 0 {
                return Ok(());
            }
            Number::Half
        } else {
            self.number
        };
        let size = T::CHANNELS * number.size();
        let block = self.codec.block(cursor, count * size)?;
        for (value, bytes) in values.zip(block.chunks_exact(size)) {
            *value = number.value(bytes);
        }
        Ok(())
    }
}
