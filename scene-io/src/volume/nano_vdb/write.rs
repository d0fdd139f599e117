//! Writes files: a segment for each grid, as NanoVDB's own tools do.

mod buffer;
mod header;
mod nodes;

use super::NanoCodec;
use super::codec::{NONE, ZIP, zip};
use super::grid::class_code;
use super::layout::{FLOAT, Layout, VEC3F};
use crate::volume::message::{UNREAD, in_grid};
use crate::volume::skeleton::Skeleton;
use crate::volume::{VolumeGrid, Voxels};
use header::About;
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
    for grid in grids {
        let written = match &grid.voxels {
            Voxels::Scalar(voxels) => segment(out, grid, voxels, FLOAT, codec),
            Voxels::Vector(voxels) => segment(out, grid, voxels, VEC3F, codec),
            Voxels::Unread => Err(UNREAD.into()),
        };
        written.map_err(|problem| in_grid(grid.name.as_bytes(), problem))?;
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
    let layout = Layout::plain(T::CHANNELS);
    let skeleton = Skeleton::of(voxels);
    let (mut buffer, places, summary) = nodes::lay_out(voxels, &skeleton, layout)?;
    let about = About {
        name: grid.name.as_bytes(),
        kind,
        class: class_code(grid.class, T::CHANNELS),
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
