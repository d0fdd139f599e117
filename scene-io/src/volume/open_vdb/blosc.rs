//! Blosc 1 containers around LZ4 (c-blosc, `README_CHUNK_FORMAT.rst`): a header of 16 bytes; blocks
//! of equal size but for the last; each block one stream or, split, one stream a byte of the values.

use super::cursor::Cursor;

const SHUFFLED: u8 = 1;
const COPIED: u8 = 2;
const BITS_SHUFFLED: u8 = 4;
const NOT_SPLIT: u8 = 16;
const LZ4: u8 = 1;
/// Values of more bytes are not split into streams.
const MAX_SPLITS: usize = 16;
/// Nor are blocks with fewer bytes a stream.
const MIN_STREAM: usize = 128;

/// Decompresses to `size` bytes exactly.
pub(super) fn unpack(packed: &[u8], size: usize) -> Result<Vec<u8>, String> {
    let mut cursor = Cursor::new(packed);
    let [_version, _codec_version, flags, type_size] = cursor.array()?;
    let (bytes, block, _packed) = (cursor.u32()?, cursor.u32()?, cursor.u32()?);
    if bytes as usize != size {
        return Err(format!(
            "has a block of {bytes} bytes in place of {size}: the file is broken, export it again"
        ));
    }
    if flags & COPIED != 0 {
        return cursor.take(size).map(<[u8]>::to_vec);
    }
    if flags >> 5 != LZ4 {
        return Err(format!(
            "is compressed with Blosc's {}, not LZ4: export it with zip or no compression",
            codec(flags >> 5)
        ));
    }
    if flags & BITS_SHUFFLED != 0 {
        return Err(
            "is compressed with Blosc's bit shuffle: export it with zip or no compression".into(),
        );
    }
    // No block is larger than the whole.
    let block = (block as usize).clamp(1, size.max(1));
    let type_size = usize::from(type_size).max(1);
    let is_split = flags & NOT_SPLIT == 0 && type_size <= MAX_SPLITS;
    let mut all = vec![0; size];
    for (i, out) in all.chunks_mut(block).enumerate() {
        cursor.seek(16 + 4 * i);
        let start = cursor.u32()? as usize;
        cursor.seek(start);
        let split = is_split && out.len() == block && block / type_size >= MIN_STREAM;
        let streams = if split { type_size } else { 1 };
        if flags & SHUFFLED != 0 && type_size > 1 {
            let mut shuffled = vec![0; out.len()];
            unpack_streams(&mut cursor, streams, &mut shuffled)?;
            unshuffle(&shuffled, type_size, out);
        } else {
            unpack_streams(&mut cursor, streams, out)?;
        }
    }
    Ok(all)
}

fn unpack_streams(cursor: &mut Cursor, streams: usize, out: &mut [u8]) -> Result<(), String> {
    let size = out.len() / streams;
    for stream in out.chunks_mut(size) {
        let packed = cursor.u32()? as usize;
        let packed = cursor.take(packed)?;
        // What does not shrink is stored.
        if packed.len() == stream.len() {
            stream.copy_from_slice(packed);
            continue;
        }
        let unpacked = lz4_flex::block::decompress_into(packed, stream);
        if unpacked.ok() != Some(stream.len()) {
            return Err("has LZ4 data that is broken: export it again".into());
        }
    }
    Ok(())
}

/// The first bytes of all values come first, then all second ones; bytes that fill no value are last,
/// as they were.
fn unshuffle(shuffled: &[u8], type_size: usize, out: &mut [u8]) {
    let values = shuffled.len() / type_size;
    let (planes, rest) = shuffled.split_at(values * type_size);
    out[planes.len()..].copy_from_slice(rest);
    for (byte, plane) in planes.chunks_exact(values.max(1)).enumerate() {
        for (value, &x) in plane.iter().enumerate() {
            out[value * type_size + byte] = x;
        }
    }
}

fn codec(code: u8) -> &'static str {
    ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"]
        .get(usize::from(code))
        .unwrap_or(&"unknown codec")
}
