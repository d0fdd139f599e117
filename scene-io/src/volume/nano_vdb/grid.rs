//! The header of a grid.

use super::codec::unpack;
use super::file::{Entry, check_version};
use super::layout::{Layout, grid, map, name};
use super::{MAGIC, tree};
use crate::volume::bytes::Bytes;
use crate::volume::{GridClass, Voxels};
use glam::{DAffine3, DMat3, DVec3};
use tyndall_core::Spectrum;
use tyndall_media::SparseGrid;

/// What the classes of a file mean here.
const CLASSES: [GridClass; 4] = [
    GridClass::Unknown,
    GridClass::LevelSet,
    GridClass::FogVolume,
    GridClass::Staggered,
];

/// The class of this number.
pub(super) fn class(code: u32) -> GridClass {
    CLASSES.get(code as usize).copied().unwrap_or_default()
}

/// The number of a class of grids whose values have so many channels. NanoVDB takes level sets and
/// fog to be numbers, and what is staggered vectors; it refuses other pairs.
pub(super) fn class_code(class: GridClass, channels: usize) -> u32 {
    let is_vector = channels > 1;
    let fits = |c: GridClass| c == class && is_vector == (c == GridClass::Staggered);
    let code = CLASSES.iter().position(|&c| fits(c));
    code.unwrap_or(0) as u32
}

/// Reads the voxels of a grid.
pub(super) fn voxels(entry: &Entry<'_>) -> Result<Voxels, String> {
    let layout = Layout::of(entry.kind)?;
    let buffer = unpack(entry.codec, entry.stored, entry.size)?;
    let bytes = Bytes(&buffer);
    if !bytes.slice(0, MAGIC.len())?.starts_with(MAGIC) {
        return Err("its buffer is no NanoVDB grid: the file is damaged, export it again".into());
    }
    check_version(bytes.u32(grid::VERSION)?)?;
    let kind = bytes.u32(grid::TYPE)?;
    if kind != entry.kind {
        return Err(format!(
            "it is described as {} and holds {}: the file is damaged, export it again",
            name(entry.kind),
            name(kind)
        ));
    }
    Ok(match layout.channels {
        1 => Voxels::Scalar(sparse(bytes, layout)?),
        _ => Voxels::Vector(sparse(bytes, layout)?),
    })
}

/// Its tree, in its place.
fn sparse<T: Spectrum>(bytes: Bytes<'_>, layout: Layout) -> Result<SparseGrid<T>, String> {
    let number = |i: usize| bytes.f64(grid::MAP + map::MATRIX + size_of::<f64>() * i);
    let mut rows = [0.0; 9];
    for (i, x) in rows.iter_mut().enumerate() {
        *x = number(i)?;
    }
    let mut translation = DVec3::ZERO;
    for i in 0..3 {
        translation[i] = bytes.f64(grid::MAP + map::VECTOR + size_of::<f64>() * i)?;
    }
    let matrix = DMat3::from_cols_array(&rows).transpose();
    let to_world = DAffine3::from_mat3_translation(matrix, translation);
    let sparse = tree::read(bytes, layout)?.build(to_world);
    sparse.map_err(|problem| format!("{problem}, and export it again"))
}
