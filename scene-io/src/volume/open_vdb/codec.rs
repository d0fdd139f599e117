//! How blocks of bytes are compressed.

use super::cursor::Cursor;
use crate::volume::blosc;
use flate2::{Decompress, FlushDecompress, Status};
use std::borrow::Cow;

/// Bits of a grid's compression flags.
pub(super) const ZIP: u32 = 1;
pub(super) const ACTIVE_MASK: u32 = 2;
pub(super) const BLOSC: u32 = 4;

/// Decompresses the blocks of a grid.
pub(super) enum Codec {
    Stored,
    Zip(Box<Decompress>),
    Blosc,
}

impl Codec {
    pub(super) fn new(flags: u32) -> Result<Self, String> {
        if flags & !(ZIP | ACTIVE_MASK | BLOSC) != 0 {
            return Err(format!(
                "has compression flags {flags:#x}, which are not known: export it with zip"
            ));
        }
        Ok(if flags & BLOSC != 0 {
            Self::Blosc
        } else if flags & ZIP != 0 {
            Self::Zip(Box::new(Decompress::new(true)))
        } else {
            Self::Stored
        })
    }

    /// The next block, `size` bytes when decompressed.
    pub(super) fn block<'a>(
        &mut self,
        cursor: &mut Cursor<'a>,
        size: usize,
    ) -> Result<Cow<'a, [u8]>, String> {
        if let Self::Stored = self {
            return cursor.take(size).map(Cow::Borrowed);
        }
        // What does not shrink is stored, its size negative.
        let packed = cursor.i64()?;
        if packed <= 0 {
            if packed.unsigned_abs() != size as u64 {
                return Err(format!(
                    "has a block of {} bytes in place of {size}: the file is broken, export it again",
                    packed.unsigned_abs()
                ));
            }
            return cursor.take(size).map(Cow::Borrowed);
        }
        let packed = cursor.take(usize::try_from(packed).unwrap_or(usize::MAX))?;
        match self {
            Self::Zip(inflate) => unzip(inflate, packed, size),
            _ => blosc::decompress(packed, size).map_err(|e| format!("cannot be read: {e}")),
        }
        .map(Cow::Owned)
    }
}

fn unzip(inflate: &mut Decompress, packed: &[u8], size: usize) -> Result<Vec<u8>, String> {
    inflate.reset(true);
    let mut out = vec![0; size];
    let status = inflate.decompress(packed, &mut out, FlushDecompress::Finish);
    match status {
        Ok(Status::StreamEnd) if inflate.total_out() == size as u64 => Ok(out),
        _ => Err("has zip data that is broken: export it again".into()),
    }
}
