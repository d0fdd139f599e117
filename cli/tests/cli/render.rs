//! The command as a person meets it.

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn scene(name: &str) -> String {
    format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

fn tyndall(arguments: &[&str]) -> Output {
    Command::cargo_bin("tyndall")
        .expect("the command is built")
        .args(arguments)
        .output()
        .expect("the command runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn path(folder: &TempDir, name: &str) -> (PathBuf, String) {
    let path = folder.path().join(name);
    let text = path.display().to_string();
    (path, text)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> = entries
        .map(|e| {
            e.expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

#[test]
fn a_scene_becomes_two_images() {
    let folder = folder();
    let ((_, exr), (_, png)) = (path(&folder, "out.exr"), path(&folder, "out.png"));
    let output = tyndall(&[
        "render",
        &scene("cornell_fog"),
        "-o",
        &exr,
        "--png",
        &png,
        "--passes",
        "2",
        "--threads",
        "2",
        "--set",
        "film.width=24",
        "--set",
        "film.height=16",
    ]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("2 passes"), "{}", said(&output));
    assert_eq!(names(folder.path()), ["out.exr", "out.png"]);
    let bytes = fs::read(&png).expect("an image");
    assert_eq!(
        bytes[16..24],
        [0, 0, 0, 24, 0, 0, 0, 16],
        "width and height of a PNG"
    );
}

#[test]
fn an_image_has_all_layers_and_knows_its_place_in_the_picture() {
    let folder = folder();
    let (file, exr) = path(&folder, "out.exr");
    let scene = scene("glass_ball");
    let small = ["film.width=16", "film.height=12", "film.crop=[3, 2, 8, 9]"];
    let set = small.map(|value| ["--set", value]).concat();
    let head = ["render", &scene, "-o", &exr, "--passes", "2"];
    let output = tyndall(&[&head[..], &set].concat());
    assert!(output.status.success(), "{}", said(&output));
    let meta = exr::meta::MetaData::read_from_file(&file, true).expect("an EXR");
    let header = &meta.headers[0];
    let names = header.channels.list.iter().map(|c| c.name.to_string());
    let colours = ["B", "G", "R"];
    let of = |layer: &str| colours.map(|c| format!("{layer}{c}")).to_vec();
    let mut expected = [of(""), of("variance."), of("albedo.")].concat();
    let more = ["samples.Y", "normal.X", "normal.Y", "normal.Z", "depth.Z"];
    expected.extend(more.map(str::to_owned));
    expected.sort();
    assert_eq!(names.collect::<Vec<_>>(), expected);
    let window = header.own_attributes.layer_position;
    assert_eq!((window.0, window.1), (3, 2));
    assert_eq!((header.layer_size.0, header.layer_size.1), (8, 9));
    let picture = header.shared_attributes.display_window.size;
    assert_eq!((picture.0, picture.1), (16, 12));
}

#[test]
fn the_same_seed_gives_the_same_picture_and_another_seed_another() {
    let folder = folder();
    let render = |name: &str, seed: &str, threads: &str| {
        let (file, png) = path(&folder, name);
        let (_, exr) = path(&folder, "out.exr");
        let small = ["--set", "film.width=20", "--set", "film.height=20"];
        let budget = ["--passes", "2", "--seed", seed, "--threads", threads];
        let scene = scene("spot_smoke");
        let head = ["render", &scene, "-o", &exr, "--png", &png];
        let output = tyndall(&[&head[..], &small, &budget].concat());
        assert!(output.status.success(), "{}", said(&output));
        fs::read(file).expect("an image")
    };
    let first = render("a.png", "1", "1");
    assert!(first == render("b.png", "1", "3"));
    assert!(first != render("c.png", "2", "1"));
}

#[test]
fn what_cannot_be_is_one_message_and_an_exit_code_of_its_kind() {
    let folder = folder();
    let (_, out) = path(&folder, "out.exr");
    let scene = scene("laser");
    let nowhere = format!("{}/no/such/folder/out.exr", folder.path().display());
    for (arguments, code, needles) in [
        (
            vec!["render", "missing.toml", "-o", &out],
            3,
            &["missing.toml"][..],
        ),
        (
            vec!["render", &scene, "-o", &out, "--set", "film.widht=3"],
            3,
            &["film.widht", "width"],
        ),
        (
            vec![
                "render",
                &scene,
                "-o",
                &out,
                "--set",
                "integrator.kind=photons",
            ],
            3,
            &["laser.toml", "`integrator.kind`", "photons", "path"],
        ),
        (
            vec!["render", &scene, "-o", &nowhere],
            4,
            &["no/such/folder"],
        ),
        (vec!["inspect", "missing.toml"], 3, &["missing.toml"]),
    ] {
        let output = tyndall(&arguments);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{said}");
        assert!(needles.iter().all(|n| said.contains(n)), "{said}");
        assert!(names(folder.path()).is_empty(), "{arguments:?}");
    }
}

#[test]
fn a_wrong_command_line_is_exit_2() {
    let scene = scene("laser");
    for arguments in [
        vec!["render", &scene],
        vec!["render", &scene, "-o", "out.png"],
        vec!["render", &scene, "-o", "out.exr", "--passes", "0"],
        vec!["render", &scene, "-o", "out.exr", "--time", "3 weeks"],
        vec!["render", &scene, "-o", "out.exr", "--error", "-1"],
        vec![
            "render", &scene, "-o", "out.exr", "--error", "1", "--passes", "3",
        ],
        vec!["render", &scene, "-o", "out.exr", "--set", "width"],
        vec!["render", &scene, "-o", "out.exr", "--integrator", "photons"],
    ] {
        assert_eq!(tyndall(&arguments).status.code(), Some(2), "{arguments:?}");
    }
    assert!(!Path::new("out.exr").exists());
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_writes_what_there_is() {
    let folder = folder();
    let (file, exr) = path(&folder, "out.exr");
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("tyndall"))
        .args(["render", &scene("laser"), "-o", &exr, "--time", "1h"])
        .args(["--set", "film.width=16", "--set", "film.height=9"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    std::thread::sleep(Duration::from_secs(2));
    let interrupt = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .expect("kill runs");
    assert!(interrupt.success());
    let start = Instant::now();
    let status = child.wait().expect("the command ends");
    assert!(start.elapsed() < Duration::from_secs(60) && status.success());
    assert!(file.exists());
}

#[test]
fn every_integrator_renders_any_scene() {
    let scene = scene("glass_ball");
    let small = [
        "film.width=12",
        "film.height=9",
        "integrator.paths=500",
        "integrator.final_gather=2",
    ];
    for (name, notes) in [
        (
            "path",
            [
                "`integrator.paths`: path does not heed it",
                "`integrator.final_gather`",
            ],
        ),
        ("photon_map", ["photons blur light, however many", ""]),
        (
            "progressive_photon_map",
            ["photons blur light, less", "`integrator.final_gather`"],
        ),
        (
            "beam_radiance",
            ["photons blur light, less", "`integrator.final_gather`"],
        ),
    ] {
        let folder = folder();
        let (file, exr) = path(&folder, "out.exr");
        let mut arguments = vec!["render", &scene, "-o", &exr, "--passes", "2"];
        arguments.extend(["--integrator", name]);
        arguments.extend(small.iter().flat_map(|set| ["--set", set]));
        let output = tyndall(&arguments);
        let said = said(&output);
        assert!(output.status.success(), "{name}: {said}");
        assert!(file.exists());
        assert!(
            notes.iter().all(|note| said.contains(note)),
            "{name}: {said}"
        );
    }
}
