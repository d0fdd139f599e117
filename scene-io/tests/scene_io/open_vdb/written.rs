//! What is written is read back, by this crate and by OpenVDB.

use super::encoder::{File, Grid};
use super::peer::{compare, described};
use super::read;
use glam::{DAffine3, DMat3, DVec3, IVec3};
use tyndall_core::{Rgb, Sampler, Spectrum};
use tyndall_media::{Piece, Precision, SparseBuilder, SparseGrid, TileSize};
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, read_volume, write_open_vdb};
use tyndall_testkit::rng;

/// Leaves of all kinds of inactive values, and tiles of all sizes. All are halves but, if asked for, one.
fn grid<T: Spectrum>(
    precision: Precision,
    background: f32,
    to_world: DAffine3,
    odd: f32,
) -> SparseGrid<T> {
    let value = |x: f32| T::from_channels(|c| x * (c + 1) as f32);
    let mut builder = SparseBuilder::new(value(background)).with_precision(precision);
    let mut random = rng(1);
    let mut integer = |n: f32| (random.next_1d() * n).floor();
    let minus = value(background).map(|x| -x);
    let off: [&[T]; 7] = [
        &[value(background)],
        &[minus],
        &[value(7.0)],
        &[value(background), minus],
        &[value(background), value(7.0)],
        &[value(7.0), value(9.0)],
        &[value(7.0), value(8.0), value(9.0)],
    ];
    for (i, off) in off.iter().enumerate() {
        for (j, share) in [0.0, 0.3, 1.0].into_iter().enumerate() {
            let mut active = [0; 8];
            let values = std::array::from_fn(|slot| {
                if integer(100.0) < 100.0 * share {
                    active[slot / 64] |= 1 << (slot % 64);
                    value(integer(64.0) / 32.0)
                } else {
                    off[integer(off.len() as f32) as usize]
                }
            });
            let at = IVec3::new(i as i32 - 3, j as i32, -1000 * j as i32);
            builder.leaf(8 * at, &values, active).unwrap();
        }
    }
    for (at, size, x, active) in [
        (IVec3::new(-4096, 0, 8192), TileSize::Upper, 0.25, true),
        (IVec3::new(-8192, 0, 8192), TileSize::Upper, 4.0, false),
        (IVec3::new(128, -128, 0), TileSize::Lower, 0.5, true),
        (IVec3::new(128, -256, 0), TileSize::Lower, 3.0, false),
        (IVec3::new(64, 64, 64), TileSize::Leaf, odd, true),
        (IVec3::new(64, 64, 72), TileSize::Leaf, 2.0, false),
    ] {
        builder.tile(at, size, value(x), active).unwrap();
    }
    builder.build(to_world).unwrap()
}

fn transforms() -> [DAffine3; 3] {
    let moved = DAffine3::from_translation(DVec3::new(1.0, -2.0, 3.5));
    let turned = DMat3::from_cols_array(&[2.0, 1.0, 0.0, 0.5, -3.0, 0.0, 0.0, 0.25, 4.0]);
    [
        DAffine3::from_scale(DVec3::splat(0.1)),
        moved * DAffine3::from_scale(DVec3::new(1.0, -2.0, 3.0)),
        moved * DAffine3::from_mat3(turned),
    ]
}

fn grids() -> Vec<VolumeGrid> {
    let mut grids = Vec::new();
    for (i, to_world) in transforms().into_iter().enumerate() {
        let background = [0.0, 1.5, 0.25][i];
        for precision in [Precision::Single, Precision::Half] {
            // A tile that is no half.
            let odd = if i == 2 { 0.1 } else { 0.125 };
            let scalar = grid(precision, background, to_world, odd);
            let vector = grid(precision, background, to_world, odd);
            let class = [
                GridClass::FogVolume,
                GridClass::LevelSet,
                GridClass::Unknown,
            ][i];
            grids.push(VolumeGrid::new("density", class, Voxels::Scalar(scalar)));
            let staggered = GridClass::Staggered;
            grids.push(VolumeGrid::new(
                format!("v{i}"),
                staggered,
                Voxels::Vector(vector),
            ));
        }
    }
    grids
}

/// All pieces of a grid, with their values.
fn pieces<T: Spectrum>(grid: &SparseGrid<T>) -> Vec<(IVec3, i32, Vec<T>, [u64; 8])> {
    let mut all = Vec::new();
    grid.visit(|origin, piece| {
        all.push(match piece {
            Piece::Leaf { leaf, active } => (origin, 1, grid.leaf_values(leaf).collect(), *active),
            Piece::Tile { edge, tile } => {
                (origin, edge, vec![tile.value], [u64::from(tile.active); 8])
            }
        });
    });
    all
}

fn same<T: Spectrum>(a: &SparseGrid<T>, b: &SparseGrid<T>) {
    assert_eq!(pieces(a), pieces(b));
    assert_eq!(a.background(), b.background());
    assert_eq!(a.to_world(), b.to_world());
}

#[test]
fn what_is_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vdb");
    let grids = grids();
    write_open_vdb(&path, &grids).unwrap();
    let back = read(&path).unwrap();
    assert_eq!(grids.len(), back.len());
    for (i, (ours, back)) in grids.iter().zip(&back).enumerate() {
        assert_eq!((&ours.name, ours.class), (&back.name, back.class));
        match (&ours.voxels, &back.voxels) {
            (Voxels::Scalar(a), Voxels::Scalar(b)) => same::<f32>(a, b),
            (Voxels::Vector(a), Voxels::Vector(b)) => same::<Rgb>(a, b),
            _ => panic!("{}", ours.name),
        }
        // A grid with a tile that halves cannot say is written as floats.
        let kind = match (i % 4, i < 8) {
            (2, true) => "half",
            (3, true) => "vec3h",
            (0 | 2, _) => "float",
            _ => "vec3s",
        };
        assert_eq!(back.kind, kind);
    }
    let again = folder.path().join("b.vdb");
    write_open_vdb(&again, &back).unwrap();
    let [first, second] = [path, again].map(|path| std::fs::read(path).unwrap());
    assert_eq!(first, second);
}

/// OpenVDB's sums, extremes and voxels of what is written; its values decide, not ours.
#[test]
fn openvdb_reads_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vdb");
    let grids = grids();
    write_open_vdb(&path, &grids).unwrap();
    if let Some(described) = described(std::slice::from_ref(&path)) {
        let mut ours = read(&path).unwrap();
        for (ours, written) in ours.iter_mut().zip(grids) {
            ours.voxels = written.voxels;
        }
        compare("written", &ours, &described[0]);
    }
}

/// The head of a file, byte by byte, and an empty tree.
#[test]
fn bytes_are_those_of_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vdb");
    let empty = SparseBuilder::new(0.5).build(DAffine3::IDENTITY).unwrap();
    let grid = VolumeGrid::new("n", GridClass::FogVolume, Voxels::Scalar(empty));
    write_open_vdb(&path, &[grid]).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut expected = b"\x20BDV\0\0\0\0\xe0\0\0\0\x05\0\0\0\0\0\0\0\x01".to_vec();
    let uuid = bytes[expected.len()..][..36].to_vec();
    expected.extend(&uuid);
    expected.extend(1_u32.to_le_bytes());
    for text in ["creator", "string", "tyndall"] {
        super::encoder::string(text.as_bytes(), &mut expected);
    }
    expected.extend(1_u32.to_le_bytes());
    for text in ["n", "Tree_float_5_4_3", ""] {
        super::encoder::string(text.as_bytes(), &mut expected);
    }
    assert!(bytes.starts_with(&expected));
    for (i, digit) in uuid.iter().enumerate() {
        let dash = [8, 13, 18, 23].contains(&i);
        assert_eq!((*digit == b'-', digit.is_ascii_hexdigit()), (dash, !dash));
    }
    let offsets: Vec<_> = bytes[expected.len()..][..24].as_chunks().0.to_vec();
    let [start, blocks, end] = [0, 1, 2].map(|i| u64::from_le_bytes(offsets[i]) as usize);
    assert_eq!((start, end), (expected.len() + 24, bytes.len()));
    // One buffer, the background, no tiles, no nodes; then nothing.
    let tree = [1, 0, 0, 0, 0, 0, 0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0];
    assert_eq!(bytes[end - 16..], tree);
    assert_eq!(blocks, end);
    assert_eq!(bytes[start..][..4], [3, 0, 0, 0]);
}

#[test]
fn grids_without_voxels_are_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("a.vdb"), folder.path().join("b.vdb"));
    std::fs::write(&path, File::of(vec![Grid::default()]).bytes()).unwrap();
    std::fs::write(&out, "before").unwrap();
    let grids = read_volume(&path, |_| false).unwrap();
    let why = write_open_vdb(&out, &grids).unwrap_err().to_string();
    assert!(why.contains("b.vdb") && why.contains("`density`"), "{why}");
    assert_eq!(std::fs::read(&out).unwrap(), b"before");
}

/// Programs that have read a file tell by its name whether it is another.
#[test]
fn other_grids_are_other_files() {
    let folder = tempfile::tempdir().unwrap();
    let name = |background: f32| {
        let path = folder.path().join("a.vdb");
        let grid = SparseBuilder::new(background).build(DAffine3::IDENTITY);
        let voxels = Voxels::Scalar(grid.unwrap());
        let grid = VolumeGrid::new("n", GridClass::FogVolume, voxels);
        write_open_vdb(&path, &[grid]).unwrap();
        std::fs::read(&path).unwrap()[21..57].to_vec()
    };
    assert_eq!(name(0.5), name(0.5));
    assert_ne!(name(0.5), name(0.25));
}
