//! `tyndall merge`.

use crate::support::images::{Picture, said, tyndall};
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tyndall_core::{Rgb, Spectrum};
use tyndall_driver::{Budget, Film, PassStreams, Render};
use tyndall_scene_io::{
    Metadata, PassRange, RenderOutput, RenderedImage, Scene, SceneFile, read_exr, write_exr,
};

fn scene<S: Spectrum>() -> Scene<S> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell_fog.toml");
    let small = [("film.width", "12"), ("film.height", "8")];
    let small = small.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let file = SceneFile::load(&path, &small).unwrap();
    file.build().unwrap()
}

/// Renders some passes of a seed as `tyndall render` would, into a file.
fn render<S: Spectrum>(folder: &TempDir, name: &str, scene: &Scene<S>, passes: PassRange) {
    let integrator = tyndall_path::Path::new();
    let film: Film<S> = Render::new(scene, &integrator)
        .seed(passes.seed)
        .first_pass(passes.first)
        .run(Budget::Passes(passes.count), |_| {})
        .unwrap();
    let spectra = |values: Vec<f64>| -> Vec<S> {
        let pixels = values.chunks_exact(S::CHANNELS);
        pixels.map(|p| S::from_channels(|i| p[i] as f32)).collect()
    };
    let [width, height] = film.resolution();
    let output = RenderOutput {
        width,
        height,
        radiance: &spectra(film.mean().to_vec()),
        variance: &spectra(film.variance_of_mean().collect()),
        features: Some(&scene.features(&PassStreams::new(passes.seed, 0), 4)),
        view: Some(&scene.view()),
        metadata: &Metadata {
            fingerprint: "0123".into(),
            integrator: "path".into(),
            seed: passes.seed,
            first_pass: passes.first,
            passes: passes.count,
            seconds: 1.0,
            ..Metadata::default()
        },
    };
    write_exr(&folder.path().join(name), &output).unwrap();
}

fn range(seed: u64, first: u64, count: u64) -> PassRange {
    PassRange { seed, first, count }
}

fn merge(folder: &TempDir, parts: &[&str], out: &str) -> Result<RenderedImage, String> {
    let output = tyndall(folder, &[&["merge"], parts, &["-o", out]].concat());
    if output.status.code() == Some(0) {
        return Ok(read(folder, out));
    }
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    Err(said(&output))
}

fn read(folder: &TempDir, name: &str) -> RenderedImage {
    read_exr(&folder.path().join(name)).unwrap()
}

fn values(planes: &[Vec<f32>]) -> impl Iterator<Item = f64> + '_ {
    planes.iter().flatten().map(|&x| f64::from(x))
}

/// Half a unit in the last place of a 32-bit float of this size.
fn rounding(x: f64) -> f64 {
    x.abs() * 0.5_f64.powi(24) + f64::from(f32::MIN_POSITIVE)
}

/// Parts of n and m passes against all n + m in one render. The files round mean and variance to
/// 32 bits: of the mean, the roundings of the parts (together at most that of the whole, for
/// radiance is not negative), of the merge and of the whole add up. In the variance
/// (M + M′ + δ²·nm/(n+m)) / ((n+m)(n+m−1)) the error e of δ adds 2|δ|e + e².
fn halves_make_the_whole<S: Spectrum>(n: u64, m: u64) {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene::<S>();
    render(&folder, "a.exr", &scene, range(7, 0, n));
    render(&folder, "b.exr", &scene, range(7, n, m));
    render(&folder, "all.exr", &scene, range(7, 0, n + m));
    let merged = merge(&folder, &["b.exr", "a.exr"], "merged.exr").unwrap();
    let [a, b, all] = ["a.exr", "b.exr", "all.exr"].map(|name| read(&folder, name));
    assert!(values(&all.radiance).any(|x| x > 0.0));
    for (got, want) in values(&merged.radiance).zip(values(&all.radiance)) {
        assert!(
            (got - want).abs() <= 3.0 * rounding(want),
            "{got}, in one render {want}"
        );
    }
    let variances = |image: &RenderedImage| image.variance.clone().unwrap();
    let (got, want) = (variances(&merged), variances(&all));
    let means = values(&a.radiance).zip(values(&b.radiance));
    let [n, m] = [n as f64, m as f64];
    let weight = n * m / (n + m) / ((n + m) * (n + m - 1.0));
    for ((got, want), (a, b)) in values(&got).zip(values(&want)).zip(means) {
        let (delta, e) = ((a - b).abs(), rounding(a) + rounding(b));
        let tolerance = 3.0 * rounding(want) + weight * (2.0 * delta * e + e * e);
        assert!(
            (got - want).abs() <= tolerance,
            "{got}, in one render {want}"
        );
    }
    // Adjacent passes of a seed are as one render's.
    let expected = Metadata {
        seconds: 2.0,
        version: env!("CARGO_PKG_VERSION").into(),
        ..all.metadata
    };
    assert_eq!(merged.metadata, expected);
    assert_eq!((merged.samples, merged.view), (all.samples, all.view));
    // The same rays were traced for the features of both.
    let (got, want) = (merged.features.unwrap(), all.features.unwrap());
    for (got, want) in got.depth.iter().zip(&want.depth) {
        assert!(got == want || (got / want - 1.0).abs() < 1e-6);
    }
    let distances = got
        .normal
        .iter()
        .zip(&want.normal)
        .map(|(a, b)| a.distance(*b));
    assert!(distances.fold(0.0, f32::max) < 1e-6);
}

#[test]
fn two_parts_make_the_whole_in_colour() {
    halves_make_the_whole::<Rgb>(8, 8);
}

#[test]
fn unequal_parts_make_the_whole_in_grey() {
    halves_make_the_whole::<f32>(3, 13);
    // A single pass has no variance of its own.
    halves_make_the_whole::<f32>(1, 4);
}

#[test]
fn features_are_averaged_by_samples() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene::<f32>();
    render(&folder, "a.exr", &scene, range(1, 0, 1));
    render(&folder, "b.exr", &scene, range(2, 0, 3));
    let merged = merge(&folder, &["a.exr", "b.exr"], "merged.exr").unwrap();
    let [a, b, merged] = [read(&folder, "a.exr"), read(&folder, "b.exr"), merged]
        .map(|image| image.features.unwrap());
    for (i, got) in merged.albedo.iter().enumerate() {
        let want = a.albedo[i] * 0.25 + b.albedo[i] * 0.75;
        assert!((got.0 - want.0).abs().max_element() < 1e-6);
    }
    let different = a.depth.iter().zip(&b.depth).filter(|(a, b)| a != b).count();
    assert!(
        different > 0,
        "the seeds must differ for the test to tell anything"
    );
    for (i, got) in merged.depth.iter().enumerate() {
        let want = a.depth[i] * 0.25 + b.depth[i] * 0.75;
        assert!((got / want - 1.0).abs() < 1e-6, "{got}, {want}");
    }
}

#[test]
fn a_merge_can_be_merged_and_knows_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, seed, first, count, value: f32| {
        let picture = Picture::new([1, 1]).passes(seed, first, count);
        picture.variance(&[0.0]).write(&folder, name, &[value]);
    };
    write("a.exr", 1, 0, 4, 1.0);
    write("b.exr", 2, 0, 4, 2.0);
    write("c.exr", 1, 4, 8, 3.0);
    let ab = merge(&folder, &["a.exr", "b.exr"], "ab.exr").unwrap();
    assert_eq!(ab.metadata.parts, [range(1, 0, 4), range(2, 0, 4)]);
    // Means 1 and 2 of four passes each: M₂ = 1·4·4/8, over 8·7.
    assert_eq!(ab.variance, Some(vec![vec![2.0 / 56.0]]));
    let abc = merge(&folder, &["ab.exr", "c.exr"], "abc.exr").unwrap();
    assert_eq!(abc.radiance, [vec![(4.0 + 8.0 + 24.0) / 16.0]]);
    assert_eq!(abc.metadata.parts, [range(1, 0, 12), range(2, 0, 4)]);
    assert_eq!((abc.metadata.passes, abc.metadata.seconds), (16, 4.5));
    for (parts, shared) in [
        (["abc.exr", "a.exr"], "passes 0 to 3 of seed 1"),
        (["c.exr", "abc.exr"], "passes 4 to 11 of seed 1"),
        (["ab.exr", "b.exr"], "passes 0 to 3 of seed 2"),
        (["a.exr", "a.exr"], "passes 0 to 3 of seed 1"),
    ] {
        let why = merge(&folder, &parts, "none.exr").unwrap_err();
        assert!(why.contains(shared) && why.contains("--seed"), "{why}");
    }
}

#[test]
fn what_is_said_of_parts_is_said_of_their_merge_if_it_is_true_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let stopped = "interrupted: the image holds the passes finished until then";
    for (name, seed, non_finite, note) in [
        ("a.exr", 1, 3, "the image is black: no light was found"),
        ("b.exr", 2, 4, "lit"),
    ] {
        let mut picture = Picture::new([1, 1]).passes(seed, 0, 4);
        picture.metadata.non_finite = non_finite;
        picture.metadata.notes = [note, "biased", stopped].map(str::to_owned).to_vec();
        picture.write(&folder, name, &[1.0]);
    }
    let merged = merge(&folder, &["a.exr", "b.exr"], "ab.exr").unwrap();
    assert_eq!(merged.metadata.non_finite, 7);
    assert_eq!(merged.metadata.notes, ["biased"]);
}

#[test]
fn parts_of_different_pictures_are_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Picture::new([2, 1]).passes(1, 0, 4);
    let other = Picture::new([2, 1]).passes(2, 0, 4);
    picture.write(&folder, "a.exr", &[1.0_f32; 2]);
    fs::write(folder.path().join("out.exr"), "old").unwrap();
    let with = |change: &dyn Fn(&mut Picture)| {
        let mut other = other.clone();
        change(&mut other);
        other.write(&folder, "b.exr", &[1.0_f32; 2]);
        refusal(&folder)
    };
    let metadata = |change: fn(&mut Metadata)| with(&|p: &mut Picture| change(&mut p.metadata));
    for (why, needle) in [
        (metadata(|m| m.fingerprint = "4567".into()), "fingerprint"),
        (metadata(|m| m.fingerprint.clear()), "tyndall.fingerprint"),
        (metadata(|m| m.integrator = "vpl".into()), "integrator"),
        (metadata(|m| m.passes = 0), "tyndall.passes"),
        (metadata(|m| m.seed = 1), "passes 0 to 3 of seed 1"),
        (metadata(|m| m.passes = u64::MAX), "more than 2⁶⁴"),
        (with(&|p| p.size = [1, 2]), "resolution"),
    ] {
        assert!(why.contains(needle), "{why}");
    }
    other.write(&folder, "b.exr", &[Rgb::splat(1.0); 2]);
    assert!(refusal(&folder).contains("channels"));
    other.write(&folder, "b.exr", &[1.0, f32::NAN]);
    assert!(refusal(&folder).contains("not finite"));
    fs::remove_file(folder.path().join("b.exr")).unwrap();
    let output = tyndall(&folder, &["merge", "a.exr", "b.exr", "-o", "out.exr"]);
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    for arguments in [
        &["merge", "a.exr", "-o", "c.exr"][..],
        &["merge", "a.exr", "a.exr"],
    ] {
        assert_eq!(tyndall(&folder, arguments).status.code(), Some(2));
    }
    assert_eq!(fs::read(folder.path().join("out.exr")).unwrap(), b"old");
}

/// What is said of `a.exr` and `b.exr`: one line that names the second.
fn refusal(folder: &TempDir) -> String {
    let why = merge(folder, &["a.exr", "b.exr"], "out.exr").unwrap_err();
    assert_eq!(why.trim_end().lines().count(), 1, "{why}");
    assert!(why.contains("b.exr"), "{why}");
    why
}

#[test]
fn renders_of_the_command_can_be_merged_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let scene = format!("{}/../scenes/laser.toml", env!("CARGO_MANIFEST_DIR"));
    let small = ["--set", "film.width=16", "--set", "film.height=9"];
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2"), ("c.exr", "3")] {
        let render = [
            "render", &scene, "-o", name, "--passes", "4", "--seed", seed,
        ];
        let output = tyndall(&folder, &[&render[..], &small].concat());
        assert!(output.status.success(), "{}", said(&output));
    }
    let merged = merge(&folder, &["a.exr", "b.exr"], "ab.exr").unwrap();
    assert_eq!(merged.metadata.passes, 8);
    let output = tyndall(&folder, &["diff", "c.exr", "ab.exr"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("χ²"), "{text}");
    // Another film is another scene.
    let render = [
        "render", &scene, "-o", "b.exr", "--passes", "4", "--seed", "2",
    ];
    let output = tyndall(&folder, &[&render[..], &["--set", "film.width=8"]].concat());
    assert!(output.status.success(), "{}", said(&output));
    assert!(refusal(&folder).contains("fingerprint"));
}
