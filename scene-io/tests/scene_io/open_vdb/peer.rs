//! OpenVDB itself, through its Python module, where that is installed.

use super::encoder::{ACTIVE_MASK, BLOSC, File, Grid, ZIP};
use super::read;
use glam::IVec3;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use tyndall_core::{Rgb, Spectrum};
use tyndall_media::SparseGrid;
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, read_volume};

/// Runs the script, or says that there is no OpenVDB.
fn peer(command: &str, paths: &[PathBuf]) -> Option<String> {
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
        .args(paths)
        .output();
    let run = run.unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    Some(String::from_utf8(run.stdout).unwrap())
}

/// What OpenVDB says of the grids of files, if it is there.
pub(crate) fn described(paths: &[PathBuf]) -> Option<Vec<Vec<Value>>> {
    Some(serde_json::from_str(&peer("read", paths)?).unwrap())
}

/// OpenVDB's own words: sums to 1e-6, the rest to the bit of a float.
#[test]
fn what_openvdb_writes_is_read() {
    let folder = tempfile::tempdir().unwrap();
    if peer("write", &[folder.path().to_owned()]).is_some() {
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

/// Files of versions, compressions and inactive values that OpenVDB's module does not write, byte by
/// byte: it reads of them what this crate does.
#[test]
fn openvdb_reads_the_encoder() {
    let folder = tempfile::tempdir().unwrap();
    let mut paths = Vec::new();
    let kinds = [
        ("Tree_float_5_4_3", 1),
        ("Tree_float_5_4_3_HalfFloat", 1),
        ("Tree_vec3s_5_4_3", 3),
        ("Tree_vec3s_5_4_3_HalfFloat", 3),
    ];
    let flags = [
        0,
        ACTIVE_MASK,
        ZIP,
        ZIP | ACTIVE_MASK,
        BLOSC,
        BLOSC | ACTIVE_MASK,
    ];
    for (i, (kind, channels)) in (0..).zip(kinds) {
        for (j, flags) in (0..).zip(flags) {
            // OpenVDB leaves no values out without a mask.
            let codes = if flags & ACTIVE_MASK == 0 {
                6..=6
            } else {
                0..=6
            };
            for code in codes {
                let grid = Grid {
                    kind,
                    channels,
                    flags,
                    code,
                    map: maps()[usize::from(code)].clone(),
                    metadata: false,
                    ..Grid::default()
                };
                let version = 222 + (i + j + u32::from(code)) % 3;
                let file = File {
                    version,
                    ..File::of(vec![grid])
                };
                let path = folder.path().join(format!("{kind}_{flags}_{code}.vdb"));
                std::fs::write(&path, file.bytes()).unwrap();
                paths.push(path);
            }
        }
    }
    let Some(described) = described(&paths) else {
        return;
    };
    assert_eq!(described.len(), 4 * (3 * 7 + 3));
    for (path, theirs) in paths.iter().zip(&described) {
        compare(&path.display().to_string(), &read(path).unwrap(), theirs);
    }
}

/// A transform of every kind.
fn maps() -> [(&'static str, Vec<f64>); 7] {
    let (s, t) = ([2.0, -3.0, 4.0], [5.0, 6.0, 7.0]);
    let derived = |s: [f64; 3]| {
        let size = s.map(f64::abs);
        let inverse = s.map(|s| 1.0 / s);
        [
            s,
            size,
            inverse,
            inverse.map(|x| x * x),
            inverse.map(|x| 0.5 * x),
        ]
        .concat()
    };
    let moved = |s| [&t[..], &derived(s)].concat();
    let turned = [
        0.6, 0.8, 0.0, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let sheared = [
        2.0, 1.0, 0.0, 0.0, 0.5, -3.0, 0.0, 0.0, 0.0, 0.25, 4.0, 0.0, 5.0, 6.0, 7.0, 1.0,
    ];
    [
        ("UniformScaleMap", derived([0.1; 3])),
        ("ScaleMap", derived(s)),
        ("TranslationMap", t.to_vec()),
        ("UniformScaleTranslateMap", moved([0.1; 3])),
        ("ScaleTranslateMap", moved(s)),
        ("UnitaryMap", turned.to_vec()),
        ("AffineMap", sheared.to_vec()),
    ]
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
