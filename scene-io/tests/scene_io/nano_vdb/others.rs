//! Files that NanoVDB itself wrote: see make.cpp.

use super::{
    HEADER, TREE, as_scalar, buffer_start, f32_at, fixture, read, restored, u32_at, u64_at,
    unzipped,
};
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

/// The cloud of pbrt-v4-volumes, if `TYNDALL_TEAPOT` says where it lies; a file that is in no
/// repository.
#[test]
fn the_teapot_holds_what_its_header_says() {
    let Some(path) = std::env::var_os("TYNDALL_TEAPOT") else {
        return;
    };
    let path = Path::new(&path);
    let grids = read_volume(path, |name| name == "density").unwrap();
    let grid = as_scalar(&grids[0]);
    assert_eq!(grids[0].class, GridClass::FogVolume);
    let file = std::fs::read(path).unwrap();
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

/// A buffer with tiles of every size that are active, which make.cpp has none of: the first slots of the
/// first lower and upper node that hold no child, and a tile of the root behind those
/// that are there.
fn with_tiles(buffer: &[u8], number: &[u8], [lower_table, upper_table]: [usize; 2]) -> Vec<u8> {
    let mut buffer = buffer.to_vec();
    let place = |buffer: &[u8], i: usize| TREE + u64_at(buffer, TREE + 8 * i) as usize;
    for (level, slots, table) in [(1, 4096, lower_table), (2, 32_768, upper_table)] {
        let node = place(&buffer, level);
        let children = node + 32 + slots / 8;
        let is_free = |slot: &usize| buffer[children + slot / 8] >> (slot % 8) & 1 == 0;
        let slot = (0..slots).find(is_free).unwrap();
        buffer[node + 32 + slot / 8] |= 1 << (slot % 8);
        let stride = number.len().next_multiple_of(8);
        buffer[node + table + stride * slot..][..number.len()].copy_from_slice(number);
    }
    let root = place(&buffer, 3);
    let count = u32_at(&buffer, root + 24) as usize;
    buffer[root + 24] += 1;
    // Tiles end where the upper nodes begin; these and what follows keep their distance.
    let end = place(&buffer, 2);
    let size = if number.len() > 8 { 64 } else { 32 };
    let mut tile = vec![0; size];
    tile[..8].copy_from_slice(&1_u64.to_le_bytes());
    tile[16] = 1;
    tile[24..24 + number.len()].copy_from_slice(number);
    let children = (1..=count).map(|i| end - size * i + 8);
    for at in [TREE, TREE + 8, TREE + 16].into_iter().chain(children) {
        let moved = u64_at(&buffer, at) + size as u64;
        buffer[at..at + 8].copy_from_slice(&moved.to_le_bytes());
    }
    buffer.splice(end..end, tile);
    let length = buffer.len() as u64;
    buffer[32..40].copy_from_slice(&length.to_le_bytes());
    buffer
}

#[test]
fn tiles_of_64_bits_are_values() {
    let read = |name: &str, value: &[f64], tables| {
        let file = fixture(name);
        let number: Vec<_> = value.iter().flat_map(|x| x.to_le_bytes()).collect();
        let buffer = with_tiles(&unzipped(&file), &number, tables);
        let mut file = restored(&file, &buffer, 0);
        file[HEADER..HEADER + 8].copy_from_slice(&(buffer.len() as u64).to_le_bytes());
        super::read(&file).unwrap().remove(0)
    };
    let voxels = 200 + 8_u64.pow(3) + 128_u64.pow(3) + 4096_u64.pow(3);
    let double = read("double", &[-7.25], [1088, 8256]);
    let double = as_scalar(&double);
    let of = double.statistics();
    assert_eq!((of.voxels, of.min), (voxels, -7.25));
    assert_eq!(double.voxel(IVec3::new(0, 0, 4096)), -7.25);
    let vector = read("Vec3d", &[-7.25, 9.5, 10.75], [1120, 8288]);
    let Voxels::Vector(vector) = vector.voxels else {
        panic!()
    };
    assert_eq!(vector.statistics().voxels, voxels);
    let tile = Rgb::new(-7.25, 9.5, 10.75);
    assert_eq!(vector.voxel(IVec3::new(5, 6, 8191)), tile);
    let mut tiles = [0; 3];
    vector.visit(|_, piece| {
        if let Piece::Tile { edge, tile: found } = piece {
            assert_eq!((found.value, found.active), (tile, true));
            tiles[[8, 128, 4096].iter().position(|e| *e == edge).unwrap()] += 1;
        }
    });
    assert_eq!(tiles, [1, 1, 1]);
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
