//! `tyndall diff`.

use crate::support::images::{Picture, said, tyndall};
use serde_json::Value;
use tempfile::TempDir;
use tyndall_core::{Rgb, Sampler, Spectrum};
use tyndall_testkit::{TestSampler, rng};

/// The figures of two images in a folder.
fn diff(folder: &TempDir, a: &str, b: &str) -> Value {
    let output = tyndall(folder, &["diff", a, b, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn near(value: &Value, expected: f64) {
    let value = value.as_f64().unwrap();
    assert!(
        (value - expected).abs() <= 1e-6 * expected.abs(),
        "{value}, expected {expected}"
    );
}

#[test]
fn figures_are_those_of_their_formulas() {
    let folder = tempfile::tempdir().unwrap();
    let a = [Rgb::new(1.0, 2.0, 3.0), Rgb::new(0.5, 0.0, 7.0)];
    let b = [Rgb::new(1.0, 1.0, 3.0), Rgb::new(0.0, 0.0, 4.0)];
    let picture = |seed, v| Picture::new([2, 1]).passes(seed, 0, 4).variance(&[v; 2]);
    picture(1, 0.04).write(&folder, "a.exr", &a);
    picture(2, 0.01).write(&folder, "b.exr", &b);
    let found = diff(&folder, "a.exr", "b.exr");
    near(&found["mse"], (1.0 + 0.25 + 9.0) / 6.0);
    near(
        &found["rel_mse"],
        (1.0 / 1.01 + 0.25 / 0.01 + 9.0 / 16.01) / 6.0,
    );
    let red = &found["mean_ratio"][0];
    near(&red["ratio"], 1.5);
    // Both sums have two pixels: (√(2·0.04 + 1.5²·2·0.01))/1.
    near(&red["standard_error"], (0.08_f64 + 2.25 * 0.02).sqrt());
    let largest = &found["largest_difference"];
    near(&largest["difference"], 3.0);
    assert_eq!(
        (&largest["channel"], &largest["pixel"]),
        (&"B".into(), &vec![1, 0].into())
    );
    let text = tyndall(&folder, &["diff", "a.exr", "b.exr"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.contains("MSE         1.7083e0") && text.contains("in B at (1, 0)"),
        "{text}"
    );
    assert!(text.contains("z-test      differ"), "{text}");
}

#[test]
fn grey_is_equal_colours_and_black_has_no_ratio() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Picture::new([2, 1]);
    picture.write(&folder, "grey.exr", &[1.0_f32, 2.0]);
    picture.write(&folder, "rgb.exr", &[Rgb::splat(1.0), Rgb::splat(2.0)]);
    picture.write(&folder, "black.exr", &[0.0_f32, 0.0]);
    for pair in [["grey.exr", "rgb.exr"], ["rgb.exr", "grey.exr"]] {
        let found = diff(&folder, pair[0], pair[1]);
        near(&found["mse"], 0.0);
        assert_eq!(found["channels"].as_array().unwrap().len(), 3);
    }
    let found = diff(&folder, "grey.exr", "black.exr");
    assert!(found["mean_ratio"][0]["ratio"].is_null(), "{found}");
    near(&found["rel_mse"], 0.5 * (1.0 + 4.0) / 0.01);
}

#[test]
fn what_is_not_finite_is_left_out_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |seed| Picture::new([3, 1]).passes(seed, 0, 4).variance(&[0.1; 3]);
    picture(1).write(&folder, "a.exr", &[1.0_f32, f32::NAN, 3.0]);
    picture(2).write(&folder, "b.exr", &[1.0_f32, 2.0, 2.5]);
    picture(3).write(&folder, "inf.exr", &[f32::INFINITY, 2.0, f32::NAN]);
    let found = diff(&folder, "a.exr", "b.exr");
    assert_eq!(found["left_out"], 1);
    near(&found["mse"], 0.25 / 2.0);
    assert_eq!(
        found["largest_difference"]["pixel"],
        Value::from(vec![2, 0])
    );
    assert_eq!(found["z_test"]["verdict"], "differ");
    let output = tyndall(&folder, &["diff", "a.exr", "inf.exr"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("a.exr has no pixel that is finite"),
        "{}",
        said(&output)
    );
}

#[test]
fn what_cannot_be_compared_is_one_message() {
    let folder = tempfile::tempdir().unwrap();
    Picture::new([2, 1]).write(&folder, "a.exr", &[1.0_f32, 2.0]);
    Picture::new([1, 2]).write(&folder, "b.exr", &[1.0_f32, 2.0]);
    std::fs::write(folder.path().join("c.exr"), "none").unwrap();
    for (other, code, needles) in [
        ("b.exr", 1, &["a.exr has 2 × 1", "b.exr has 1 × 2"][..]),
        ("c.exr", 3, &["c.exr", "no EXR"]),
        ("d.exr", 3, &["d.exr", "cannot be read"]),
    ] {
        let output = tyndall(&folder, &["diff", "a.exr", other]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{said}");
        assert!(needles.iter().all(|n| said.contains(n)), "{said}");
        assert!(output.stdout.is_empty());
    }
    assert_eq!(tyndall(&folder, &["diff", "a.exr"]).status.code(), Some(2));
}

#[test]
fn no_z_test_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name, seed, first, count| {
        let picture = Picture::new([2, 1]).passes(seed, first, count);
        picture
            .variance(&[0.1; 2])
            .write(&folder, name, &[1.0_f32, 2.0]);
    };
    write("a.exr", 1, 0, 8);
    write("same.exr", 1, 7, 8);
    write("other.exr", 1, 8, 8);
    write("single.exr", 2, 0, 1);
    let why = |b| diff(&folder, "a.exr", b)["no_z_test"].clone();
    assert!(
        why("same.exr")
            .as_str()
            .unwrap()
            .contains("passes 7 to 7 of seed 1")
    );
    assert!(
        why("single.exr")
            .as_str()
            .unwrap()
            .contains("tyndall.passes")
    );
    assert!(why("other.exr").is_null());
}

/// Means of passes that are normal with deviation 0.3 about 1.
fn noise(pixels: u32, passes: usize, sampler: &mut TestSampler) -> (Vec<f32>, Vec<f32>) {
    let normal = |s: &mut TestSampler| {
        let [u, v] = s.next::<2>().map(f64::from);
        (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
    };
    (0..pixels)
        .map(|_| {
            let values: Vec<_> = (0..passes).map(|_| 1.0 + 0.3 * normal(sampler)).collect();
            let mean = values.iter().sum::<f64>() / passes as f64;
            let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
            let variance = squares / (passes as f64 * (passes as f64 - 1.0));
            (mean as f32, variance as f32)
        })
        .unzip()
}

/// Two independent images agree (fixed seed; the verdict's own false-alarm rate, 1e-3), with the
/// shares of a normal distribution (5 standard errors: 6e-7); each of three defects is found by the
/// test that is made for it. Passes: 16; standard error of a pixel: 0.075.
#[test]
fn the_z_test_finds_what_is_there_and_nothing_else() {
    const SIDE: u32 = 64;
    let folder = tempfile::tempdir().unwrap();
    let mut sampler = rng(11);
    let picture = |seed| Picture::new([SIDE; 2]).passes(seed, 0, 16);
    let (a, va) = noise(SIDE * SIDE, 16, &mut sampler);
    let (b, vb) = noise(SIDE * SIDE, 16, &mut sampler);
    picture(2).variance(&vb).write(&folder, "b.exr", &b);
    let found = |name: &str, change: &dyn Fn(usize) -> f32| {
        let a: Vec<_> = a.iter().enumerate().map(|(i, x)| x + change(i)).collect();
        picture(1).variance(&va).write(&folder, name, &a);
        diff(&folder, name, "b.exr")["z_test"].clone()
    };
    let number = |test: &Value, key: &str| test["channels"][0][key].as_f64().unwrap();
    let same = found("same.exr", &|_| 0.0);
    assert_eq!(same["verdict"], "agree", "{same}");
    for (key, share) in [("beyond_2", 0.0455), ("beyond_3", 0.0027)] {
        let error = (share * (1.0 - share) / f64::from(SIDE * SIDE)).sqrt();
        assert!(
            (number(&same, key) - share).abs() < 5.0 * error,
            "{key}: {same}"
        );
    }
    // Ten standard errors in a pixel.
    let pixel = found("pixel.exr", &|i| if i == 131 { 0.75 * 1.5 } else { 0.0 });
    assert_eq!(pixel["verdict"], "differ");
    assert_eq!(
        pixel["channels"][0]["largest_pixel"],
        Value::from(vec![3, 2])
    );
    // A seventh of a standard error everywhere: 6.4 standard errors of the mean.
    let mean = found("mean.exr", &|_| 0.015);
    assert_eq!(mean["verdict"], "differ");
    assert!(
        number(&mean, "mean_p") < 1e-4 && number(&mean, "largest_p") > 1e-6,
        "{mean}"
    );
    // A standard error, up and down in turn: χ² is half as much again.
    let chi2 = found("chi2.exr", &|i| if i % 2 == 0 { 0.075 } else { -0.075 });
    assert_eq!(chi2["verdict"], "differ");
    assert!(
        number(&chi2, "chi2_p") < 1e-9 && number(&chi2, "mean_p") > 1e-4,
        "{chi2}"
    );
}

#[cfg(feature = "flip")]
#[test]
fn flip_is_zero_for_equal_images_and_grows_with_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let ramp = |factor: f32| -> Vec<Rgb> {
        (0..64 * 64)
            .map(|i| Rgb::splat(0.01 + factor * (i % 64) as f32))
            .collect()
    };
    let flip = |factor: f32| {
        Picture::new([64; 2]).write(&folder, "a.exr", &ramp(factor));
        Picture::new([64; 2]).write(&folder, "b.exr", &ramp(1.0));
        diff(&folder, "a.exr", "b.exr")["flip"]["mean"]
            .as_f64()
            .unwrap()
    };
    let found = [1.0, 1.1, 1.5, 4.0].map(flip);
    assert_eq!(found[0], 0.0);
    assert!(
        found.is_sorted() && found[1] > 0.0 && found[3] <= 1.0,
        "{found:?}"
    );
}
