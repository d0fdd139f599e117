//! `tyndall inspect` of volumes.

use super::run;
use crate::support::volumes::{colour, density, placed, plane, vdb, vol, with_integers};
use glam::{DAffine3, DMat3, DVec3, IVec3};
use serde_json::{Value, json};
use std::fs;
use tyndall_media::SparseBuilder;
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels};

/// The JSON and the text of a file.
fn inspect(name: &str, bytes: &[u8]) -> (Value, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(name), bytes).expect("a file");
    let [json, _] = run(folder.path(), &["inspect", name, "--json"]);
    let [text, _] = run(folder.path(), &["inspect", name]);
    (serde_json::from_str(&json).expect("JSON"), text)
}

#[test]
fn grids_are_told_with_numbers() {
    let bytes = vdb(&[density(placed()), colour("albedo"), plane()]);
    // The extension counts in capitals too.
    let (json, text) = inspect("cloud.VDB", &bytes);
    assert_eq!(json["file_bytes"], bytes.len());
    let grids = &json["grids"];
    assert_eq!(grids.as_array().map(Vec::len), Some(3));
    let names = [0, 1, 2].map(|i| [&grids[i]["name"], &grids[i]["kind"], &grids[i]["class"]]);
    let expected = [
        ["density", "float", "fog_volume"],
        ["albedo", "vec3s", "unknown"],
        ["surface", "float", "level_set"],
    ];
    assert_eq!(names, expected);
    let voxels = &grids[0]["voxels"];
    assert_eq!(voxels["active"], 2 + 512);
    assert_eq!([&voxels["leaves"], &voxels["tiles"]], [2, 1]);
    assert_eq!(voxels["index_box"], json!([[-3, 0, 0], [15, 7, 7]]));
    // Half a voxel more on each side.
    let world = json!([[-0.75, 1.875, 2.5], [8.75, 3.875, 10.5]]);
    assert_eq!(voxels["world_box"], world);
    assert_eq!(voxels["voxel_size"], json!([0.5, 0.25, 1.0]));
    assert_eq!(voxels["to_world"][3], json!([1.0, 2.0, 3.0]));
    assert_eq!(
        [&voxels["min"], &voxels["max"]],
        [&json!([0.5]), &json!([3.0])]
    );
    let mean = voxels["mean"][0].as_f64().expect("a number");
    assert!((mean - (4.0 + 256.0) / 514.0).abs() < 1e-12, "{mean}");
    assert!(voxels["bytes"].as_u64() > Some(2 * 2048), "two leaves");
    assert_eq!(grids[1]["voxels"]["mean"], json!([0.25, 0.5, 0.75]));
    assert_eq!(grids[2]["voxels"]["background"], json!([3.0]));
    for told in [
        "3 grids\n",
        "grid        density: float, fog volume\n",
        "514 active voxels, 2 leaves, 1 tile, background 0\n",
        "index [-3, 0, 0] to [15, 7, 7]\n",
        "voxel [0.5, 0.25, 1]\n",
        "min [0.25, 0.5, 0.75]",
        "surface: float, level set",
    ] {
        assert!(text.contains(told), "{told} in\n{text}");
    }
}

#[test]
fn voxels_that_are_turned_are_told_whole() {
    for matrix in [
        DMat3::from_rotation_z(0.5),
        DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0)),
    ] {
        let turned = DAffine3::from_mat3(matrix);
        let (json, text) = inspect("a.vdb", &vdb(&[density(turned)]));
        let voxels = &json["grids"][0]["voxels"];
        assert_eq!(voxels["voxel_size"], Value::Null);
        assert_eq!(voxels["to_world"][1], json!(matrix.y_axis.to_array()));
        assert!(
            text.contains("turned, sheared or mirrored: axes ["),
            "{text}"
        );
        // The corners of all cells lie in the box.
        for (a, b) in [(-3.5, -0.5), (15.5, 7.5), (-3.5, 7.5), (15.5, -0.5)] {
            let corner = turned.transform_point3(DVec3::new(a, b, 7.5));
            for axis in 0..3 {
                let [low, high] = [0, 1].map(|i| voxels["world_box"][i][axis].as_f64());
                assert!(low <= Some(corner[axis] + 1e-12) && high >= Some(corner[axis] - 1e-12));
            }
        }
    }
}

#[test]
fn values_that_are_not_finite_are_counted() {
    let mut grid = SparseBuilder::new(0.0);
    for (x, value) in [1.0, f32::NAN, 2.0, f32::INFINITY, f32::NAN]
        .into_iter()
        .enumerate()
    {
        let place = IVec3::new(x as i32, 5, 0);
        grid.voxel(place, value).expect("a place");
    }
    let grid = Voxels::Scalar(grid.build(DAffine3::IDENTITY).expect("a grid"));
    let grid = VolumeGrid::new("density", GridClass::FogVolume, grid);
    let values = [1.0, f32::NAN, 2.0, f32::INFINITY, f32::NAN];
    for (name, bytes, first) in [
        ("a.vdb", vdb(&[grid]), [1, 5, 0]),
        ("a.vol", vol([1, 5, 1], 1, &values), [0, 1, 0]),
    ] {
        let (json, text) = inspect(name, &bytes);
        let voxels = &json["grids"][0]["voxels"];
        assert_eq!([&voxels["active"], &voxels["non_finite"]], [5, 3]);
        assert_eq!(voxels["first_non_finite"], json!(first));
        let statistics = ["min", "mean", "max"].map(|key| &voxels[key][0]);
        assert_eq!(statistics, [1.0, 1.5, 2.0]);
        let told = format!("not finite: 3 active voxels, the first {first:?}");
        assert!(text.contains(&told), "{text}");
    }
}

#[test]
fn grids_that_are_not_read_are_listed_with_the_reason() {
    let bytes = with_integers(&[colour("albedo"), density(placed())]);
    let (json, text) = inspect("a.vdb", &bytes);
    assert!(json["grids"][0]["voxels"].is_object());
    let other = &json["grids"][1];
    assert_eq!([&other["name"], &other["kind"]], ["density", "int32"]);
    assert_eq!(other["voxels"], Value::Null);
    let why = other["unsupported"].as_str().expect("a reason");
    assert!(
        why.contains("`int32`") && why.contains("export it as float"),
        "{why}"
    );
    assert!(
        text.contains("density: int32, fog volume, not read\n"),
        "{text}"
    );
    assert!(text.contains(why), "{text}");
}

#[test]
fn dense_and_empty_grids_are_told() {
    let values: Vec<_> = (0..24).map(|i| i as f32).collect();
    let (json, text) = inspect("a.vol", &vol([2, 2, 2], 3, &values));
    let voxels = &json["grids"][0]["voxels"];
    assert_eq!(json["grids"][0]["kind"], "3 × float");
    assert_eq!([&voxels["active"], &voxels["bytes"]], [8, 96]);
    assert_eq!([&voxels["leaves"], &voxels["tiles"]], [&Value::Null; 2]);
    assert_eq!(voxels["index_box"], json!([[0, 0, 0], [1, 1, 1]]));
    assert_eq!(
        voxels["world_box"],
        json!([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    );
    assert_eq!(voxels["mean"], json!([10.5, 11.5, 12.5]));
    assert!(text.contains("(no name): 3 × float\n"), "{text}");

    let empty = SparseBuilder::new(0.25)
        .build(DAffine3::IDENTITY)
        .expect("a grid");
    let empty = VolumeGrid::new("empty", GridClass::Unknown, Voxels::Scalar(empty));
    let (json, text) = inspect("a.vdb", &vdb(&[empty]));
    let voxels = &json["grids"][0]["voxels"];
    for key in ["index_box", "world_box", "min", "mean", "first_non_finite"] {
        assert_eq!(voxels[key], Value::Null, "{key}");
    }
    assert!(
        text.contains(" 0 active voxels, 0 leaves, 0 tiles, background 0.25\n"),
        "{text}"
    );
}
