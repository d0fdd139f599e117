//! How blocks of bytes are compressed.

use super::cursor::Cursor;
use crate::volume::blosc;
use flate2::{Decompress, FlushDecompress, Status};

/// Bits of a grid's compression flags.
pub(super) const ZIP: u32 = 1;
pub(super) const ACTIVE_MASK: u32 = 2;
pub(super) const BLOSC: u32 = 4;

/// Decompresses the blocks of a grid.
pub(super) struct Codec {
    method: Method,
    /// The last block.
    unpacked: Vec<u8>,
}

enum Method {
    Stored,
    Zip(Box<Decompress>),
    Blosc,
}

impl Codec {
    pub(super) fn new(flags: u32) -> Result<Self, String> {
        if flags & !(ZIP | ACTIVE_MASK | BLOSC) != 0 {
            return Err(format!(
                "its compression flags {flags:#x} are not known: export it with zip"
            ));
        }
        let method = if flags & BLOSC != 0 {
            Method::Blosc
        } else if flags & ZIP != 0 {
            Method::Zip(Box::new(Decompress::new(true)))
        } else {
            Method::Stored
        };
        let unpacked = Vec::new();
        Ok(Self { method, unpacked })
    }

    /// The next block, `size` bytes when decompressed. Sizes are those of a node's values, so that
    /// none takes much.
    pub(super) fn block<'b, 'a: 'b>(
        &'b mut self,
        cursor: &mut Cursor<'a>,
        size: usize,
    ) -> Result<&'b [u8], String> {
        if let Method::Stored = self.method {
            return cursor.take(size);
        }
        // What does not shrink is stored, its size negative.
        let packed = cursor.i64()?;
        if packed <= 0 {
            if packed.unsigned_abs() != size as u64 {
                return Err(format!(
                    "a block has {} bytes in place of {size}: the file is damaged, export it again",
                    packed.unsigned_abs()
                ));
            }
            return cursor.take(size);
        }
        let packed = cursor.take(usize::try_from(packed).unwrap_or(usize::MAX))?;
        match &mut self.method {
            Method::Zip(inflate) => unzip(inflate, packed, size, &mut self.unpacked)?,
            _ => self.unpacked = blosc::decompress(packed, size)?,
        }
        Ok(&self.unpacked)
    }
}

fn unzip(
    inflate: &mut Decompress,
    packed: &[u8],
    size: usize,
    out: &mut Vec<u8>,
) -> Result<(), String> {
    inflate.reset(true);
    out.resize(size, 0);
    let status = inflate.decompress(packed, out, FlushDecompress::Finish);
    match status {
        Ok(Status::StreamEnd) if inflate.total_out() == size as u64 => Ok(()),
        _ => Err("its zip data are damaged: export the file again".into()),
    }
}
