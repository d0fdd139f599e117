//! OpenVDB itself, through its Python module, where that is installed.

use glam::IVec3;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use tyndall_core::{Rgb, Spectrum};
use tyndall_media::SparseGrid;
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, read_volume};

/// Runs the script, or says that there is no OpenVDB.
fn peer(command: &str, path: &Path) -> Option<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/peers/vdb_fixtures.py");
    let has_module = |python: &&str| {
        ["openvdb", "pyopenvdb"].iter().any(|module| {
            let import = format!("import {module}");
            let tried = Command::new(python).args(["-c", &import]).output();
            tried.is_ok_and(|tried| tried.status.success())
        })
    };
    let python = ["python3", "/usr/bin/python3"]
        .into_iter()
        .find(has_module)?;
    let run = Command::new(python)
        .arg(script)
        .arg(command)
        .arg(path)
        .output();
    let run = run.unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    Some(String::from_utf8(run.stdout).unwrap())
}

/// What OpenVDB says of the grids of a file, if it is there.
pub(crate) fn described(path: &Path) -> Option<Vec<Value>> {
    Some(serde_json::from_str(&peer("read", path)?).unwrap())
}

/// OpenVDB's own words: sums to 1e-6, the rest to the bit of a float.
#[test]
fn what_openvdb_writes_is_read() {
    let folder = tempfile::tempdir().unwrap();
    if peer("write", folder.path()).is_some() {
        compare_folder(folder.path());
    }
}

fn compare_folder(folder: &Path) {
    let expected = std::fs::read(folder.join("expected.json")).unwrap();
    let expected: BTreeMap<PathBuf, Vec<Value>> = serde_json::from_slice(&expected).unwrap();
    assert!(expected.len() > 30);
    for (name, grids) in expected {
        let path = folder.join(&name);
        let wanted: Vec<_> = grids.iter().filter(|grid| grid["wanted"] == true).collect();
        let wanted = |name: &str| wanted.iter().any(|grid| grid["name"] == name);
        let ours = read_volume(&path, wanted).unwrap_or_else(|e| panic!("{e}"));
        compare(&name.display().to_string(), &ours, &grids);
        for grid in grids.iter().filter(|grid| grid["wanted"] == false) {
            let only = grid["name"].as_str().unwrap();
            let why = read_volume(&path, |name| name == only).unwrap_err();
            assert!(why.to_string().contains(only), "{why}");
        }
    }
}

pub(crate) fn compare(file: &str, ours: &[VolumeGrid], theirs: &[Value]) {
    assert_eq!(ours.len(), theirs.len(), "{file}");
    // OpenVDB lists grids by their names.
    let (mut ours, mut theirs) = (Vec::from_iter(ours), Vec::from_iter(theirs));
    ours.sort_by_key(|grid| &grid.name);
    theirs.sort_by_key(|grid| grid["name"].as_str());
    for (grid, theirs) in ours.into_iter().zip(theirs) {
        let file = format!("{file}, `{}`", grid.name);
        assert_eq!(theirs["name"], grid.name.as_str(), "{file}");
        assert_eq!(theirs["kind"], grid.kind.as_str(), "{file}");
        let class = match grid.class {
            GridClass::FogVolume => "fog volume",
            GridClass::LevelSet => "level set",
            GridClass::Staggered => "staggered",
            _ => "unknown",
        };
        assert_eq!(theirs["class"], class, "{file}");
        match &grid.voxels {
            Voxels::Scalar(voxels) => compare_voxels::<f32>(&file, voxels, theirs),
            Voxels::Vector(voxels) => compare_voxels::<Rgb>(&file, voxels, theirs),
            _ => assert_eq!(theirs["wanted"], false, "{file}"),
        }
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    let numbers = value.as_array().unwrap().iter();
    numbers.map(|x| x.as_f64().unwrap()).collect()
}

fn compare_voxels<T: Spectrum>(file: &str, ours: &SparseGrid<T>, theirs: &Value) {
    let as_ours = |value: &Value| {
        let channels = numbers(value);
        T::from_channels(|c| channels[c] as f32)
    };
    assert_eq!(as_ours(&theirs["background"]), ours.background(), "{file}");
    let matrix = numbers(&theirs["matrix"]);
    for (ours, theirs) in ours.to_world().to_cols_array().iter().zip(&matrix) {
        assert!(
            (ours - theirs).abs() <= 1e-12 * (1.0 + theirs.abs()),
            "{file}: {matrix:?}"
        );
    }
    for point in theirs["points"].as_array().unwrap() {
        let [x, y, z] = [0, 1, 2].map(|i| point[0][i].as_i64().unwrap() as i32);
        let voxel = ours.voxel(IVec3::new(x, y, z));
        assert_eq!(voxel, as_ours(&point[1]), "{file}, {}", point[0]);
    }
    let statistics = ours.statistics();
    assert_eq!(theirs["voxels"].as_u64(), Some(statistics.voxels), "{file}");
    if statistics.voxels == 0 {
        return;
    }
    assert_eq!(statistics.min, as_ours(&theirs["min"]), "{file}");
    assert_eq!(statistics.max, as_ours(&theirs["max"]), "{file}");
    for (c, sum) in numbers(&theirs["sum"]).into_iter().enumerate() {
        let n = statistics.voxels as f64;
        let largest = statistics
            .min
            .channel(c)
            .abs()
            .max(statistics.max.channel(c).abs());
        let off = (f64::from(statistics.mean.channel(c)) - sum / n).abs();
        assert!(
            off <= 1e-6 * f64::from(largest),
            "{file}: sum {sum}, off {off}"
        );
    }
}
