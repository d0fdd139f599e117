//! Parts of one render, from several machines.

use crate::support::images::{said, tyndall};
use std::fs;
use tempfile::TempDir;
use tyndall_core::FigureValue;
use tyndall_scene_io::{PassRange, RenderedImage, read_exr};

/// A folder with `fog.toml`, by a method whose radii shrink.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let path = format!("{}/../scenes/cornell_fog.toml", env!("CARGO_MANIFEST_DIR"));
    let scene = fs::read_to_string(path).expect("a scene");
    let small = scene.replace("= 256", "= 8");
    let integrator = "[integrator]\nkind = \"progressive_photon_map\"\npaths = 2000\n";
    fs::write(folder.path().join("fog.toml"), small + integrator).expect("a file");
    folder
}

/// Runs a command that succeeds, and returns what it says.
fn run(folder: &TempDir, line: &str) -> String {
    let output = tyndall(folder, &line.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{line}: {}", said(&output));
    said(&output)
}

/// Runs one that fails with this code, and returns its one message.
fn refused(folder: &TempDir, line: &str, code: i32) -> String {
    let output = tyndall(folder, &line.split(' ').collect::<Vec<_>>());
    let said = said(&output);
    assert_eq!(output.status.code(), Some(code), "{line}: {said}");
    assert_eq!(said.trim_end().lines().count(), 1, "{said}");
    said
}

fn read(folder: &TempDir, name: &str) -> RenderedImage {
    read_exr(&folder.path().join(name)).expect("an image")
}

/// The figures of radii.
fn radii(image: &RenderedImage) -> Vec<FigureValue> {
    let figures = image.metadata.figures.iter();
    let radii = figures.filter(|figure| figure.name.starts_with("radius"));
    radii.map(|figure| figure.value).collect()
}

/// The example of the README, and the whole that it says it makes.
#[test]
fn parts_on_two_machines_are_one_render() {
    let folder = folder();
    let readme = include_str!("../../README.md");
    let examples = readme
        .lines()
        .filter_map(|l| l.strip_prefix("    tyndall "));
    let examples: Vec<_> = examples.filter(|l| l.contains("part")).collect();
    assert_eq!(examples.len(), 3, "two renders and a merge");
    for line in examples {
        run(&folder, line);
    }
    run(&folder, "render fog.toml -o whole.exr --passes 16");
    let [merged, whole] = ["fog.exr", "whole.exr"].map(|name| read(&folder, name));
    for (a, b) in merged
        .radiance
        .iter()
        .flatten()
        .zip(whole.radiance.iter().flatten())
    {
        // Three roundings to 24 bits, of the parts and of the merge.
        assert!(
            (a - b).abs() <= b.abs() * 3.0 * 2.0_f32.powi(-24),
            "{a}, in one render {b}"
        );
    }
    let (merged, whole) = (merged.metadata, whole.metadata);
    assert_eq!(merged.figures, whole.figures);
    assert_eq!(merged.pass_ranges(), whole.pass_ranges());
    assert_eq!(merged.notes, whole.notes);
}

#[test]
fn a_later_part_has_smaller_radii() {
    let folder = folder();
    run(&folder, "render fog.toml -o a.exr --passes 2");
    run(
        &folder,
        "render fog.toml -o b.exr --passes 2 --first-pass 100",
    );
    let [early, late] = ["a.exr", "b.exr"].map(|name| radii(&read(&folder, name)));
    assert_eq!((early.len(), late.len()), (2, 2));
    for pair in early.into_iter().zip(late) {
        let (FigureValue::Range([smallest, _]), FigureValue::Range([_, largest])) = pair else {
            panic!("{pair:?} are no ranges");
        };
        assert!(largest < smallest);
    }
}

#[test]
fn what_parts_share_or_lack_is_told() {
    let folder = folder();
    run(&folder, "render fog.toml -o a.exr --passes 4");
    run(
        &folder,
        "render fog.toml -o b.exr --passes 4 --first-pass 3",
    );
    run(
        &folder,
        "render fog.toml -o c.exr --passes 4 --first-pass 6",
    );
    run(&folder, "render fog.toml -o d.exr --passes 4 --seed 1");
    let shared = refused(&folder, "merge a.exr b.exr -o out.exr", 1);
    for needle in ["b.exr", "passes 3 to 3 of seed 0", "--seed", "--first-pass"] {
        assert!(shared.contains(needle), "{shared}");
    }
    let gap = run(&folder, "merge a.exr c.exr -o ac.exr");
    assert!(
        gap.contains("no part holds passes 4 to 5 of seed 0"),
        "{gap}"
    );
    let range = |first| PassRange {
        seed: 0,
        first,
        count: 4,
    };
    assert_eq!(read(&folder, "ac.exr").metadata.parts, [range(0), range(6)]);
    // Another seed begins with the largest radius again, and one render would not have.
    let more = "more biased than one render";
    let biased = run(&folder, "merge a.exr d.exr -o ad.exr");
    assert!(biased.contains(more) && !gap.contains(more), "{biased}");
    assert!(
        read(&folder, "ad.exr")
            .metadata
            .notes
            .concat()
            .contains(more)
    );
    let again = run(&folder, "merge ad.exr c.exr -o adc.exr");
    assert_eq!(again.matches(more).count(), 1, "{again}");
}

#[test]
fn radii_by_statistics_have_no_parts() {
    let folder = folder();
    let line = "render fog.toml -o a.exr --first-pass 4 --set integrator.statistics=true";
    let why = refused(&folder, line, 3);
    for needle in ["fog.toml", "`integrator.statistics`", "--first-pass"] {
        assert!(why.contains(needle), "{why}");
    }
    let path = format!("{line} --integrator path --passes 1");
    run(&folder, &path);
    let line = "render fog.toml -o a.exr --first-pass 18446744073709551615";
    assert!(
        tyndall(&folder, &line.split(' ').collect::<Vec<_>>())
            .status
            .code()
            == Some(2)
    );
}
