//! A file's bytes, read from front to back.

use crate::volume::bytes::Bytes;

/// Where reading is, in the first bytes of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    bytes: Bytes<'a>,
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let bytes = Bytes(bytes);
        Self { bytes, at: 0 }
    }

    /// A cursor further on that reads no further than `end`.
    pub(super) fn within(&self, start: i64, end: i64) -> Result<Self, String> {
        let (all, place) = (self.bytes.0, |x: i64| usize::try_from(x).ok());
        match (place(start), place(end)) {
            (Some(at), Some(end)) if self.at <= at && at <= end && end <= all.len() => {
                let bytes = Bytes(&all[..end]);
                Ok(Self { bytes, at })
            }
            _ => Err(format!(
                "it is said to lie in bytes {start} to {end} of {}: the file is cut off or damaged, copy or export it again",
                all.len()
            )),
        }
    }

    pub(super) fn seek(&mut self, at: usize) {
        self.at = at.min(self.bytes.0.len());
    }

    pub(super) fn take(&mut self, n: usize) -> Result<&'a [u8], String> {
        let taken = self.bytes.slice(self.at, n)?;
        self.at += n;
        Ok(taken)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let array = self.bytes.array(self.at)?;
        self.at += N;
        Ok(array)
    }

    pub(super) fn u8(&mut self) -> Result<u8, String> {
        self.array().map(u8::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn i64(&mut self) -> Result<i64, String> {
        self.array().map(i64::from_le_bytes)
    }

    pub(super) fn i32s<const N: usize>(&mut self) -> Result<[i32; N], String> {
        let mut all = [0; N];
        for x in &mut all {
            *x = i32::from_le_bytes(self.array()?);
        }
        Ok(all)
    }

    pub(super) fn f64s<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let mut all = [0.0; N];
        for x in &mut all {
            *x = f64::from_le_bytes(self.array()?);
        }
        Ok(all)
    }

    /// A string, which need not be UTF-8.
    pub(super) fn string(&mut self) -> Result<&'a [u8], String> {
        let length = self.u32()?;
        self.take(length as usize)
    }

    /// A bit for each of 64·W slots.
    pub(super) fn mask<const W: usize>(&mut self) -> Result<[u64; W], String> {
        let (words, _) = self.take(size_of::<[u64; W]>())?.as_chunks();
        let mut mask = [0; W];
        for (word, bytes) in mask.iter_mut().zip(words) {
            *word = u64::from_le_bytes(*bytes);
        }
        Ok(mask)
    }
}
