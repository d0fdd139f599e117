//! OpenVDB files, versions 222 to 225 (Museth 2013, "VDB: High-Resolution Sparse Volumes with Dynamic
//! Topology"; the format is what OpenVDB 10 reads and writes).

mod codec;
mod cursor;
mod format;
mod grid;
mod map;
mod mask;
mod tree;
mod write;

pub(super) use write::write;

use super::{VolumeGrid, Voxels, Wanted};
use cursor::Cursor;
use grid::{Grid, shown};
use std::collections::HashMap;

pub(super) const MAGIC: [u8; 8] = [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];
/// Characters of the name that a file gives itself.
const UUID: usize = 36;
/// How often a file may hold its own bytes again in grids that share a tree.
const MOST_INSTANCES: usize = 16;

/// The grids of a file; those that are not `wanted` without their voxels. What is wrong is said in a
/// sentence that names the grid and the mend.
pub(super) fn read(bytes: &[u8], wanted: &Wanted<'_>) -> Result<Vec<VolumeGrid>, String> {
    let grids = grids(bytes)?;
    let own = grids.iter().filter(|grid| grid.parent.is_empty());
    let own = own.map(|grid| (grid.unique, grid)).collect();
    let mut shared = 0;
    let read = |grid: &Grid| {
        let mut found = VolumeGrid {
            name: grid.name.clone(),
            class: grid.class,
            kind: grid.kind(),
            unsupported: grid.unsupported().map(|why| format!("it {why}")),
            voxels: Voxels::Unread,
        };
        if wanted(&found) {
            found.voxels = voxels(grid, &own, &mut shared, bytes.len())
                .map_err(|e| format!("grid `{}` {e}", shown(grid.name.as_bytes())))?;
        }
        Ok(found)
    };
    grids.iter().map(read).collect()
}

/// All grids, without their trees.
fn grids(bytes: &[u8]) -> Result<Vec<Grid<'_>>, String> {
    let mut cursor = Cursor::new(bytes);
    cursor.take(MAGIC.len())?;
    let version = cursor.u32()?;
    if !(222..=225).contains(&version) {
        return Err(format!(
            "is of version {version} of OpenVDB's format, 222 to 225 are read: export it with OpenVDB 3 to 13"
        ));
    }
    let _library: [u8; 8] = cursor.array()?;
    let offsets = cursor.u8()? != 0;
    cursor.take(UUID)?;
    grid::metadata(&mut cursor, |_, _| {})?;
    let count = cursor.u32()?;
    (0..count)
        .map(|_| Grid::read(&mut cursor, offsets))
        .collect()
}

/// The voxels of a grid. `own` are those with a tree of their own, by unique name; `shared` counts the
/// bytes of trees that were read for another grid, in a file of `length`.
fn voxels(
    grid: &Grid,
    own: &HashMap<&[u8], &Grid>,
    shared: &mut usize,
    length: usize,
) -> Result<Voxels, String> {
    if grid.parent.is_empty() {
        return grid.voxels(None);
    }
    let Some(parent) = own.get(grid.parent) else {
        return Err(format!(
            "shares the tree of `{}`, which is not there: export it on its own",
            shown(grid.parent)
        ));
    };
    *shared = shared.saturating_add(parent.tree_bytes());
    if *shared / MOST_INSTANCES > length {
        return Err(format!(
            "and others share trees of {shared} bytes in a file of {length}: export fewer of them"
        ));
    }
    grid.voxels(Some(parent))
}
