//! Images that are read: environments, and what `diff` and `merge` take.

use super::case::{Case, replaced};
use super::scene::{GOOD, RENDER, broken};
use crate::support::images::Picture;
use std::fs;
use tempfile::TempDir;
use tyndall_core::{Rgb, Spectrum};

const SKY: &str = "file = 'sky.exr'";

/// The EXR file of a picture in which all pixels have this radiance.
fn exr(picture: &Picture, radiance: f32) -> Vec<u8> {
    let folder = TempDir::new().expect("a folder");
    let pixels = (picture.size[0] * picture.size[1]) as usize;
    picture.write(&folder, "image.exr", &vec![Rgb::splat(radiance); pixels]);
    fs::read(folder.path().join("image.exr")).expect("an image")
}

/// A Radiance HDR file of this size, uncompressed and grey, of so many pixels.
fn hdr(width: u32, height: u32, pixels: usize) -> Vec<u8> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    [header.into_bytes(), [128, 128, 128, 129].repeat(pixels)].concat()
}

pub(crate) fn good() -> Case {
    let scene = replaced(GOOD, "radiance = 1", SKY);
    let case = Case::new("the sky", RENDER, 0, "");
    case.file("scene.toml", scene)
        .file("sky.exr", exr(&Picture::new([2, 1]), 1.0))
}

pub(crate) fn cases() -> Vec<Case> {
    [environments(), diffs(), merges()]
        .into_iter()
        .flatten()
        .collect()
}

fn environments() -> Vec<Case> {
    let case = |name, bytes: Vec<u8>, words| {
        broken(name, "radiance = 1", SKY, words).file("sky.exr", bytes)
    };
    let size = Picture::new([2, 1]);
    let whole = exr(&size, 1.0);
    vec![
        broken(
            "no sky",
            "radiance = 1",
            SKY,
            "scene.toml:48:8 … `environment.file` … sky.exr … check the name",
        ),
        broken(
            "a sky and a radiance",
            "radiance = 1",
            "radiance = 1\nfile = 'sky.exr'",
            "scene.toml:49:8 … `environment.file` … remove one",
        ),
        case(
            "a sky that is NaN",
            exr(&size, f32::NAN),
            "scene.toml:48:8 … `environment.file` … sky.exr … red is NaN at column 0, row 0 … clamp",
        ),
        case(
            "a negative sky",
            exr(&size, -1.0),
            "scene.toml:48:8 … `environment.file` … sky.exr … red is -1 at column 0, row 0 … clamp",
        ),
        case(
            "a sky of no pixels",
            hdr(0, 0, 0),
            "scene.toml:48:8 … `environment.file` … sky.exr … export it again",
        ),
        case(
            "a text as sky",
            "blue".into(),
            "scene.toml:48:8 … `environment.file` … sky.exr … convert it",
        ),
        case(
            "a truncated EXR as sky",
            whole[..whole.len() - 20].to_vec(),
            "scene.toml:48:8 … `environment.file` … sky.exr … export it again",
        ),
        case(
            "the head of an EXR as sky",
            whole[..20].to_vec(),
            "scene.toml:48:8 … `environment.file` … sky.exr … export it again",
        ),
        case(
            "a truncated HDR as sky",
            hdr(2, 2, 3),
            "scene.toml:48:8 … `environment.file` … sky.exr … export it again",
        ),
        case(
            "a gigantic sky",
            hdr(100_000, 50_000, 1),
            "scene.toml:48:8 … `environment.file` … sky.exr … scale it down",
        ),
        case(
            "a sky that promises too much",
            hdr(10_000, 5_000, 1),
            "scene.toml:48:8 … `environment.file` … sky.exr … export it again",
        ),
        broken(
            "a sky scaled to infinity",
            "radiance = 1",
            "file = 'sky.exr'\nscale = 1e38",
            "scene.toml:48:8 … `environment.file` … lower `scale`",
        )
        .file("sky.exr", exr(&size, 100.0)),
    ]
}

/// Two images, `a.exr` and `b.exr`.
fn pair(case: Case, [a, b]: [Vec<u8>; 2]) -> Case {
    case.file("a.exr", a).file("b.exr", b)
}

fn diffs() -> Vec<Case> {
    let case =
        |name, code, bytes, words| pair(Case::new(name, "diff a.exr b.exr", code, words), bytes);
    let size = |width, height| Picture::new([width, height]).passes(1, 0, 4);
    let whole = exr(&size(2, 2), 1.0);
    let cut = whole[..whole.len() - 9].to_vec();
    vec![
        Case::new(
            "diff with nothing",
            "diff a.exr b.exr --json",
            3,
            "b.exr … cannot be read … check the name",
        )
        .file("a.exr", whole.clone()),
        case(
            "diff of two sizes",
            1,
            [whole.clone(), exr(&size(3, 2), 1.0)],
            "a.exr … 2 × 2 … b.exr … 3 × 2 … render both at one resolution",
        ),
        case(
            "diff of a text",
            3,
            [whole.clone(), "grey".into()],
            "b.exr … no EXR file … export it again",
        ),
        case(
            "diff of half an EXR",
            3,
            [cut, whole.clone()],
            "a.exr … cut off … copy it again",
        ),
        case(
            "diff of no finite pixel",
            1,
            [exr(&size(2, 2), f32::NAN), whole],
            "a.exr … finite in both … render it again",
        ),
    ]
}

fn merges() -> Vec<Case> {
    let case = |name, bytes, words| {
        pair(
            Case::new(name, "merge a.exr b.exr -o out.exr", 1, words),
            bytes,
        )
    };
    let picture = |seed, first| Picture::new([2, 1]).passes(seed, first, 4);
    let part = |picture: &Picture| exr(picture, 1.0);
    let first = part(&picture(1, 0));
    let mut other = [picture(2, 0), picture(2, 0), picture(2, 0)];
    other[0].metadata.fingerprint = "4567".into();
    other[1].metadata.integrator = "photons".into();
    other[2].metadata.fingerprint = String::new();
    let [scene, integrator, unmarked] = other.map(|picture| part(&picture));
    let large = Picture::new([2, 2]).passes(2, 0, 4);
    let broken = picture(2, 0).variance(&[f32::NAN; 2]);
    vec![
        case(
            "merge of two scenes",
            [first.clone(), scene],
            "b.exr … fingerprint … \"4567\" … a.exr … renders of one picture",
        ),
        case(
            "merge of two integrators",
            [first.clone(), integrator],
            "b.exr … integrator … \"photons\" … a.exr … renders of one picture",
        ),
        case(
            "merge of two sizes",
            [first.clone(), part(&large)],
            "b.exr … resolution … [2, 2] … a.exr … renders of one picture",
        ),
        case(
            "merge of the same passes",
            [first.clone(), part(&picture(1, 2))],
            "b.exr … a.exr … another --seed",
        ),
        case(
            "merge without metadata",
            [first.clone(), unmarked],
            "b.exr … `tyndall.fingerprint` … render it again",
        ),
        case(
            "merge without passes",
            [first.clone(), part(&picture(2, 0).passes(2, 0, 0))],
            "b.exr … `tyndall.passes` … render it again",
        ),
        case(
            "merge with variance NaN",
            [first.clone(), part(&broken)],
            "b.exr … finite … render it again",
        ),
        pair(
            Case::new(
                "merge with a text",
                "merge a.exr b.exr -o out.exr",
                3,
                "b.exr … no EXR file … export it again",
            ),
            [first.clone(), "grey".into()],
        ),
        Case::new(
            "merge with nothing",
            "merge a.exr b.exr -o out.exr",
            3,
            "b.exr … cannot be read … check the name",
        )
        .file("a.exr", first.clone()),
        pair(
            Case::new(
                "merge into nowhere",
                "merge a.exr b.exr -o no/out.exr",
                4,
                "no/out.exr … make the folder",
            ),
            [first.clone(), part(&picture(2, 0))],
        ),
        Case::new(
            "merge of one part",
            "merge a.exr -o out.exr",
            2,
            "2 values required … <PART.exr>",
        )
        .file("a.exr", first),
    ]
}
