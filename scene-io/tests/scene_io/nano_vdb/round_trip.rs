//! What is written is read back to the bit, and its header tells the truth.

use super::others::moments;
use super::{
    DESCRIPTION, HEADER, TREE, as_scalar, buffer_start, content, f32_at, f64_at, read, scalar,
    u32_at, u64_at, write,
};
use glam::{DAffine3, DMat3, DVec3, IVec3};
use tyndall_core::{Rgb, Sampler, Spectrum};
use tyndall_media::{Precision, SparseBuilder, SparseGrid, TileSize};
use tyndall_scene_io::{GridClass, NanoCodec, VolumeGrid, Voxels};
use tyndall_testkit::rng;

/// Leaves and tiles of all sizes among a few roots, either side of 0 and at both ends of the axes.
pub(super) fn random<T: Spectrum>(seed: u64, leaves: usize) -> SparseGrid<T> {
    let mut u = rng(seed);
    let mut next = move || u.next_1d();
    let mut builder = SparseBuilder::new(T::from_channels(|_| next()));
    let at = |edge: i32, next: &mut dyn FnMut() -> f32| {
        let block = [-8192.0, 4096.0, i32::MIN as f32, 2_147_479_552.0][(4.0 * next()) as usize];
        let axis = |x: f32| (x * 300.0) as i32 & !(edge - 1);
        IVec3::splat(block as i32) + IVec3::new(axis(next()), axis(next()), axis(next()))
    };
    for _ in 0..leaves {
        let origin = at(8, &mut next);
        let mut values = [T::default(); 512];
        values.fill_with(|| T::from_channels(|_| next() * 4.0 - 1.0));
        let active =
            [0; 8].map(|_: u64| u64::from((next() * 1e6) as u32) << (40.0 * next()) as u32);
        let size = TileSize::Leaf;
        // What is taken stays as it is.
        let _ = builder.leaf(origin, &values, active);
        let value = T::from_channels(|_| next() - 0.5);
        let _ = builder.tile(at(8, &mut next), size, value, next() < 0.5);
    }
    for i in 0..3 {
        let value = T::from_channels(|_| next() - 0.5);
        let far = IVec3::new(i * 128, 1024, 2048 - 128 * i);
        let _ = builder.tile(far, TileSize::Lower, value, next() < 0.7);
        let farther = IVec3::new(-4096, 4096 * i, 16_384);
        let _ = builder.tile(farther, TileSize::Upper, value, next() < 0.7);
    }
    let mut number = || f64::from(next()) * 2.0 - 1.0;
    let matrix = DMat3::from_cols_array(&[0.0; 9].map(|_| number())) + 2.0 * DMat3::IDENTITY;
    let translation = DVec3::new(number(), number(), 1e6 * number());
    let to_world = DAffine3::from_mat3_translation(matrix, translation);
    builder.build(to_world).unwrap()
}

#[test]
fn grids_come_back() {
    for seed in 0..4 {
        for codec in [NanoCodec::None, NanoCodec::Zip] {
            let grids = [
                scalar("density", random(seed, 20)),
                VolumeGrid::new(
                    "velocity",
                    GridClass::Staggered,
                    Voxels::Vector(random::<Rgb>(seed + 100, 10)),
                ),
                VolumeGrid::new("sdf", GridClass::LevelSet, Voxels::Scalar(random(seed, 0))),
            ];
            let back = read(&write(&grids, codec)).unwrap();
            assert_eq!(back.len(), grids.len());
            for (a, b) in grids.iter().zip(&back) {
                assert_eq!((&a.name, a.class), (&b.name, b.class));
                match (b.kind.as_str(), &a.voxels, &b.voxels) {
                    ("float", Voxels::Scalar(a), Voxels::Scalar(b)) => {
                        assert_eq!(content(a), content(b));
                    }
                    ("Vec3f", Voxels::Vector(a), Voxels::Vector(b)) => {
                        assert_eq!(content(a), content(b));
                    }
                    _ => panic!("{} changed its type", a.name),
                }
            }
        }
    }
}

#[test]
fn small_grids_come_back() {
    let mut one = SparseBuilder::new(0.0_f32);
    one.voxel(IVec3::new(-1, 5, i32::MIN), 3.0).unwrap();
    let mut tiles = SparseBuilder::new(1.0_f32);
    let corner = IVec3::splat(i32::MIN);
    tiles.tile(corner, TileSize::Lower, 2.0, false).unwrap();
    // Active, though of the background's value.
    tiles.tile(IVec3::ZERO, TileSize::Leaf, 1.0, true).unwrap();
    let mut half = SparseBuilder::new(0.0_f32).with_precision(Precision::Half);
    half.voxel(IVec3::ZERO, 0.1).unwrap();
    for builder in [SparseBuilder::new(7.0), one, tiles, half] {
        let grid = builder.build(DAffine3::IDENTITY).unwrap();
        let back = read(&write(&[scalar("a", grid.clone())], NanoCodec::Zip)).unwrap();
        assert_eq!(content(as_scalar(&back[0])), content(&grid));
    }
}

#[test]
fn unwanted_grids_stay_unread() {
    let grids = ["a", "b", "a"].map(|name| scalar(name, random(1, 1)));
    let bytes = write(&grids, NanoCodec::Zip);
    let back = super::read_wanted(&bytes, |name| name == "b").unwrap();
    let read = back
        .iter()
        .map(|grid| matches!(grid.voxels, Voxels::Scalar(_)));
    assert_eq!(read.collect::<Vec<_>>(), [false, true, false]);
    assert!(back.iter().all(|grid| grid.kind == "float"));
}

#[test]
fn headers_tell_the_truth() {
    check_header(random(5, 30));
    let mut few = SparseBuilder::new(0.0_f32);
    for x in [-9, 3] {
        few.voxel(IVec3::new(x, 5, 7), 1.0 + x as f32).unwrap();
    }
    let matrix = DMat3::from_cols_array(&[1.0, 0.5, 0.0, 0.0, -2.0, 0.0, 0.25, 0.0, 3.0]);
    let to_world = DAffine3::from_mat3_translation(matrix, DVec3::new(100.0, 0.0, -7.0));
    check_header(few.build(to_world).unwrap());
}

/// Offsets of NanoVDB 32, written here once more.
fn check_header(grid: SparseGrid<f32>) {
    let file = write(&[scalar("density", grid.clone())], NanoCodec::None);
    let buffer = &file[buffer_start(&file)..];
    let ours = grid.statistics();
    let root = TREE + u64_at(buffer, TREE + 24) as usize;
    assert_eq!(u64_at(&file, HEADER), buffer.len() as u64);
    assert_eq!(u64_at(buffer, 32), buffer.len() as u64);
    assert_eq!(u64_at(buffer, 8), u64::MAX, "no checksum");
    assert_eq!(
        &file[HEADER + DESCRIPTION..buffer_start(&file)],
        b"density\0"
    );
    assert_eq!(&buffer[40..48], b"density\0");
    assert_eq!(u64_at(buffer, TREE + 56), ours.voxels);
    assert_eq!(u64_at(&file, HEADER + 24), ours.voxels);
    assert_eq!(f32_at(buffer, root + 32), ours.min);
    assert_eq!(f32_at(buffer, root + 36), ours.max);
    // One rounding to 32 bits, half of 1.2e-7, and sums of 64 bits.
    let [mean, deviation] = moments(&grid);
    for (at, exact) in [(40, mean), (44, deviation)] {
        let stated = f64::from(f32_at(buffer, root + at));
        assert!(
            (stated - exact).abs() <= 1e-7 * exact.abs(),
            "{stated} for {exact}"
        );
    }
    assert_eq!(u32_at(buffer, TREE + 32) as usize, grid.leaf_count());
    let [first, last] = active_box(&grid);
    let corner = |at| IVec3::from([0, 4, 8].map(|i| u32_at(buffer, root + at + i).cast_signed()));
    assert_eq!([corner(0), corner(12)], [first, last]);
    let ends = [first.as_dvec3(), last.as_dvec3() + 1.0];
    for axis in 0..3 {
        let row = grid.to_world().matrix3.row(axis);
        let from = grid.to_world().translation[axis];
        let sides = [0, 1, 2].map(|i| ends.map(|end| row[i] * end[i]));
        let least: f64 = sides.iter().map(|[a, b]| a.min(*b)).sum();
        let most: f64 = sides.iter().map(|[a, b]| a.max(*b)).sum();
        for (i, exact) in [(axis, from + least), (axis + 3, from + most)] {
            let stated = f64_at(buffer, 560 + 8 * i);
            assert!(
                (stated - exact).abs() <= 1e-12 * exact.abs(),
                "{stated} for {exact}"
            );
            assert_eq!(stated, f64_at(&file, HEADER + 40 + 8 * i));
        }
        let size = grid.to_world().matrix3.col(axis).length();
        assert_eq!(f64_at(buffer, 608 + 8 * axis), size);
    }
}

fn active_box(grid: &SparseGrid<f32>) -> [IVec3; 2] {
    let mut bounds = [IVec3::MAX, IVec3::MIN];
    let mut add = |first: IVec3, last: IVec3| {
        bounds = [bounds[0].min(first), bounds[1].max(last)];
    };
    grid.visit(|origin, piece| match piece {
        tyndall_media::Piece::Tile { edge, tile } => {
            if tile.active {
                add(origin, origin + (edge - 1));
            }
        }
        tyndall_media::Piece::Leaf { active, .. } => {
            for i in (0..512).filter(|i| active[i / 64] >> (i % 64) & 1 == 1) {
                let i = i as i32;
                let voxel = origin + IVec3::new(i >> 6, (i >> 3) & 7, i & 7);
                add(voxel, voxel);
            }
        }
    });
    bounds
}

/// NanoVDB's own check refuses fog and level sets of vectors, and what is staggered of numbers.
#[test]
fn classes_are_those_of_the_values() {
    let classes = [
        GridClass::Unknown,
        GridClass::FogVolume,
        GridClass::LevelSet,
        GridClass::Staggered,
    ];
    let back = |class, voxels: Voxels| {
        let file = write(&[VolumeGrid::new("a", class, voxels)], NanoCodec::None);
        // Of the header and the description.
        let code = u32_at(&file, buffer_start(&file) + 632);
        assert_eq!(u32_at(&file, HEADER + 36), code);
        (read(&file).unwrap()[0].class, code)
    };
    let numbers = classes.map(|class| back(class, Voxels::Scalar(random(1, 1))));
    let vectors = classes.map(|class| back(class, Voxels::Vector(random(1, 1))));
    let unknown = (GridClass::Unknown, 0);
    let [fog, level_set] = [(GridClass::FogVolume, 2), (GridClass::LevelSet, 1)];
    assert_eq!(numbers, [unknown, fog, level_set, unknown]);
    let staggered = (GridClass::Staggered, 3);
    assert_eq!(vectors, [unknown, unknown, unknown, staggered]);
}
