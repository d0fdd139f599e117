//! Trees in the form 5-4-3: first the nodes with their tiles and the masks of their leaves, depth
//! first, then the voxels of the leaves in the same order.

use super::cursor::Cursor;
use super::format::Format;
use super::{is_half, mask};
use crate::volume::level::{LEAF_WORDS, LOWER, Level, ROOT_EDGE, UPPER, VOXELS, misplaced};
use glam::{DAffine3, IVec3};
use tyndall_core::Spectrum;
use tyndall_media::{Precision, SparseBuilder, SparseGrid, TileSize};

/// Words of the masks of nodes.
const LOWER_WORDS: usize = LOWER.count() / 64;
const UPPER_WORDS: usize = UPPER.count() / 64;

struct Reader<'c, 'a, T> {
    cursor: &'c mut Cursor<'a>,
    format: Format,
    background: T,
    builder: SparseBuilder<T>,
    /// Their first voxels.
    leaves: Vec<IVec3>,
}

/// Reads a tree, of which a voxel is a unit long.
pub(super) fn read<T: Spectrum>(
    cursor: &mut Cursor,
    format: Format,
) -> Result<SparseGrid<T>, String> {
    let buffers = cursor.u32()?;
    if buffers != 1 {
        return Err(format!(
            "it has {buffers} values a voxel in place of 1: export it again"
        ));
    }
    let background = format.value(cursor)?;
    // Where voxels are halves, the background need not be one.
    let precision = if format.is_half() && is_half(background) {
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
    (reader.builder.build(DAffine3::IDENTITY)).map_err(|e| e.to_string())
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
            self.node::<UPPER_WORDS>(origin, UPPER)?;
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
                "it has a node at {origin}, not a multiple of 4096: the file is damaged, export it again"
            ))
        }
    }

    fn node<const W: usize>(&mut self, origin: IVec3, level: Level) -> Result<(), String> {
        let (children, active) = (self.cursor.mask::<W>()?, self.cursor.mask::<W>()?);
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
                TileSize::Lower => self.node::<LOWER_WORDS>(origin, LOWER)?,
                _ => {
                    // Its mask is written once more with its voxels, and that one counts.
                    self.cursor.mask::<LEAF_WORDS>()?;
                    self.leaves.push(origin);
                }
            }
        }
        Ok(())
    }

    /// The voxels of the leaves.
    fn voxels(&mut self) -> Result<(), String> {
        let mut values = Box::new([self.background; VOXELS]);
        for origin in std::mem::take(&mut self.leaves) {
            let active = self.cursor.mask::<LEAF_WORDS>()?;
            (self.format).values(self.cursor, &active, self.background, &mut values[..])?;
            (self.builder.leaf(origin, &values, active)).map_err(misplaced)?;
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
        (self.builder.tile(origin, size, value, active)).map_err(misplaced)
    }
}
