//! Blosc, a container of compressed blocks in which OpenVDB and NanoVDB pack voxels.
//!
//! Source: "Blosc1 Chunk Format" of the C-Blosc library, version 1.

/// Header: version, version of the compressor, flags, bytes of an element, then three `u32`.
const HEADER: usize = 16;
/// More than LZ4 ever packs into a byte.
const DENSEST: usize = 256;

/// Bits of the flags.
const SHUFFLED: u8 = 1;
const COPIED: u8 = 2;
const BIT_SHUFFLED: u8 = 4;
const WHOLE_BLOCKS: u8 = 16;
/// The compressor, in the upper three bits.
const LZ4: u8 = 1;

/// Splits of a block are for elements up to this size, and hold at least so many of them.
const LARGEST_SPLIT: usize = 16;
const SHORTEST_SPLIT: usize = 128;

/// The bytes in a container that is to hold `size` of them, packed by LZ4 or not at all, with the
/// bytes of elements shuffled or not. Never allocates more than twice 256 times `bytes`.
///
/// # Errors
/// A sentence on what is wrong or not read, with the mend.
pub(super) fn decompress(bytes: &[u8], size: usize) -> Result<Vec<u8>, String> {
    let damaged = || "its Blosc data are damaged: export the file again".to_owned();
    let container = Container::of(bytes).ok_or_else(damaged)?;
    if container.size != size || size > bytes.len().saturating_mul(DENSEST) {
        return Err(damaged());
    }
    if container.flags & COPIED != 0 {
        let copied = container
            .bytes
            .get(HEADER..)
            .and_then(|all| all.get(..size));
        return copied.map(<[u8]>::to_vec).ok_or_else(damaged);
    }
    check_kind(container.flags)?;
    container.unpack().ok_or_else(damaged)
}

/// A container with its header, from which the rest is.
struct Container<'a> {
    bytes: &'a [u8],
    flags: u8,
    /// Bytes of an element.
    element: usize,
    /// Bytes in it.
    size: usize,
    /// Bytes of a block but the last.
    block: usize,
}

impl<'a> Container<'a> {
    fn of(bytes: &'a [u8]) -> Option<Self> {
        let length = word(bytes, 12)?;
        Some(Self {
            flags: *bytes.get(2)?,
            element: usize::from(*bytes.get(3)?).max(1),
            size: word(bytes, 4)?,
            block: word(bytes, 8)?,
            bytes: bytes.get(..length)?,
        })
    }

    fn unpack(&self) -> Option<Vec<u8>> {
        if self.block == 0 {
            return (self.size == 0).then(Vec::new);
        }
        let mut all = vec![0; self.size];
        let mut shuffled = Vec::new();
        for (i, out) in all.chunks_mut(self.block).enumerate() {
            let start = word(self.bytes, HEADER + size_of::<u32>() * i)?;
            let stream = self.bytes.get(start..)?;
            unpack(stream, out, self.splits(out.len()))?;
            if self.flags & SHUFFLED != 0 && self.element > 1 {
                shuffled.clear();
                shuffled.extend_from_slice(out);
                unshuffle(&shuffled, self.element, out);
            }
        }
        Some(all)
    }

    /// Of a block of this length.
    fn splits(&self, length: usize) -> usize {
        let whole = self.flags & WHOLE_BLOCKS != 0 || length != self.block;
        let few = self.block / self.element < SHORTEST_SPLIT;
        if whole || few || self.element > LARGEST_SPLIT {
            1
        } else {
            self.element
        }
    }
}

fn check_kind(flags: u8) -> Result<(), String> {
    if flags & BIT_SHUFFLED != 0 {
        return Err(
            "its Blosc data are shuffled by bits, which is not read: export it with zip".into(),
        );
    }
    let compressor = match flags >> 5 {
        LZ4 => return Ok(()),
        0 => "BloscLZ",
        2 => "Snappy",
        3 => "zlib",
        4 => "Zstandard",
        _ => "an unknown method",
    };
    Err(format!(
        "its Blosc data are packed by {compressor}, which is not read: export it with LZ4 or zip"
    ))
}

/// A little-endian number.
fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*word)).ok()
}

/// Fills a block from streams, each after its length; one as long as what it holds is a copy.
fn unpack(mut stream: &[u8], out: &mut [u8], splits: usize) -> Option<()> {
    if !out.len().is_multiple_of(splits) {
        return None;
    }
    let length = out.len() / splits;
    for part in out.chunks_mut(length.max(1)) {
        let packed = word(stream, 0)?;
        let data = stream.get(4..)?.get(..packed)?;
        if packed == part.len() {
            part.copy_from_slice(data);
        } else if lz4_flex::block::decompress_into(data, part).ok()? != part.len() {
            return None;
        }
        stream = &stream[4 + packed..];
    }
    Some(())
}

/// First bytes of all elements, then second ones, and so on, back to elements; what is no whole
/// element at the end was left alone.
fn unshuffle(shuffled: &[u8], element: usize, out: &mut [u8]) {
    let count = shuffled.len() / element;
    let whole = count * element;
    for (place, plane) in shuffled[..whole].chunks_exact(count.max(1)).enumerate() {
        for (bytes, byte) in out.chunks_exact_mut(element).zip(plane) {
            bytes[place] = *byte;
        }
    }
    out[whole..].copy_from_slice(&shuffled[whole..]);
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
        assert_eq!(decompress(&packed, 1200).unwrap(), all);
        for length in 0..packed.len() {
            assert!(decompress(&packed[..length], 1200).is_err());
        }
    }

    #[test]
    fn whole_and_stored_blocks_are_read() {
        let all = bytes(200);
        let whole = container(LZ4 << 5 | WHOLE_BLOCKS, 4, 200, 200, &[literals(&all)]);
        assert_eq!(decompress(&whole, 200).unwrap(), all);
        let raw = container(LZ4 << 5, 1, 200, 200, &[stored(&all)]);
        assert_eq!(decompress(&raw, 200).unwrap(), all);
        // Values of 3 bytes that do not fill the block.
        let shuffled: Vec<_> = [0, 3, 6, 1, 4, 7, 2, 5, 8, 9].map(|i| all[i]).to_vec();
        let odd = container(LZ4 << 5 | SHUFFLED, 3, 10, 10, &[stored(&shuffled)]);
        assert_eq!(decompress(&odd, 10).unwrap(), all[..10]);
    }

    #[test]
    fn what_is_not_read_is_named() {
        let all = bytes(200);
        for (flags, name) in [
            (0, "BloscLZ"),
            (2 << 5, "Snappy"),
            (3 << 5, "zlib"),
            (4 << 5, "Zstandard"),
            (7 << 5, "an unknown"),
            (LZ4 << 5 | BIT_SHUFFLED, "by bits"),
        ] {
            let packed = container(flags, 4, 200, 200, &[stored(&all)]);
            assert!(decompress(&packed, 200).unwrap_err().contains(name));
        }
        let packed = container(LZ4 << 5, 1, 200, 200, &[stored(&all)]);
        assert!(decompress(&packed, 201).unwrap_err().contains("damaged"));
        // Streams that say too much, too little, or lie beyond the end.
        for block in [literals(&all[..190]), vec![0xff; 9], vec![0; 9]] {
            let packed = container(LZ4 << 5, 1, 200, 200, &[block]);
            assert!(decompress(&packed, 200).is_err());
        }
    }
}
