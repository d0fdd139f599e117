//! OpenVDB files, versions 222 to 225 (Museth 2013, "VDB: High-Resolution Sparse Volumes with Dynamic
//! Topology"; the format as OpenVDB 3 to 13 write it).

mod codec;
mod cursor;
mod format;
mod grid;
mod map;
mod mask;
mod tree;
mod write;

pub(super) use write::write;

use super::message::{in_grid, shown};
use super::{VolumeGrid, Voxels, Wanted};
use cursor::Cursor;
use glam::DAffine3;
use grid::Grid;
pub(super) use grid::SEPARATOR;
use half::f16;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use tyndall_core::Spectrum;

pub(super) const MAGIC: [u8; 8] = [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];
/// Characters of the name that a file gives itself.
const UUID: usize = 36;

/// The grids of a file; those that are not `wanted` without their voxels. What is wrong is said in a
/// sentence that names the grid and the mend.
pub(super) fn read(bytes: &[u8], wanted: &Wanted<'_>) -> Result<Vec<VolumeGrid>, String> {
    let mut archive = Archive::read(bytes)?;
    let count = archive.grids.len();
    let read = |i: usize| {
        let grid = &archive.grids[i];
        let mut found = VolumeGrid {
            name: grid.name.clone(),
            class: grid.class,
            kind: grid.kind(),
            unsupported: grid.unsupported(),
            voxels: Voxels::Unread,
        };
        if wanted(&found) {
            let voxels = archive.voxels(i);
            found.voxels = voxels.map_err(|e| in_grid(found.name.as_bytes(), e))?;
        }
        Ok(found)
    };
    (0..count).map(read).collect()
}

/// All grids of a file.
struct Archive<'a> {
    grids: Vec<Grid<'a>>,
    /// Those with a tree of their own, by their unique names.
    own: HashMap<&'a [u8], usize>,
    /// The trees that have been read.
    trees: HashMap<usize, Voxels>,
}

impl<'a> Archive<'a> {
    fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let mut cursor = Cursor::new(bytes);
        cursor.take(MAGIC.len())?;
        let version = cursor.u32()?;
        if !(222..=225).contains(&version) {
            return Err(format!(
                "it is of version {version} of OpenVDB's format, 222 to 225 are read: export it with OpenVDB 3 to 13"
            ));
        }
        let _library: [u8; 8] = cursor.array()?;
        let offsets = cursor.u8()? != 0;
        cursor.take(UUID)?;
        grid::metadata(&mut cursor, |_, _| {})?;
        let count = cursor.u32()?;
        let mut archive = Self {
            grids: Vec::new(),
            own: HashMap::new(),
            trees: HashMap::new(),
        };
        for left in (0..count).rev() {
            let grid = Grid::read(&mut cursor, offsets)?;
            if !offsets {
                archive.pass(&grid, &mut cursor, left)?;
            }
            if grid.parent.is_empty() {
                archive.own.insert(grid.unique, archive.grids.len());
            }
            archive.grids.push(grid);
        }
        Ok(archive)
    }

    /// Passes the tree of the next grid in a file that does not say where it ends: only reading it
    /// tells. So many grids are `left` behind it.
    fn pass(&mut self, grid: &Grid<'a>, cursor: &mut Cursor<'a>, left: u32) -> Result<(), String> {
        match grid.unsupported() {
            None if grid.parent.is_empty() => {
                let tree = grid
                    .tree_at(cursor)
                    .map_err(|e| in_grid(grid.name.as_bytes(), e))?;
                self.trees.insert(self.grids.len(), tree);
            }
            Some(why) if left > 0 => {
                let hides = format!(
                    "{why}, or write the file as one with offsets: it is a stream, in which this grid hides {left} more"
                );
                return Err(in_grid(grid.name.as_bytes(), hides));
            }
            _ => {}
        }
        Ok(())
    }

    /// The voxels of a grid.
    fn voxels(&mut self, i: usize) -> Result<Voxels, String> {
        let grid = &self.grids[i];
        let to_world = grid.to_world.clone()?;
        let source = match (grid.parent, self.own.get(grid.parent)) {
            (b"", _) => i,
            (_, Some(source)) => *source,
            (parent, None) => {
                return Err(format!(
                    "it shares the tree of `{}`, which is not there: export it on its own",
                    shown(parent)
                ));
            }
        };
        let tree = match self.trees.entry(source) {
            Entry::Occupied(tree) => tree.into_mut(),
            Entry::Vacant(place) => place.insert(self.grids[source].tree()?),
        };
        placed(tree.clone(), to_world)
    }
}

/// The same voxels elsewhere.
fn placed(voxels: Voxels, to_world: DAffine3) -> Result<Voxels, String> {
    let placed = match voxels {
        Voxels::Scalar(grid) => grid.placed(to_world).map(Voxels::Scalar),
        Voxels::Vector(grid) => grid.placed(to_world).map(Voxels::Vector),
        Voxels::Unread => Ok(Voxels::Unread),
    };
    placed.map_err(|problem| format!("{problem}, and export it again"))
}

/// Whether halves can say this value.
fn is_half<T: Spectrum>(value: T) -> bool {
    let halves = value.map(|x| f16::from_f32(x).to_f32());
    (0..T::CHANNELS).all(|c| halves.channel(c).to_bits() == value.channel(c).to_bits())
}
