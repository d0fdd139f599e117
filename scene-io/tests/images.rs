//! Images to files and back.

use exr::prelude::{AttributeValue, read_all_data_from_file};
use std::fs;
use std::path::Path;
use tyndall_core::{Rgb, Spectrum};
use tyndall_scene_io::{Error, Metadata, RenderOutput, check_writable, write_exr, write_png};

fn output<'a, S: Spectrum>(
    radiance: &'a [S],
    variance: &'a [S],
    metadata: &'a Metadata,
) -> RenderOutput<'a, S> {
    RenderOutput {
        width: 2,
        height: (radiance.len() / 2) as u32,
        radiance,
        variance,
        features: None,
        view: None,
        metadata,
    }
}

fn metadata() -> Metadata {
    Metadata {
        scene: "mist.toml".into(),
        fingerprint: "5eed".into(),
        integrator: "path".into(),
        seed: u64::MAX,
        first_pass: 3,
        passes: 12,
        seconds: 3.5,
        version: "0.1.0".into(),
        notes: vec!["max_depth 8: longer paths are missing".into(), "σ".into()],
    }
}

/// Names and values of the channels of an EXR file, and its attributes that are ours.
type Contents = (Vec<(String, Vec<f32>)>, Vec<(String, String)>);

fn read(path: &Path) -> Contents {
    let image = read_all_data_from_file(path).unwrap();
    let layer = &image.layer_data[0];
    let channels = layer.channel_data.list.iter().map(|c| {
        let values = c.sample_data.levels_as_slice()[0].values_as_f32().collect();
        (c.name.to_string(), values)
    });
    let mut attributes: Vec<_> = (layer.attributes.other.iter())
        .filter_map(|(key, value)| match value {
            AttributeValue::Text(text) => {
                let text = String::from_utf8(text.as_slice().to_vec()).unwrap();
                Some((key.to_string(), text))
            }
            _ => None,
        })
        .collect();
    attributes.sort();
    (channels.collect(), attributes)
}

#[test]
fn exr_keeps_radiance_variance_and_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let radiance: Vec<_> = (0..6).map(|i| Rgb::new(i as f32, 1e-30, 1e30)).collect();
    let variance: Vec<_> = (0..6).map(|i| Rgb::splat(0.1 * i as f32)).collect();
    write_exr(&path, &output(&radiance, &variance, &metadata())).unwrap();
    let (channels, attributes) = read(&path);
    let channel = |name: &str| channels.iter().find(|c| c.0 == name).unwrap().1.clone();
    assert_eq!(channels.len(), 6);
    assert_eq!(channel("R"), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(
        (channel("G"), channel("B")),
        (vec![1e-30; 6], vec![1e30; 6])
    );
    assert_eq!(channel("variance.G")[5], 0.5);
    let expected = [
        ("integrator", "path"),
        ("notes", "max_depth 8: longer paths are missing\nσ"),
        ("passes", "12"),
        ("scene", "mist.toml"),
        ("seconds", "3.5"),
        ("seed", "18446744073709551615"),
        ("version", "0.1.0"),
    ];
    let expected = expected.map(|(k, v)| (format!("tyndall.{k}"), v.to_owned()));
    assert_eq!(attributes, expected);
}

#[test]
fn a_grey_image_has_one_channel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &output(&[1.0, 2.0], &[0.0, 0.25], &metadata())).unwrap();
    let (channels, _) = read(&path);
    let expected = [("Y", [1.0, 2.0]), ("variance.Y", [0.0, 0.25])];
    assert_eq!(
        channels,
        expected.map(|(name, v)| (name.to_owned(), v.to_vec()))
    );
    let path = folder.path().join("a.png");
    write_png(&path, &output(&[1.0, 2.0], &[0.0, 0.25], &metadata()), None).unwrap();
    assert_eq!(image::open(path).unwrap().color(), image::ColorType::L8);
}

#[test]
fn png_follows_its_curve() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    // 1 − exp(−2 L) = 0.5 at L = ln 2 / 2; half in sRGB is 188.
    let half = 0.5 * 2.0_f32.ln();
    let radiance = [
        Rgb::new(0.0, half, f32::INFINITY),
        Rgb::new(1e9, f32::NAN, -1.0),
    ];
    write_png(&path, &output(&radiance, &radiance, &metadata()), Some(1.0)).unwrap();
    let picture = image::open(&path).unwrap().to_rgb8();
    assert_eq!(picture.into_raw(), [0, 188, 0, 255, 0, 0]);
    // Its own exposure shows bright pixels as 0.8, which is 231 in sRGB.
    for scale in [1e-6, 1.0, 1e6] {
        let radiance = [Rgb::splat(2.0 * scale), Rgb::splat(2.0 * scale)];
        write_png(&path, &output(&radiance, &radiance, &metadata()), None).unwrap();
        let picture = image::open(&path).unwrap().to_rgb8();
        assert_eq!(picture.into_raw(), [231; 6]);
    }
}

#[test]
fn what_fails_leaves_the_old_image_and_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    fs::write(&path, "old").unwrap();
    let plain = Metadata::default();
    let wrong = RenderOutput {
        width: 3,
        ..output(&[1.0_f32, 2.0], &[0.0, 0.0], &plain)
    };
    assert!(matches!(write_exr(&path, &wrong), Err(Error::Write { .. })));
    assert!(matches!(
        write_png(&path, &wrong, None),
        Err(Error::Write { .. })
    ));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    // The name is taken by a folder: the rename fails after all is written.
    let taken = folder.path().join("taken.exr");
    fs::create_dir(&taken).unwrap();
    let right = output(&[1.0_f32, 2.0], &[0.0, 0.0], &plain);
    assert!(write_exr(&taken, &right).is_err());
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
    let missing = folder.path().join("none/a.exr");
    let message = write_exr(&missing, &right).unwrap_err().to_string();
    assert!(
        message.contains("none/a.exr: cannot be written"),
        "{message}"
    );
    assert!(check_writable(&missing).is_err() && check_writable(&taken).is_err());
    check_writable(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    write_exr(&path, &right).unwrap();
    assert_eq!(read(&path).0.len(), 2);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
}
