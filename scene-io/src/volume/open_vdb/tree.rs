//! Trees in the form 5-4-3: first the nodes with their tiles and the masks of their leaves, depth
//! first, then the voxels of the leaves in the same order.

use super::cursor::Cursor;
use super::format::Format;
use super::mask;
use glam::{DAffine3, IVec3};
use tyndall_core::Spectrum;
use tyndall_media::{MediumError, Precision, SparseBuilder, SparseGrid, TileSize};

/// A kind of node with children.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// log₂ of the slots along an edge.
    pub(super) slots: i32,
    /// log₂ of the voxels along the edge of a slot.
    pub(super) edge: i32,
    /// What fills a slot without a child.
    tile: TileSize,
}

/// 32³ slots of 128³ voxels.
pub(super) const UPPER: Level = Level {
    slots: 5,
    edge: 7,
    tile: TileSize::Lower,
};
/// 16³ slots of 8³ voxels.
pub(super) const LOWER: Level = Level {
    slots: 4,
    edge: 3,
    tile: TileSize::Leaf,
};
/// log₂ of the voxels along the edge of an upper node.
pub(super) const ROOT_EDGE: i32 = 12;
/// Voxels of a leaf, and words of its mask.
pub(super) const VOXELS: usize = 512;
pub(super) const LEAF_WORDS: usize = VOXELS / 64;

impl Level {
    pub(super) fn count(self) -> usize {
        1 << (3 * self.slots)
    }

    /// The slot of a voxel: x slowest.
    pub(super) fn slot(self, ijk: IVec3) -> usize {
        let IVec3 { x, y, z } = (ijk >> self.edge) & ((1 << self.slots) - 1);
        ((x << (2 * self.slots)) | (y << self.slots) | z) as usize
    }

    /// The first voxel of a slot, from the node's first.
    fn origin(self, slot: usize) -> IVec3 {
        let (slot, mask) = (slot as i32, (1 << self.slots) - 1);
        let x = slot >> (2 * self.slots);
        IVec3::new(x, (slot >> self.slots) & mask, slot & mask) << self.edge
    }
}

struct Leaf {
    origin: IVec3,
    active: [u64; LEAF_WORDS],
}

struct Reader<'c, 'a, T> {
    cursor: &'c mut Cursor<'a>,
    format: Format,
    background: T,
    builder: SparseBuilder<T>,
    leaves: Vec<Leaf>,
}

/// Reads a tree.
pub(super) fn read<T: Spectrum>(
    cursor: &mut Cursor,
    format: Format,
    to_world: DAffine3,
) -> Result<SparseGrid<T>, String> {
    let buffers = cursor.u32()?;
    if buffers != 1 {
        return Err(format!(
            "has {buffers} values a voxel in place of 1: export it again"
        ));
    }
    let background = format.value(cursor)?;
    let precision = if format.is_half() {
        Precision::Half
    } else {
        Precision::Single
    };
    let mut reader = Reader {
        cursor,
        format,
        background,
        builder: SparseBuilder::new(background).with_precision(precision),
        leaves: Vec::new(),
    };
    reader.root()?;
    reader.voxels()?;
    (reader.builder.build(to_world)).map_err(|e| format!("has a transform of no use: {e}"))
}

impl<T: Spectrum> Reader<'_, '_, T> {
    fn root(&mut self) -> Result<(), String> {
        let (tiles, children) = (self.cursor.u32()?, self.cursor.u32()?);
        for _ in 0..tiles {
            let origin = self.root_origin()?;
            let value = self.format.value(self.cursor)?;
            let active = self.cursor.u8()? != 0;
            self.tile(origin, TileSize::Upper, value, active)?;
        }
        for _ in 0..children {
            let origin = self.root_origin()?;
            self.node(origin, UPPER)?;
        }
        Ok(())
    }

    /// That of an upper node; all voxels from there on can be counted.
    fn root_origin(&mut self) -> Result<IVec3, String> {
        let origin = IVec3::from(self.cursor.i32s::<3>()?);
        if origin & ((1 << ROOT_EDGE) - 1) == IVec3::ZERO {
            Ok(origin)
        } else {
            Err(format!(
                "has a node at {origin}, not a multiple of 4096: the file is broken, export it again"
            ))
        }
    }

    fn node(&mut self, origin: IVec3, level: Level) -> Result<(), String> {
        let words = level.count() / 64;
        let (children, active) = (self.cursor.mask(words)?, self.cursor.mask(words)?);
        let mut values = vec![self.background; level.count()];
        (self.format).values(self.cursor, &active, self.background, &mut values)?;
        for (slot, value) in values.into_iter().enumerate() {
            let origin = origin + level.origin(slot);
            let active = mask::contains(&active, slot);
            if !mask::contains(&children, slot) && (active || value != self.background) {
                self.tile(origin, level.tile, value, active)?;
            }
        }
        for slot in mask::slots(&children) {
            let origin = origin + level.origin(slot);
            match level.tile {
                TileSize::Lower => self.node(origin, LOWER)?,
                _ => {
                    let active = self.leaf_mask()?;
                    self.leaves.push(Leaf { origin, active });
                }
            }
        }
        Ok(())
    }

    fn leaf_mask(&mut self) -> Result<[u64; LEAF_WORDS], String> {
        let mut active = [0; LEAF_WORDS];
        active.copy_from_slice(&self.cursor.mask(LEAF_WORDS)?);
        Ok(active)
    }

    /// The voxels of the leaves, each after its mask once more.
    fn voxels(&mut self) -> Result<(), String> {
        let mut values = Box::new([self.background; VOXELS]);
        for Leaf { origin, active } in std::mem::take(&mut self.leaves) {
            self.leaf_mask()?;
            (self.format).values(self.cursor, &active, self.background, &mut values[..])?;
            (self.builder.leaf(origin, &values, active)).map_err(taken)?;
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
        (self.builder.tile(origin, size, value, active)).map_err(taken)
    }
}

/// Says why a node or tile could not be placed.
fn taken(error: MediumError) -> String {
    format!("has two nodes in one place: {error}: the file is broken, export it again")
}
