//! `tyndall volume convert`.

use super::run;
use crate::support::volumes::{colour, density, placed, plane, vdb, vol, with_integers};
use glam::{DAffine3, IVec3};
use std::fs;
use tempfile::TempDir;
use tyndall_core::Spectrum;
use tyndall_media::{SparseBuilder, SparseGrid};
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, read_grids, read_vol};

fn folder(name: &str, bytes: &[u8]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(name), bytes).expect("a file");
    folder
}

/// Runs `volume convert`; what it says.
fn convert(folder: &TempDir, arguments: &str) -> String {
    let arguments = format!("volume convert {arguments}");
    let arguments: Vec<_> = arguments.split(' ').collect();
    let [printed, said] = run(folder.path(), &arguments);
    assert_eq!(printed, "");
    said
}

fn grids(folder: &TempDir, name: &str) -> Vec<VolumeGrid> {
    read_grids(&folder.path().join(name), &[]).expect("a volume")
}

fn scalar(grid: &VolumeGrid) -> &SparseGrid {
    match &grid.voxels {
        Voxels::Scalar(voxels) => voxels,
        other => panic!("{other:?}"),
    }
}

/// Whether voxels are the same, active or not, in a box around all.
fn assert_same_voxels<T: Spectrum>(a: &SparseGrid<T>, b: &SparseGrid<T>) {
    assert_eq!(a.to_world(), b.to_world());
    assert_eq!(a.background(), b.background());
    assert_eq!(a.statistics(), b.statistics());
    for i in 0..32 * 16 * 16 {
        let voxel = IVec3::new(i / 256 - 12, i / 16 % 16 - 4, i % 16 - 4);
        assert_eq!(a.voxel(voxel), b.voxel(voxel), "{voxel}");
    }
}

#[test]
fn sparse_files_keep_all() {
    let whole = [density(placed()), colour("albedo"), plane()];
    let folder = folder("a.vdb", &vdb(&whole));
    let said = convert(&folder, "a.vdb -o b.nvdb");
    assert!(
        said.starts_with("b.nvdb: `density`, `albedo`, `surface`, "),
        "{said}"
    );
    convert(&folder, "b.nvdb --output c.vdb");
    for name in ["b.nvdb", "c.vdb"] {
        let back = grids(&folder, name);
        assert_eq!(back.len(), 3);
        for (a, b) in whole.iter().zip(&back) {
            assert_eq!((&a.name, a.class), (&b.name, b.class));
            match (&a.voxels, &b.voxels) {
                (Voxels::Scalar(a), Voxels::Scalar(b)) => assert_same_voxels(a, b),
                (Voxels::Vector(a), Voxels::Vector(b)) => assert_same_voxels(a, b),
                _ => panic!("{} has other channels", a.name),
            }
        }
    }
}

#[test]
fn grids_are_chosen_by_name_and_others_told() {
    let folder = folder(
        "a.vdb",
        &with_integers(&[colour("x"), colour("y"), density(placed())]),
    );
    let said = convert(&folder, "a.vdb -o b.vdb");
    let notice = "notice: a.vdb: left out is grid `density`: it is of type `int32`";
    assert!(said.starts_with(notice), "{said}");
    let names = |name| Vec::from_iter(grids(&folder, name).into_iter().map(|grid| grid.name));
    assert_eq!(names("b.vdb"), ["x", "y"]);
    // What nobody asked for is no news.
    let said = convert(&folder, "a.vdb -o c.vdb --grid y");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(names("c.vdb"), ["y"]);
    convert(&folder, "a.vdb -o d.vdb --grid y --grid x");
    assert_eq!(names("d.vdb"), ["x", "y"]);
}

#[test]
fn a_file_may_be_converted_in_place() {
    let folder = folder("a.vdb", &vdb(&[density(placed())]));
    convert(&folder, "a.vdb -o ./a.vdb --half");
    let grids = grids(&folder, "a.vdb");
    assert_eq!(grids[0].kind, "half");
    assert_eq!(scalar(&grids[0]).statistics().max, 3.0);
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
}

#[test]
fn dense_files_are_written_and_read() {
    let folder = folder("a.vdb", &vdb(&[density(placed()), colour("albedo")]));
    for (name, channels) in [("density", 1), ("albedo", 3)] {
        convert(&folder, &format!("a.vdb -o b.vol --grid {name}"));
        let volume = read_vol(&folder.path().join("b.vol")).expect("a volume");
        assert_eq!(volume.channels, channels);
        convert(&folder, "b.vol -o c.nvdb");
        let back = &grids(&folder, "c.nvdb")[0];
        assert_eq!(back.name, name);
    }
    convert(&folder, "a.vdb -o b.vol --grid density");
    let volume = read_vol(&folder.path().join("b.vol")).expect("a volume");
    // From −3 to 15, 0 to 7 and 0 to 7, and one on each side.
    assert_eq!(volume.resolution, [21, 10, 10]);
    assert_eq!(volume.bounds[0].to_array(), [-1.25, 1.625, 1.5]);
    assert_eq!(volume.bounds[1].to_array(), [9.25, 4.125, 11.5]);
    let original = density(placed());
    for i in 0..2100 {
        let place = IVec3::from([i % 21, i / 21 % 10, i / 210].map(|i| i as i32));
        let voxel = place - IVec3::new(4, 1, 1);
        assert_eq!(volume.values[i], scalar(&original).voxel(voxel), "{voxel}");
    }
    // All that is not 0, in its place.
    convert(&folder, "b.vol -o d.vdb");
    let back = grids(&folder, "d.vdb");
    let (a, b) = (scalar(&original), scalar(&back[0]));
    assert_eq!(a.statistics(), b.statistics());
    let [a, b] = [a, b].map(|grid| {
        let [first, last] = grid.content().expect("voxels");
        [first, last].map(|i| grid.to_world().transform_point3(i.as_dvec3()))
    });
    assert!(
        a[0].abs_diff_eq(b[0], 1e-5) && a[1].abs_diff_eq(b[1], 1e-5),
        "{a:?} {b:?}"
    );
}

#[test]
fn dense_files_become_sparse() {
    let folder = folder(
        "a.vol",
        &vol([2, 1, 1], 3, &[0.0, 0.0, 0.0, 0.5, 0.25, 0.0]),
    );
    convert(&folder, "a.vol -o b.vdb");
    let grids = grids(&folder, "b.vdb");
    assert_eq!(
        (grids[0].name.as_str(), grids[0].kind.as_str()),
        ("albedo", "vec3s")
    );
    let Voxels::Vector(voxels) = &grids[0].voxels else {
        panic!("scalar")
    };
    assert_eq!(voxels.statistics().voxels, 1);
    assert_eq!(voxels.voxel(IVec3::X).0.to_array(), [0.5, 0.25, 0.0]);
}

#[test]
fn level_sets_become_fog() {
    let folder = folder("a.vdb", &vdb(&[plane(), density(placed())]));
    convert(&folder, "a.vdb -o b.vdb --fog");
    let grids = grids(&folder, "b.vdb");
    assert_eq!(grids[0].class, GridClass::FogVolume);
    let fog = scalar(&grids[0]);
    assert_eq!(fog.background(), 0.0);
    for (x, density) in [
        (-20, 0.0),
        (-12, 1.0),
        (-4, 0.0),
        (-3, 1.0),
        (-2, 2.0 / 3.0),
        (-1, 1.0 / 3.0),
        (0, 0.0),
        (2, 0.0),
    ] {
        assert_eq!(fog.voxel(IVec3::new(x, 4, 4)), density, "{x}");
    }
    // A tile, and three layers of 8².
    assert_eq!(fog.statistics().voxels, 512 + 3 * 64);
    assert_eq!(fog.leaf_count(), 1, "all is 0 beyond the surface");
    assert_same_voxels(scalar(&grids[1]), scalar(&density(placed())));
    convert(&folder, "a.vdb -o b.vol --fog --grid surface");
    let said = convert(&folder, "a.vdb -o b.vdb --fog --grid density");
    assert!(
        said.starts_with("notice: a.vdb: no grid is a level set"),
        "{said}"
    );
}

#[test]
fn halves_round_tiles_and_the_background_too() {
    let mut grid = SparseBuilder::new(0.1);
    grid.voxel(IVec3::ZERO, 0.3).expect("a place");
    grid.tile(
        IVec3::splat(8),
        tyndall_media::TileSize::Leaf,
        1.0 / 3.0,
        true,
    )
    .expect("a place");
    let grid = grid.build(DAffine3::IDENTITY).expect("a grid");
    let grid = VolumeGrid::new("density", GridClass::Unknown, Voxels::Scalar(grid));
    let folder = folder("a.vdb", &vdb(&[grid]));
    convert(&folder, "a.vdb -o b.vdb --half");
    let grids = grids(&folder, "b.vdb");
    assert_eq!(grids[0].kind, "half");
    let half = scalar(&grids[0]);
    // The nearest halves have 11 bits.
    assert_eq!(half.background(), 1638.0 / 16384.0);
    assert_eq!(half.voxel(IVec3::ZERO), 1229.0 / 4096.0);
    assert_eq!(half.voxel(IVec3::splat(9)), 1365.0 / 4096.0);
    // No more is lost where 32 bits are written.
    convert(&folder, "b.vdb -o c.nvdb");
    assert_same_voxels(half, scalar(&self::grids(&folder, "c.nvdb")[0]));
}
