//! NanoVDB files.
//!
//! A file is a row of segments: a header, a description and a name for each grid, then their buffers,
//! each packed on its own. Or it is a buffer itself, as versions from 32.6 on may write. All is
//! little-endian.
//!
//! Source: Museth 2021, "NanoVDB: A GPU-Friendly and Portable VDB Data Structure for Real-Time
//! Rendering and Simulation"; the documentation of NanoVDB 32.

mod codec;
mod file;
mod grid;
mod layout;
mod summary;
mod tree;
mod write;

use super::message::in_grid;
use super::{VolumeGrid, Voxels, Wanted};
pub(super) use write::write;

/// What every such file begins with; the digit after it tells segments and buffers apart, in later
/// versions.
pub(super) const MAGIC: &[u8] = b"NanoVDB";
/// Of a buffer, in later versions.
const GRID_MAGIC: &[u8] = b"NanoVDB1";
/// The version of the layout.
const MAJOR: u32 = 32;

/// How the grids of a NanoVDB file are packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NanoCodec {
    /// Not at all: for a reader that maps the file into memory.
    None,
    /// By zlib.
    #[default]
    Zip,
}

/// The grids of a file; those that are not `wanted` without their voxels. What is wrong is said in a
/// sentence that names the grid and the mend.
///
/// Read are float, double, Vec3f, Vec3d and the quantised Fp4, Fp8, Fp16 and `FpN`, all as `f32`. Blind
/// data and checksums are passed over, and so are inactive tiles that equal the background.
pub(super) fn read(bytes: &[u8], wanted: &Wanted<'_>) -> Result<Vec<VolumeGrid>, String> {
    let read = |entry: file::Entry<'_>| {
        let mut found = VolumeGrid {
            name: entry.name.clone(),
            class: grid::class(entry.class),
            kind: layout::name(entry.kind).to_owned(),
            unsupported: layout::Layout::of(entry.kind).err(),
            voxels: Voxels::Unread,
        };
        if wanted(&found) {
            let voxels = grid::voxels(&entry);
            found.voxels = voxels.map_err(|problem| in_grid(entry.name.as_bytes(), problem))?;
        }
        Ok(found)
    };
    file::entries(bytes)?.into_iter().map(read).collect()
}
