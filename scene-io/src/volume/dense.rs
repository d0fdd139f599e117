//! Dense grids of sparse ones, in `.vol` files, and back.

use super::{GridClass, VolumeGrid, Voxels};
use crate::vol::{Volume, header};
use glam::{DMat3, DVec3, IVec3};
use std::io::{self, Write};
use tyndall_core::{Aabb, Rgb, Spectrum};
use tyndall_media::{DenseGrid, Precision, SparseGrid};

/// The largest dense grid that is made of a sparse one, in voxels.
const MOST_VOXELS: i64 = 1 << 32;
/// How far from its place rounding may move a box, in voxels.
const MOST_SHIFT: f64 = 0.01;

/// The grid of a `.vol` file.
pub(super) fn sparse(volume: Volume) -> Result<VolumeGrid, String> {
    let [min, max] = volume.bounds.map(|corner| corner.as_vec3());
    let (bounds, resolution) = (Aabb { min, max }, volume.resolution);
    match volume.channels {
        1 => {
            let grid = grid(resolution, bounds, volume.values)?;
            Ok(VolumeGrid::new(
                "density",
                GridClass::FogVolume,
                Voxels::Scalar(grid),
            ))
        }
        3 => {
            let colours = volume.values.chunks_exact(3);
            let colours = colours.map(|c| Rgb::new(c[0], c[1], c[2])).collect();
            let grid = grid(resolution, bounds, colours)?;
            Ok(VolumeGrid::new(
                "albedo",
                GridClass::Unknown,
                Voxels::Vector(grid),
            ))
        }
        n => Err(format!("has {n} channels: write one of 1 or 3 channels")),
    }
}

fn grid<T: Spectrum>(
    resolution: [usize; 3],
    bounds: Aabb,
    values: Vec<T>,
) -> Result<SparseGrid<T>, String> {
    let dense = DenseGrid::new(resolution, bounds, values).map_err(|e| e.to_string())?;
    SparseGrid::from_dense(&dense, Precision::Single).map_err(|e| e.to_string())
}

/// Writes a grid as a `.vol` file.
pub(crate) fn write_dense(out: &mut dyn Write, grid: &VolumeGrid) -> Result<(), String> {
    let written = match (&grid.class, &grid.voxels) {
        (GridClass::LevelSet, _) => {
            Err("is a level set, and a .vol file is a density: make it fog first".into())
        }
        (_, Voxels::Scalar(voxels)) => write(out, voxels),
        (_, Voxels::Vector(voxels)) => write(out, voxels),
        (_, Voxels::Unread) => Err("has no voxels: read them first".into()),
    };
    written.map_err(|why| format!("grid `{}` {why}", grid.name))
}

/// Writes all that is not background, with one voxel of it around.
fn write<T: Spectrum>(out: &mut dyn Write, grid: &SparseGrid<T>) -> Result<(), String> {
    let Some([first, last]) = grid.content() else {
        return Err("is all background: there is nothing to write".into());
    };
    let [first, last] = [first.as_i64vec3() - 1, last.as_i64vec3() + 1];
    let size = last - first + 1;
    if size.as_dvec3().element_product() > MOST_VOXELS as f64 {
        return Err(format!(
            "would have {} × {} × {} voxels, of which at most {MOST_VOXELS} are written: keep it sparse",
            size.x, size.y, size.z
        ));
    }
    let [min, max] = corners(grid, first.as_dvec3() - 0.5, last.as_dvec3() + 0.5)?;
    let failed = |e: io::Error| e.to_string();
    let resolution = size.to_array().map(|n| n as usize);
    let header = header(resolution, T::CHANNELS, [min, max]);
    out.write_all(&header).map_err(failed)?;
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                let value = grid.voxel(IVec3::from([x, y, z].map(|i| i as i32)));
                for c in 0..T::CHANNELS {
                    out.write_all(&value.channel(c).to_le_bytes())
                        .map_err(failed)?;
                }
            }
        }
    }
    Ok(())
}

/// The box between two places in the grid, as a `.vol` file holds it.
fn corners<T: Spectrum>(
    grid: &SparseGrid<T>,
    first: DVec3,
    last: DVec3,
) -> Result<[[f32; 3]; 2], String> {
    let to_world = grid.to_world();
    let voxel = to_world.matrix3.diagonal();
    if to_world.matrix3 != DMat3::from_diagonal(voxel) || voxel.cmple(DVec3::ZERO).any() {
        return Err(
            "has voxels that are turned, sheared or mirrored, and a .vol file lies along the axes: write .vdb or .nvdb"
                .into(),
        );
    }
    let places = [first, last].map(|ijk| to_world.transform_point3(ijk));
    let rounded = places.map(|p| p.as_vec3());
    let shift = |i: usize| ((rounded[i].as_dvec3() - places[i]) / voxel).abs();
    if !shift(0).max(shift(1)).cmple(DVec3::splat(MOST_SHIFT)).all() {
        return Err(
            "is too far from the origin for the 32 bits of a .vol file: move it there, or write .vdb or .nvdb"
                .into(),
        );
    }
    Ok(rounded.map(|p| p.to_array()))
}
