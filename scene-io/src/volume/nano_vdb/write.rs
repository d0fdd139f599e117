//! Writes files: a segment for each grid, as NanoVDB's own tools do.

mod buffer;
mod header;
mod nodes;
mod skeleton;

use super::NanoCodec;
use super::codec::{NONE, ZIP, zip};
use super::grid::class_code;
use super::layout::{FLOAT, Layout, VEC3F, grid};
use crate::volume::{VolumeGrid, Voxels};
use header::About;
use skeleton::Skeleton;
use std::io::Write;
use tyndall_core::Spectrum;
use tyndall_media::SparseGrid;

/// Version 32.4.2, that of OpenVDB 10: what reads any 32 reads it.
const VERSION: u32 = (32 << 21) | (4 << 10) | 2;
const MAGIC: &[u8] = b"NanoVDB0";

/// Writes grids as float and Vec3f; half precision becomes float, which loses nothing. No checksums
/// are written.
///
/// # Errors
/// What is wrong with which grid, or with writing.
pub(crate) fn write(
    out: &mut dyn Write,
    grids: &[VolumeGrid],
    codec: NanoCodec,
) -> Result<(), String> {
    if grids.is_empty() {
        return Err("there is no grid to write: name one at least".into());
    }
    for grid in grids {
        let written = match &grid.voxels {
            Voxels::Scalar(voxels) => segment(out, grid, voxels, FLOAT, codec),
            Voxels::Vector(voxels) => segment(out, grid, voxels, VEC3F, codec),
            Voxels::Unread => Err("its voxels were not read: ask for it by name".into()),
        };
        written.map_err(|problem| format!("grid `{}`: {problem}", grid.name))?;
    }
    Ok(())
}

fn segment<T: Spectrum>(
    out: &mut dyn Write,
    grid: &VolumeGrid,
    voxels: &SparseGrid<T>,
    kind: u32,
    codec: NanoCodec,
) -> Result<(), String> {
    let name = grid.name.as_bytes();
    if name.len() >= grid::NAME_LENGTH || name.contains(&0) {
        return Err(format!(
            "its name has {} bytes: give it one of at most {} without zeros",
            name.len(),
            grid::NAME_LENGTH - 1
        ));
    }
    let layout = Layout::of(kind).ok_or("has no layout")?;
    let skeleton = Skeleton::of(voxels);
    let (mut buffer, places, summary) = nodes::lay_out(voxels, &skeleton, layout)?;
    let about = About {
        name,
        kind,
        class: class_code(grid.class),
        to_world: voxels.to_world(),
        bounds: summary.bounds,
        voxels: summary.voxels,
        nodes: skeleton.counts().map(|n| n as u32),
        tiles: skeleton.tiles().map(|n| n as u32),
        places,
    };
    about.put(&mut buffer);
    let failed = |e: std::io::Error| e.to_string();
    let packed;
    let (stored, codec) = match codec {
        NanoCodec::None => (buffer.bytes(), NONE),
        NanoCodec::Zip => {
            packed = zip(buffer.bytes()).map_err(failed)?;
            (packed.as_slice(), ZIP)
        }
    };
    let description = about.describe(stored.len(), codec)?;
    out.write_all(description.bytes()).map_err(failed)?;
    out.write_all(stored).map_err(failed)
}
