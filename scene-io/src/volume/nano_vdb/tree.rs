//! Reads the nodes of a grid.

use super::layout::{Layout, Leaves, NodeLayout, ROOT_TILES, grid, kind_of, leaf, tile, tree};
use crate::volume::bytes::Bytes;
use crate::volume::level::{LEAF_WORDS, ROOT_EDGE, VOXELS, misplaced};
use glam::IVec3;
use tyndall_core::Spectrum;
use tyndall_media::{SparseBuilder, TileSize};

/// Bits of a root key in each axis.
const KEY_BITS: u32 = 21;
/// Nodes begin at multiples of this and fill them.
const ALIGNMENT: usize = 32;

/// The tree of the grid in a buffer.
pub(super) fn read<T: Spectrum>(
    bytes: Bytes<'_>,
    layout: Layout,
) -> Result<SparseBuilder<T>, String> {
    // Offsets of leaves, lower and upper nodes come first: children name themselves.
    let offset = bytes.i64(grid::END + tree::OFFSETS + 3 * size_of::<i64>())?;
    let root = place(grid::END, offset)?;
    let background = value(bytes, root.saturating_add(layout.background()), layout)?;
    let mut reader = Reader {
        bytes,
        layout,
        background,
        taken: vec![0; bytes.0.len().div_ceil(ALIGNMENT * 8)],
        builder: SparseBuilder::new(background),
    };
    reader.root(root)?;
    Ok(reader.builder)
}

struct Reader<'a, T> {
    bytes: Bytes<'a>,
    layout: Layout,
    background: T,
    /// A bit for each 32 bytes of the buffer, set where a node lies: where nodes shared bytes, a small
    /// file would stand for a huge grid.
    taken: Vec<u8>,
    builder: SparseBuilder<T>,
}

impl<'a, T: Spectrum> Reader<'a, T> {
    fn root(&mut self, at: usize) -> Result<(), String> {
        let count = self.bytes.u32(at + ROOT_TILES)?;
        let size = self.layout.tile();
        let mut here = at + self.layout.root();
        for _ in 0..count {
            let tile = Bytes(self.bytes.slice(here, size)?);
            let origin = origin_of(tile.u64(tile::KEY)?)?;
            match tile.i64(tile::CHILD)? {
                0 => {
                    let value = value(tile, self.layout.tile_value(), self.layout)?;
                    let active = tile.u32(tile::ACTIVE)? != 0;
                    self.tile(origin, TileSize::Upper, value, active)?;
                }
                offset => self.child(at, offset, origin, 2)?,
            }
            here += size;
        }
        Ok(())
    }

    fn child(
        &mut self,
        parent: usize,
        offset: i64,
        origin: IVec3,
        level: usize,
    ) -> Result<(), String> {
        let at = place(parent, offset)?;
        match level {
            0 => self.leaf(at, origin),
            _ => self.node(at, origin, level),
        }
    }

    fn node(&mut self, at: usize, origin: IVec3, level: usize) -> Result<(), String> {
        let (kind, layout) = (kind_of(level), self.layout.node(level));
        let node = self.take(at, layout.size)?;
        let table = node.slice(layout.table, layout.stride * layout.slots)?;
        for (slot, content) in table.chunks_exact(layout.stride).enumerate() {
            let here = origin + kind.origin(slot);
            if node.bit(layout.child_mask, slot)? {
                self.child(at, Bytes(content).i64(0)?, here, level - 1)?;
            } else {
                let active = node.bit(NodeLayout::VALUE_MASK, slot)?;
                self.tile(here, kind.tile, decode(content, self.layout), active)?;
            }
        }
        Ok(())
    }

    fn tile(
        &mut self,
        origin: IVec3,
        size: TileSize,
        value: T,
        active: bool,
    ) -> Result<(), String> {
        if !active && value == self.background {
            return Ok(());
        }
        (self.builder.tile(origin, size, value, active)).map_err(misplaced)
    }

    /// The bytes of a node, which no other node has.
    fn take(&mut self, at: usize, size: usize) -> Result<Bytes<'a>, String> {
        let node = self.bytes.slice(at, size)?;
        if !at.is_multiple_of(ALIGNMENT) {
            return Err(format!(
                "a node begins at byte {at} of its buffer, not at a multiple of {ALIGNMENT}: the file is damaged, export it again"
            ));
        }
        for block in at / ALIGNMENT..(at + size) / ALIGNMENT {
            let (byte, bit) = (&mut self.taken[block / 8], 1 << (block % 8));
            if *byte & bit != 0 {
                return Err("its nodes overlap: the file is damaged, export it again".into());
            }
            *byte |= bit;
        }
        Ok(Bytes(node))
    }

    fn leaf(&mut self, at: usize, origin: IVec3) -> Result<(), String> {
        // The width of codes is that of the type, or each leaf's own.
        let log2 = match self.layout.leaves {
            Leaves::Values => None,
            Leaves::Codes(log2) => Some(log2),
            Leaves::AnyCodes => {
                let head = Bytes(self.bytes.slice(at, leaf::CODES)?);
                Some(head.u8(leaf::FLAGS)? >> 5)
            }
        };
        let codes = |log2| (VOXELS / 8) << log2;
        let size = log2.map_or(self.layout.leaf(), |log2| leaf::CODES + codes(log2));
        let node = self.take(at, size)?;
        let mut active = [0; LEAF_WORDS];
        for (i, word) in active.iter_mut().enumerate() {
            *word = node.u64(leaf::MASK + size_of::<u64>() * i)?;
        }
        let mut values = [self.background; VOXELS];
        if let Some(log2) = log2 {
            let (minimum, quantum) = (node.f32(leaf::MINIMUM)?, node.f32(leaf::QUANTUM)?);
            let codes = Bytes(node.slice(leaf::CODES, codes(log2))?);
            for (i, voxel) in values.iter_mut().enumerate() {
                *voxel = T::splat(code(codes, i, log2)? * quantum + minimum);
            }
        } else {
            let size = self.layout.value();
            let all = node.slice(self.layout.leaf_values(), VOXELS * size)?;
            for (voxel, bytes) in values.iter_mut().zip(all.chunks_exact(size)) {
                *voxel = decode(bytes, self.layout);
            }
        }
        (self.builder.leaf(origin, &values, active)).map_err(misplaced)
    }
}

/// What a code of 2ⁿ bits says.
fn code(codes: Bytes<'_>, i: usize, log2: u8) -> Result<f32, String> {
    match log2 {
        0..=2 => {
            let (bits, bit) = (1 << log2, i << log2);
            let code = (codes.u8(bit / 8)? >> (bit % 8)) & ((1 << bits) - 1);
            Ok(f32::from(code))
        }
        3 => codes.u8(i).map(f32::from),
        4 => codes.u16(2 * i).map(f32::from),
        _ => Err(format!(
            "a leaf has codes of {} bits: the file is damaged, export it again",
            1 << log2
        )),
    }
}

/// Where something lies, from the place that it counts from.
fn place(from: usize, offset: i64) -> Result<usize, String> {
    let offset = isize::try_from(offset).ok();
    let place = offset.and_then(|offset| from.checked_add_signed(offset));
    place.ok_or_else(|| {
        "an offset leads out of its buffer: the file is damaged, export it again".into()
    })
}

fn value<T: Spectrum>(bytes: Bytes<'_>, at: usize, layout: Layout) -> Result<T, String> {
    let bytes = bytes.slice(at, layout.value())?;
    Ok(decode(bytes, layout))
}

/// The value that these bytes begin with. They are as many as a value has at least, and a value has
/// the channels of `T`.
fn decode<T: Spectrum>(bytes: &[u8], layout: Layout) -> T {
    if layout.scalar == size_of::<f32>() {
        let (numbers, _) = bytes.as_chunks();
        T::from_channels(|c| f32::from_le_bytes(numbers[c]))
    } else {
        let (numbers, _) = bytes.as_chunks();
        T::from_channels(|c| f64::from_le_bytes(numbers[c]) as f32)
    }
}

/// The first voxel of what a root key names: z in the lowest bits.
fn origin_of(key: u64) -> Result<IVec3, String> {
    let (bits, log2) = (KEY_BITS, ROOT_EDGE);
    let axis = |i: u32| {
        let block = (key >> (bits * i)) & ((1 << bits) - 1);
        u32::try_from(block << log2).ok().map(u32::cast_signed)
    };
    match [axis(2), axis(1), axis(0)] {
        [Some(x), Some(y), Some(z)] => Ok(IVec3::new(x, y, z)),
        _ => Err("a root tile lies beyond all voxels: the file is damaged, export it again".into()),
    }
}

/// The root key of a block of 4096³ voxels.
pub(super) fn key_of(origin: IVec3) -> u64 {
    let (bits, log2) = (KEY_BITS, ROOT_EDGE);
    let [x, y, z] = (origin.to_array()).map(|i| u64::from(i.cast_unsigned() >> log2));
    x << (2 * bits) | y << bits | z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_name_places() {
        for origin in [
            IVec3::ZERO,
            IVec3::new(-4096, 8192, i32::MIN),
            IVec3::splat(0x7fff_f000),
        ] {
            assert_eq!(origin_of(key_of(origin)), Ok(origin));
        }
        assert!(origin_of(1 << 20).is_err());
    }

    #[test]
    fn codes_are_little_endian() {
        let codes = Bytes(&[0b1010_0110, 0x12]);
        let read = |log2, i| code(codes, i, log2).unwrap();
        assert_eq!([0, 1, 2, 7].map(|i| read(0, i)), [0.0, 1.0, 1.0, 1.0]);
        assert_eq!([0, 1, 3].map(|i| read(1, i)), [2.0, 1.0, 2.0]);
        assert_eq!([0, 1, 2].map(|i| read(2, i)), [6.0, 10.0, 2.0]);
        assert_eq!([0, 1].map(|i| read(3, i)), [166.0, 18.0]);
        assert_eq!(read(4, 0), f32::from(0x12a6_u16));
        assert!(code(codes, 0, 5).is_err() && code(codes, 2, 3).is_err());
    }
}
