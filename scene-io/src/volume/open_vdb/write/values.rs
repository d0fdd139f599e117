//! Writes numbers, and the values of a node.

use crate::volume::open_vdb::format::inactive;
use crate::volume::open_vdb::mask;
use flate2::{Compress, Compression, FlushCompress, Status};
use half::f16;
use tyndall_core::Spectrum;

/// The end of a file in the making.
pub(super) struct Values<'o, T> {
    background: T,
    half: bool,
    out: &'o mut Vec<u8>,
    deflate: Compress,
}

impl<'o, T: Spectrum> Values<'o, T> {
    pub(super) fn new(background: T, half: bool, out: &'o mut Vec<u8>) -> Self {
        Self {
            background,
            half,
            out,
            deflate: Compress::new(Compression::default(), true),
        }
    }

    /// How many bytes the file has.
    pub(super) fn written(&self) -> usize {
        self.out.len()
    }

    pub(super) fn words(&mut self, words: &[u32]) {
        self.out
            .extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }

    pub(super) fn origin(&mut self, origin: [i32; 3]) {
        self.out
            .extend(origin.into_iter().flat_map(i32::to_le_bytes));
    }

    pub(super) fn flag(&mut self, flag: bool) {
        self.out.push(flag.into());
    }

    pub(super) fn mask(&mut self, mask: &[u64]) {
        self.out
            .extend(mask.iter().flat_map(|word| word.to_le_bytes()));
    }

    /// A value on its own, which is never a half.
    pub(super) fn value(&mut self, value: T) {
        let channels = (0..T::CHANNELS).map(|c| value.channel(c));
        self.out.extend(channels.flat_map(f32::to_le_bytes));
    }

    /// The values of a node. Slots with children hold the background and are inactive.
    pub(super) fn values(&mut self, values: &[T], active: &[u64]) {
        let is_active = |slot: usize| mask::contains(active, slot);
        let slots = || values.iter().copied().enumerate();
        let (code, [other, masked]) = self.inactive(
            slots()
                .filter(|(slot, _)| !is_active(*slot))
                .map(|(_, v)| v),
        );
        self.out.push(code);
        match code {
            inactive::ONE | inactive::MASK_ONE => self.value(other),
            inactive::MASK_TWO => {
                self.value(other);
                self.value(masked);
            }
            _ => {}
        }
        if let inactive::MASK | inactive::MASK_ONE | inactive::MASK_TWO = code {
            let is_masked = |slot: usize| !is_active(slot) && values[slot] == masked;
            self.mask(&mask::of(active.len(), is_masked));
        }
        if code == inactive::ALL {
            self.block(values.iter().copied());
        } else {
            self.block(slots().filter(|(slot, _)| is_active(*slot)).map(|(_, v)| v));
        }
    }

    /// How to write inactive values.
    fn inactive(&self, values: impl Iterator<Item = T>) -> (u8, [T; 2]) {
        let (background, minus) = (self.background, self.background.map(|x| -x));
        let mut distinct: Vec<T> = Vec::with_capacity(3);
        for value in values {
            if !distinct.contains(&value) {
                distinct.push(value);
            }
            if distinct.len() > 2 {
                return (inactive::ALL, [background; 2]);
            }
        }
        let others = distinct
            .iter()
            .copied()
            .filter(|value| *value != background);
        let others: Vec<T> = others.collect();
        match (others.as_slice(), distinct.len()) {
            ([], _) => (inactive::BACKGROUND, [background; 2]),
            ([x], 1) if *x == minus => (inactive::MINUS, [*x, background]),
            ([x], 1) => (inactive::ONE, [*x, background]),
            ([x], _) if *x == minus => (inactive::MASK, [*x, background]),
            ([x], _) => (inactive::MASK_ONE, [*x, background]),
            ([x, y, ..], _) => (inactive::MASK_TWO, [*x, *y]),
        }
    }

    fn block(&mut self, values: impl Iterator<Item = T>) {
        let numbers = values.flat_map(|value| (0..T::CHANNELS).map(move |c| value.channel(c)));
        let bytes: Vec<u8> = if self.half {
            numbers
                .flat_map(|x| f16::from_f32(x).to_le_bytes())
                .collect()
        } else {
            numbers.flat_map(f32::to_le_bytes).collect()
        };
        // Of no halves, not even a size is written.
        if self.half && bytes.is_empty() {
            return;
        }
        let mut packed = vec![0; bytes.len()];
        self.deflate.reset();
        let status = (self.deflate).compress(&bytes, &mut packed, FlushCompress::Finish);
        let size = self.deflate.total_out() as usize;
        // What does not shrink is stored, its size negative.
        if matches!(status, Ok(Status::StreamEnd)) && size < bytes.len() {
            self.out.extend((size as i64).to_le_bytes());
            self.out.extend(&packed[..size]);
        } else {
            self.out.extend((-(bytes.len() as i64)).to_le_bytes());
            self.out.extend(&bytes);
        }
    }
}
