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

#[cfg(test)]
mod tests {
    use super::*;

    /// A container of these blocks.
    fn container(flags: u8, type_size: u8, size: u32, block: u32, blocks: &[Vec<u8>]) -> Vec<u8> {
        let mut out = vec![2, 1, flags, type_size];
        let packed = blocks.iter().map(|block| 4 + block.len()).sum::<usize>() as u32;
        for word in [size, block, 16 + packed] {
            out.extend(word.to_le_bytes());
        }
        let mut start = 16 + 4 * blocks.len();
        for block in blocks {
            out.extend((start as u32).to_le_bytes());
            start += block.len();
        }
        out.extend(blocks.concat());
        out
    }

    /// A stream of LZ4 that only holds literals, by its length.
    fn literals(bytes: &[u8]) -> Vec<u8> {
        let long = (bytes.len() - 15) as u8;
        let packed = [&[0xf0, long], bytes].concat();
        [&(packed.len() as u32).to_le_bytes()[..], &packed].concat()
    }

    /// A stream that did not shrink.
    fn stored(bytes: &[u8]) -> Vec<u8> {
        [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
    }

    fn bytes(size: usize) -> Vec<u8> {
        (0..size).map(|i| (i * i / 7) as u8).collect()
    }

    /// The bytes with this place in their values.
    fn plane(all: &[u8], place: usize) -> Vec<u8> {
        all.iter().copied().skip(place).step_by(4).collect()
    }

    /// Two blocks of four streams, then one too short to be split.
    #[test]
    fn split_and_shuffled_blocks_are_read() {
        let all = bytes(1200);
        let mut blocks: Vec<_> = (all[..1024].chunks(512))
            .map(|block| (0..4).flat_map(|i| literals(&plane(block, i))).collect())
            .collect();
        let last: Vec<_> = (0..4).flat_map(|i| plane(&all[1024..], i)).collect();
        blocks.push(literals(&last));
        let packed = container(LZ4 << 5 | SHUFFLED, 4, 1200, 512, &blocks);
        assert_eq!(unpack(&packed, 1200).unwrap(), all);
        for length in 0..packed.len() {
            assert!(unpack(&packed[..length], 1200).is_err());
        }
    }

    #[test]
    fn whole_and_stored_blocks_are_read() {
        let all = bytes(200);
        let whole = container(LZ4 << 5 | NOT_SPLIT, 4, 200, 200, &[literals(&all)]);
        assert_eq!(unpack(&whole, 200).unwrap(), all);
        let raw = container(LZ4 << 5, 1, 200, 200, &[stored(&all)]);
        assert_eq!(unpack(&raw, 200).unwrap(), all);
        // Values of 3 bytes that do not fill the block.
        let shuffled: Vec<_> = [0, 3, 6, 1, 4, 7, 2, 5, 8, 9].map(|i| all[i]).to_vec();
        let odd = container(LZ4 << 5 | SHUFFLED, 3, 10, 10, &[stored(&shuffled)]);
        assert_eq!(unpack(&odd, 10).unwrap(), all[..10]);
    }

    #[test]
    fn what_is_not_read_is_named() {
        let all = bytes(200);
        for (flags, name) in [
            (0, "BloscLZ"),
            (2 << 5, "Snappy"),
            (3 << 5, "zlib"),
            (4 << 5, "Zstandard"),
            (7 << 5, "unknown"),
            (LZ4 << 5 | BITS_SHUFFLED, "bit shuffle"),
        ] {
            let packed = container(flags, 4, 200, 200, &[stored(&all)]);
            assert!(unpack(&packed, 200).unwrap_err().contains(name));
        }
        let packed = container(LZ4 << 5, 1, 200, 200, &[stored(&all)]);
        assert!(
            unpack(&packed, 201)
                .unwrap_err()
                .contains("in place of 201")
        );
        // Streams that say too much, too little, or lie beyond the end.
        for block in [literals(&all[..190]), vec![0xff; 9], vec![0; 9]] {
            let packed = container(LZ4 << 5, 1, 200, 200, &[block]);
            assert!(unpack(&packed, 200).is_err());
        }
    }
}
