//! Reads the nodes of a grid.

use super::bytes::Bytes;
use super::layout::{LOG2, Layout, Leaves, NodeLayout, ROOT_TILES, VOXELS, grid, leaf, tile, tree};
use glam::IVec3;
use tyndall_core::Spectrum;
use tyndall_media::{SparseBuilder, TileSize};

/// Bits of a root key in each axis, and the voxels along the edge of what it names, as log₂.
const KEY: (u32, u32) = (21, 12);

/// The tree of the grid in a buffer.
pub(super) fn read<T: Spectrum>(
    bytes: Bytes<'_>,
    layout: Layout,
) -> Result<SparseBuilder<T>, String> {
    // Offsets of leaves, lower and upper nodes come first: children name themselves.
    let offset = bytes.i64(grid::END + tree::OFFSETS + 3 * size_of::<i64>())?;
    let root = place(grid::END, offset)?;
    let background = value(bytes, root.saturating_add(layout.background()), layout)?;
    let sizes = [layout.leaf(), layout.node(1).size, layout.node(2).size];
    let mut reader = Reader {
        bytes,
        layout,
        background,
        left: sizes.map(|size| bytes.0.len() / size),
        builder: SparseBuilder::new(background),
    };
    reader.root(root)?;
    Ok(reader.builder)
}

struct Reader<'a, T> {
    bytes: Bytes<'a>,
    layout: Layout,
    background: T,
    /// How many more leaves, lower and upper nodes the buffer has room for: children that share
    /// nodes would be endless.
    left: [usize; 3],
    builder: SparseBuilder<T>,
}

impl<T: Spectrum> Reader<'_, T> {
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
        let left = self.left[level].checked_sub(1);
        self.left[level] = left.ok_or("its nodes overlap: the file is damaged, export it again")?;
        match level {
            0 => self.leaf(at, origin),
            _ => self.node(at, origin, level),
        }
    }

    fn node(&mut self, at: usize, origin: IVec3, level: usize) -> Result<(), String> {
        let layout = self.layout.node(level);
        let node = Bytes(self.bytes.slice(at, layout.size)?);
        let size = [TileSize::Leaf, TileSize::Lower][level - 1];
        let table = node.slice(layout.table, layout.stride * layout.slots)?;
        for (slot, content) in table.chunks_exact(layout.stride).enumerate() {
            let here = origin + slot_origin(slot, level);
            if node.bit(layout.child_mask, slot)? {
                self.child(at, Bytes(content).i64(0)?, here, level - 1)?;
            } else {
                let active = node.bit(NodeLayout::VALUE_MASK, slot)?;
                self.tile(here, size, decode(content, self.layout), active)?;
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
        let placed = self.builder.tile(origin, size, value, active);
        placed.map_err(|problem| format!("{problem}: the file is damaged, export it again"))
    }

    fn leaf(&mut self, at: usize, origin: IVec3) -> Result<(), String> {
        let node = Bytes(self.bytes.slice(at, self.layout.leaf())?);
        let mut active = [0; 8];
        for (i, word) in active.iter_mut().enumerate() {
            *word = node.u64(leaf::MASK + size_of::<u64>() * i)?;
        }
        let mut values = [self.background; VOXELS];
        let log2 = match self.layout.leaves {
            Leaves::Values => {
                let size = self.layout.value();
                let all = node.slice(self.layout.leaf_values(), VOXELS * size)?;
                for (voxel, bytes) in values.iter_mut().zip(all.chunks_exact(size)) {
                    *voxel = decode(bytes, self.layout);
                }
                None
            }
            Leaves::Codes(log2) => Some(log2),
            Leaves::AnyCodes => Some(node.u8(leaf::FLAGS)? >> 5),
        };
        if let Some(log2) = log2 {
            let (minimum, quantum) = (node.f32(leaf::MINIMUM)?, node.f32(leaf::QUANTUM)?);
            let bytes = (VOXELS / 8) << log2;
            let codes = Bytes(self.bytes.slice(at + leaf::CODES, bytes)?);
            for (i, voxel) in values.iter_mut().enumerate() {
                *voxel = T::splat(code(codes, i, log2)? * quantum + minimum);
            }
        }
        let placed = self.builder.leaf(origin, &values, active);
        placed.map_err(|problem| format!("{problem}: the file is damaged, export it again"))
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
    let (bits, log2) = KEY;
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
    let (bits, log2) = KEY;
    let [x, y, z] = (origin.to_array()).map(|i| u64::from(i.cast_unsigned() >> log2));
    x << (2 * bits) | y << bits | z
}

/// Where a slot of a node begins, from the node's first voxel: x slowest.
pub(super) fn slot_origin(slot: usize, level: usize) -> IVec3 {
    let [slots, edge] = LOG2[level];
    let (slot, mask) = (slot as i32, (1 << slots) - 1);
    IVec3::new(slot >> (2 * slots), (slot >> slots) & mask, slot & mask) << edge
}

/// The slot of a node that holds a voxel.
pub(super) fn slot_of(voxel: IVec3, level: usize) -> usize {
    let [slots, edge] = LOG2[level];
    let [x, y, z] = ((voxel >> edge) & ((1 << slots) - 1)).to_array();
    ((x << (2 * slots)) | (y << slots) | z) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_slots_name_places() {
        for origin in [
            IVec3::ZERO,
            IVec3::new(-4096, 8192, i32::MIN),
            IVec3::splat(0x7fff_f000),
        ] {
            assert_eq!(origin_of(key_of(origin)), Ok(origin));
        }
        assert!(origin_of(1 << 20).is_err());
        for (level, slot) in [(1, 4095), (1, 17), (2, 32_767), (2, 1025), (0, 511)] {
            assert_eq!(slot_of(slot_origin(slot, level), level), slot);
        }
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
