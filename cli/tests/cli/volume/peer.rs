//! OpenVDB itself, through its Python module, where that is installed.

use super::run;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs the script, or says that there is no OpenVDB.
fn peer(command: &str, path: &Path) -> Option<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/peers/vdb_fixtures.py");
    let has_module = |python: &&str| {
        ["import openvdb", "import pyopenvdb"].iter().any(|import| {
            let tried = Command::new(python).args(["-c", import]).output();
            tried.is_ok_and(|tried| tried.status.success())
        })
    };
    let mut pythons = ["python3", "/usr/bin/python3"].into_iter();
    let run = Command::new(pythons.find(has_module)?)
        .arg(script)
        .arg(command)
        .arg(path)
        .output()
        .expect("python runs");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{said}");
    Some(String::from_utf8(run.stdout).expect("text"))
}

/// Of all fixtures: each kind of value, tile, inactive voxel and transform.
const FILES: [&str; 9] = [
    "float_all",
    "float_half_two",
    "vec3s_all",
    "map_scale_translate",
    "map_sheared",
    "sphere",
    "empty",
    "dot",
    "families",
];

/// By way of NanoVDB and back, OpenVDB finds what it wrote: active voxels, sums, extremes,
/// backgrounds, transforms, and values of voxels, active or not.
#[test]
fn openvdb_finds_what_it_wrote() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    if peer("write", at).is_none() {
        return;
    }
    let expected = fs::read(at.join("expected.json")).expect("a file");
    let expected: Value = serde_json::from_slice(&expected).expect("JSON");
    for name in FILES.map(|name| format!("{name}.vdb")) {
        run(at, &["volume", "convert", &name, "-o", "by.nvdb"]);
        run(at, &["volume", "convert", "by.nvdb", "-o", "back.vdb"]);
        let ours = peer("read", &at.join("back.vdb")).expect("OpenVDB is here");
        let [ours]: [Vec<Value>; 1] = serde_json::from_str(&ours).expect("JSON");
        let theirs = expected[&name].as_array().expect("grids").iter();
        let theirs: Vec<_> = theirs.filter(|grid| grid["wanted"] == true).collect();
        assert_eq!(ours.len(), theirs.len(), "{name}");
        for (ours, theirs) in ours.iter().zip(theirs) {
            compare(&name, ours, theirs);
        }
    }
}

/// OpenVDB finds the fog of its sphere: of radius 5 in voxels of 0.3, and 3 of these inside in the
/// band.
#[test]
fn openvdb_finds_the_fog_of_its_sphere() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    if peer("write", at).is_none() {
        return;
    }
    run(
        at,
        &["volume", "convert", "sphere.vdb", "-o", "fog.vdb", "--fog"],
    );
    let fog = peer("read", &at.join("fog.vdb")).expect("OpenVDB is here");
    let fog: Value = serde_json::from_str(&fog).expect("JSON");
    let fog = &fog[0][0];
    assert_eq!([&fog["class"], &fog["name"]], ["fog volume", "surface"]);
    assert_eq!([&fog["background"][0], &fog["max"][0]], [0.0, 1.0]);
    let (mut inside, mut sum) = (0_u64, 0.0);
    for voxel in 0..51 * 51 * 51 {
        // Around its centre.
        let ijk = [voxel / 2601 - 20, voxel / 51 % 51 - 20, voxel % 51 - 15].map(f64::from);
        let away = [0.3 * ijk[0] - 1.0, 0.3 * ijk[1] - 2.0, 0.3 * ijk[2] - 3.0];
        let distance = away.iter().map(|x| x * x).sum::<f64>().sqrt() - 5.0;
        inside += u64::from(distance < 0.0);
        sum += (-distance / 0.9).clamp(0.0, 1.0);
    }
    // Distances are rounded to floats.
    assert_eq!(fog["voxels"].as_u64(), Some(inside));
    let theirs = fog["sum"][0].as_f64().expect("a number");
    assert!((theirs / sum - 1.0).abs() < 1e-5, "{theirs}, not {sum}");
}

fn compare(file: &str, ours: &Value, theirs: &Value) {
    for key in [
        "name",
        "class",
        "voxels",
        "min",
        "max",
        "background",
        "matrix",
        "points",
    ] {
        assert_eq!(ours[key], theirs[key], "{key} in {file}");
    }
    let sums = |grid: &Value| {
        let sums = grid["sum"].as_array().expect("sums").iter();
        Vec::from_iter(sums.map(|sum| sum.as_f64().expect("a number")))
    };
    for (a, b) in sums(ours).into_iter().zip(sums(theirs)) {
        assert!((a - b).abs() <= 1e-6 * b.abs(), "{a} and {b} in {file}");
    }
}
