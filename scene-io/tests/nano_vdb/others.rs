//! Files that NanoVDB itself wrote: see make.cpp.

use super::{TREE, as_scalar, buffer_start, f32_at, fixture, read, u32_at, u64_at, unzipped};
use glam::{DAffine3, DMat3, DVec3, IVec3};
use std::path::Path;
use tyndall_core::{Rgb, Spectrum};
use tyndall_media::{Piece, SparseGrid};
use tyndall_scene_io::{GridClass, Voxels, read_volume};

/// Voxel n of the files; no two are the same.
fn voxel(n: i32) -> IVec3 {
    IVec3::new((n * 37) % 20 - 10, (n * 61) % 18 + 120, (n * 13) % 16)
}

fn value(n: i32) -> f32 {
    ((n * 29) % 64) as f32 / 8.0 - 2.0
}

/// `error` bounds the rounding of quantised values.
fn check<T: Spectrum>(name: &str, grid: &SparseGrid<T>, error: f32) {
    let to_world = DAffine3 {
        matrix3: DMat3::from_cols(
            DVec3::new(0.5, 0.25, 0.0),
            DVec3::new(0.0, 2.0, 0.125),
            DVec3::new(-0.5, 0.0, 1.0),
        ),
        translation: DVec3::new(1.0, -2.0, 3.0),
    };
    assert_eq!(grid.to_world(), to_world, "{name}");
    assert_eq!(grid.statistics().voxels, 200, "{name}");
    for n in 0..200 {
        let read = grid.voxel(voxel(n));
        for c in 0..T::CHANNELS {
            let off = (read.channel(c) - value(n + c as i32)).abs();
            assert!(off <= error, "{name}: voxel {n} is off by {off}");
        }
    }
    let outside = grid.voxel(IVec3::new(-10, 127, 300));
    assert_eq!(outside, T::splat(0.5), "{name}");
}

#[test]
fn every_type_is_read() {
    // A code is rounded to the nearest one: half of the range of values, 7.875 at most, over the
    // number of steps.
    let half_step = |bits: i32| 7.875 / (2.0_f32.powi(bits) - 1.0) / 2.0 * 1.0001;
    let kinds = [
        ("float", "float", 0.0),
        ("blosc", "float", 0.0),
        ("double", "double", 0.0),
        ("Fp4", "Fp4", half_step(4)),
        ("Fp8", "Fp8", half_step(8)),
        ("Fp16", "Fp16", half_step(16)),
        // Chosen by NanoVDB so that no value is off by more than 0.01.
        ("FpN", "FpN", 0.01),
        ("Vec3f", "Vec3f", 0.0),
        ("Vec3d", "Vec3d", 0.0),
    ];
    for (name, kind, error) in kinds {
        let grids = read(&fixture(name)).unwrap();
        let [grid] = grids.as_slice() else {
            panic!("{name} has {} grids", grids.len());
        };
        assert_eq!((grid.name.as_str(), grid.kind.as_str()), (name, kind));
        assert_eq!(grid.class, GridClass::Unknown);
        match &grid.voxels {
            Voxels::Scalar(grid) => check::<f32>(name, grid, error),
            Voxels::Vector(grid) => check::<Rgb>(name, grid, error),
            _ => panic!("{name} was not read"),
        }
    }
}

/// The cloud of pbrt-v4-volumes, where it lies at hand; a file that is in no repository.
#[test]
fn the_teapot_holds_what_its_header_says() {
    let path = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../shared/data/teapot_cloud.nvdb"
    ));
    let path = std::env::var_os("TYNDALL_TEAPOT").map_or(path.to_owned(), Into::into);
    if !path.exists() {
        return;
    }
    let grids = read_volume(&path, |name| name == "density").unwrap();
    let grid = as_scalar(&grids[0]);
    assert_eq!(grids[0].class, GridClass::FogVolume);
    let file = std::fs::read(&path).unwrap();
    let buffer = unzipped(&file);
    let root = TREE + u64_at(&buffer, TREE + 24) as usize;
    let ours = grid.statistics();
    assert_eq!(ours.voxels, u64_at(&buffer, TREE + 56));
    assert_eq!(ours.voxels, u64_at(&file, 16 + 24));
    assert_eq!(ours.min, f32_at(&buffer, root + 32));
    assert_eq!(ours.max, f32_at(&buffer, root + 36));
    let [mean, deviation] = moments(grid);
    let close = |ours: f64, header: f32| (ours - f64::from(header)).abs() <= 1e-6 * ours;
    assert!(close(mean, f32_at(&buffer, root + 40)), "{mean}");
    assert!(close(deviation, f32_at(&buffer, root + 44)), "{deviation}");
    assert_eq!(grid.leaf_count() as u32, u32_at(&buffer, TREE + 32));
    assert!(buffer_start(&file) < file.len());
}

/// Mean and standard deviation of active voxels, in two passes.
pub(super) fn moments(grid: &SparseGrid<f32>) -> [f64; 2] {
    let sum = |f: &dyn Fn(f64) -> f64| {
        let (mut sum, mut count) = (0.0, 0.0);
        grid.visit(|_, piece| match piece {
            Piece::Tile { edge, tile } => {
                if tile.active {
                    let voxels = f64::from(edge).powi(3);
                    sum += f(tile.value.into()) * voxels;
                    count += voxels;
                }
            }
            Piece::Leaf { leaf, active } => {
                for (i, value) in grid.leaf_values(leaf).enumerate() {
                    if active[i / 64] >> (i % 64) & 1 == 1 {
                        sum += f(value.into());
                        count += 1.0;
                    }
                }
            }
        });
        sum / count
    };
    let mean = sum(&|x| x);
    [mean, sum(&|x| (x - mean).powi(2)).sqrt()]
}
