//! NanoVDB files, all grids.
#![no_main]

use glam::{DAffine3, IVec3};
use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::NamedTempFile;
use tyndall_core::Rgb;
use tyndall_media::{MediumError, SparseBuilder, TileSize};
use tyndall_scene_io::{GridClass, NanoCodec, VolumeGrid, Voxels, read_volume, write_nano_vdb};

static FILE: LazyLock<NamedTempFile> = LazyLock::new(|| NamedTempFile::new().expect("a file"));

/// What NanoVDB itself wrote: every type, with Blosc too.
macro_rules! written_by_others {
    ($($name:literal),*) => {
        [$(include_bytes!(concat!("../../scene-io/tests/scene_io/nano_vdb/", $name, ".nvdb")).to_vec()),*]
    };
}

fn grids() -> Result<[VolumeGrid; 2], MediumError> {
    let mut cloud = SparseBuilder::new(0.5);
    cloud.voxel(IVec3::new(1, 2, 3), 2.0)?;
    cloud.tile(IVec3::new(-8, 0, 0), TileSize::Leaf, 1.0, true)?;
    cloud.tile(IVec3::new(128, 0, 0), TileSize::Lower, 1.0, false)?;
    cloud.tile(IVec3::new(4096, 0, 0), TileSize::Upper, 1.0, true)?;
    let density = Voxels::Scalar(cloud.build(DAffine3::IDENTITY)?);
    let mut wind = SparseBuilder::new(Rgb::default());
    wind.voxel(IVec3::new(-1, 2, 3), Rgb::new(1.0, -2.0, 3.0))?;
    let velocity = Voxels::Vector(wind.build(DAffine3::IDENTITY)?);
    Ok([
        VolumeGrid::new("density", GridClass::FogVolume, density),
        VolumeGrid::new("velocity", GridClass::Staggered, velocity),
    ])
}

fn seeds() -> Vec<Vec<u8>> {
    let grids = grids().expect("tiles that do not meet");
    let own = [NanoCodec::None, NanoCodec::Zip].map(|codec| {
        write_nano_vdb(FILE.path(), &grids, codec).expect("the folder is writable");
        fs::read(FILE.path()).expect("what was written")
    });
    let others = written_by_others!(
        "float", "double", "Fp4", "Fp8", "Fp16", "FpN", "Vec3f", "Vec3d", "int32", "blosc"
    );
    own.into_iter().chain(others).collect()
}

fuzz_target!(init: tyndall_fuzz::start("nano_vdb", &seeds()), |bytes: &[u8]| {
    fs::write(FILE.path(), bytes).expect("the file is writable");
    let _ = read_volume(FILE.path(), |_| true);
});
