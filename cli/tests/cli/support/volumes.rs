//! Volume files to feed to the command.

use glam::{DAffine3, DVec3, IVec3};
use std::fs;
use tyndall_core::Rgb;
use tyndall_media::{SparseBuilder, TileSize};
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, write_open_vdb};

/// Voxels of 0.5 × 0.25 × 1, voxel (0, 0, 0) around (1, 2, 3).
pub(crate) fn placed() -> DAffine3 {
    DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))
        * DAffine3::from_scale(DVec3::new(0.5, 0.25, 1.0))
}

/// Two voxels, 1 and 3, and a tile of 8³ times 0.5.
pub(crate) fn density(to_world: DAffine3) -> VolumeGrid {
    let mut grid = SparseBuilder::new(0.0);
    grid.voxel(IVec3::new(-3, 1, 2), 1.0).expect("a place");
    grid.voxel(IVec3::new(4, 2, 5), 3.0).expect("a place");
    grid.tile(IVec3::new(8, 0, 0), TileSize::Leaf, 0.5, true)
        .expect("a place");
    let grid = grid.build(to_world).expect("a grid");
    VolumeGrid::new("density", GridClass::FogVolume, Voxels::Scalar(grid))
}

/// One voxel of a colour.
pub(crate) fn colour(name: &str) -> VolumeGrid {
    let mut grid = SparseBuilder::new(Rgb::default());
    let colour = Rgb::new(0.25, 0.5, 0.75);
    grid.voxel(IVec3::new(1, 2, 3), colour).expect("a place");
    let grid = grid.build(DAffine3::IDENTITY).expect("a grid");
    VolumeGrid::new(name, GridClass::Unknown, Voxels::Vector(grid))
}

/// The distance to the plane x = 0 within 3 voxels, a tile of −3 on its inner side and no more.
pub(crate) fn plane() -> VolumeGrid {
    let mut grid = SparseBuilder::new(3.0);
    for (x, y, z) in (0..7 * 64).map(|i| (i / 64 - 3, i / 8 % 8, i % 8)) {
        let place = IVec3::new(x, y, z);
        grid.voxel(place, x as f32).expect("a place");
    }
    grid.tile(IVec3::new(-16, 0, 0), TileSize::Leaf, -3.0, false)
        .expect("a place");
    let grid = grid.build(DAffine3::IDENTITY).expect("a grid");
    VolumeGrid::new("surface", GridClass::LevelSet, Voxels::Scalar(grid))
}

/// The bytes of an OpenVDB file.
pub(crate) fn vdb(grids: &[VolumeGrid]) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.vdb");
    write_open_vdb(&path, grids).expect("a file");
    fs::read(path).expect("a file")
}

/// Such a file whose last grid, a scalar one, is said to be of integers.
pub(crate) fn with_integers(grids: &[VolumeGrid]) -> Vec<u8> {
    let mut bytes = vdb(grids);
    let kind = b"Tree_float_5_4_3";
    let at = bytes.windows(kind.len()).rposition(|window| window == kind);
    let at = at.expect("a scalar grid") + b"Tree_".len();
    bytes[at..at + 5].copy_from_slice(b"int32");
    bytes
}

/// A `.vol` file of a box from 0 to 1.
pub(crate) fn vol(resolution: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let [x, y, z] = resolution;
    bytes.extend(
        [1, x, y, z, channels]
            .into_iter()
            .flat_map(i32::to_le_bytes),
    );
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0];
    bytes.extend(corners.iter().chain(values).flat_map(|x| x.to_le_bytes()));
    bytes
}
