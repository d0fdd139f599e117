//! Unpacks and packs the buffers of grids.

use crate::volume::blosc;
use crate::volume::bytes::Bytes;
use flate2::Compression;
use flate2::read::{ZlibDecoder, ZlibEncoder};
use std::borrow::Cow;
use std::io::Read;

/// No zlib stream holds more than this many times its own bytes.
const DENSEST: usize = 1032;
/// Bytes that one Blosc container holds at most.
const CHUNK: usize = 1 << 30;

pub(super) const NONE: u16 = 0;
pub(super) const ZIP: u16 = 1;
const BLOSC: u16 = 2;

/// The buffer of a grid, of `size` bytes.
pub(super) fn unpack(codec: u16, stored: &[u8], size: usize) -> Result<Cow<'_, [u8]>, String> {
    match codec {
        NONE => Bytes(stored).slice(0, size).map(Cow::Borrowed),
        ZIP => unzip(framed(stored, 0)?, size).map(Cow::Owned),
        BLOSC => {
            let mut buffer = Vec::new();
            let mut at = 0;
            while buffer.len() < size {
                let part = framed(stored, at)?;
                let length = CHUNK.min(size - buffer.len());
                buffer.append(&mut blosc::decompress(part, length)?);
                at += size_of::<u64>() + part.len();
            }
            Ok(Cow::Owned(buffer))
        }
        other => Err(format!(
            "its compression {other} is not known: export it uncompressed, with zip or Blosc"
        )),
    }
}

/// As a file stores it.
pub(super) fn zip(buffer: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut stored = vec![0; size_of::<u64>()];
    ZlibEncoder::new(buffer, Compression::default()).read_to_end(&mut stored)?;
    let length = (stored.len() - size_of::<u64>()) as u64;
    stored[..size_of::<u64>()].copy_from_slice(&length.to_le_bytes());
    Ok(stored)
}

/// What follows its own length.
fn framed(stored: &[u8], at: usize) -> Result<&[u8], String> {
    let length = Bytes(stored).size(at)?;
    Bytes(stored).slice(at + size_of::<u64>(), length)
}

fn unzip(packed: &[u8], size: usize) -> Result<Vec<u8>, String> {
    if size > packed.len().saturating_mul(DENSEST) {
        return Err(format!(
            "{} bytes of zip cannot hold the {size} it claims: the file is damaged, export it again",
            packed.len()
        ));
    }
    let mut buffer = Vec::new();
    // One byte more than claimed tells a stream that is too long.
    let limit = size as u64 + 1;
    let read = ZlibDecoder::new(packed)
        .take(limit)
        .read_to_end(&mut buffer);
    read.map_err(|e| format!("its zip stream is broken ({e}): export the file again"))?;
    if buffer.len() != size {
        return Err(format!(
            "its zip stream does not hold the {size} bytes it claims: the file is damaged, export it again"
        ));
    }
    Ok(buffer)
}
