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

    /// Puts values into slots, from bytes that hold a number for each channel.
    fn decode<T: Spectrum>(
        self,
        bytes: &[u8],
        slots: impl Iterator<Item = usize>,
        values: &mut [T],
    ) {
        match self {
            Self::Half => decode(bytes, slots, values, |x| f16::from_le_bytes(x).to_f32()),
            Self::Single => decode(bytes, slots, values, f32::from_le_bytes),
            Self::Double => decode(bytes, slots, values, |x| f64::from_le_bytes(x) as f32),
        }
    }
}

fn decode<T: Spectrum, const N: usize>(
    bytes: &[u8],
    slots: impl Iterator<Item = usize>,
    values: &mut [T],
    number: impl Fn([u8; N]) -> f32,
) {
    let (numbers, _) = bytes.as_chunks();
    for (slot, channels) in slots.zip(numbers.chunks_exact(T::CHANNELS)) {
        values[slot] = T::from_channels(|c| number(channels[c]));
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
    /// Whether many values together are halves though they are not on their own.
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
        let mut value = [T::default()];
        self.number.decode(bytes, 0..1, &mut value);
        Ok(value[0])
    }

    /// The values of a node, a slot each.
    pub(super) fn values<T: Spectrum, const W: usize>(
        &mut self,
        cursor: &mut Cursor,
        active: &[u64; W],
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
                    "its inactive values are of kind {code}, there are 0 to 6: the file is damaged, export it again"
                ));
            }
        };
        let mask = match code {
            inactive::MASK | inactive::MASK_ONE | inactive::MASK_TWO => cursor.mask()?,
            _ => [0; W],
        };
        if !self.active_only || code == inactive::ALL {
            return self.numbers(cursor, values.len(), 0..values.len(), values);
        }
        values.fill(other);
        for slot in mask::slots(&mask) {
            values[slot] = masked;
        }
        self.numbers(cursor, mask::count(active), mask::slots(active), values)
    }

    /// A block of `count` values, which go to these slots.
    fn numbers<T: Spectrum>(
        &mut self,
        cursor: &mut Cursor,
        count: usize,
        slots: impl Iterator<Item = usize>,
        values: &mut [T],
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
        let block = (self.codec).block(cursor, count * T::CHANNELS * number.size())?;
        number.decode(block, slots, values);
        Ok(())
    }
}
