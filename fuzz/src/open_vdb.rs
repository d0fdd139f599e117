//! OpenVDB files, all grids.
#![no_main]

use glam::{DAffine3, IVec3};
use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::NamedTempFile;
use tyndall_media::{MediumError, Precision, SparseBuilder, TileSize};
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, read_volume, write_open_vdb};

static FILE: LazyLock<NamedTempFile> = LazyLock::new(|| NamedTempFile::new().expect("a file"));

fn grid(precision: Precision) -> Result<VolumeGrid, MediumError> {
    let mut cloud = SparseBuilder::new(0.5).with_precision(precision);
    cloud.voxel(IVec3::new(1, 2, 3), 2.0)?;
    cloud.tile(IVec3::new(-8, 0, 0), TileSize::Leaf, 1.0, true)?;
    cloud.tile(IVec3::new(128, 0, 0), TileSize::Lower, 1.0, false)?;
    cloud.tile(IVec3::new(4096, 0, 0), TileSize::Upper, 1.0, true)?;
    let voxels = Voxels::Scalar(cloud.build(DAffine3::IDENTITY)?);
    Ok(VolumeGrid::new("density", GridClass::FogVolume, voxels))
}

fn seeds() -> Vec<Vec<u8>> {
    let seed = |precision| {
        let grid = grid(precision).expect("tiles that do not meet");
        write_open_vdb(FILE.path(), &[grid]).expect("the folder is writable");
        fs::read(FILE.path()).expect("what was written")
    };
    let mut seeds = vec![seed(Precision::Single), seed(Precision::Half)];
    // With Blosc in place of zip: broken, but in the right places.
    let mut blosc = seeds[0].clone();
    let flags = blosc.windows(4).position(|word| word == [3, 0, 0, 0]);
    blosc[flags.expect("compression flags")] = 6;
    seeds.push(blosc);
    seeds
}

fuzz_target!(init: tyndall_fuzz::start("open_vdb", &seeds()), |bytes: &[u8]| {
    fs::write(FILE.path(), bytes).expect("the file is writable");
    let _ = read_volume(FILE.path(), |_| true);
});
