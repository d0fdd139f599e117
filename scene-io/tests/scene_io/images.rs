//! Images to files and back.

use exr::prelude::{AttributeValue, read_all_data_from_file};
use std::fs;
use std::path::Path;
use tyndall_core::{Domain, Figure, Rgb, Sampler, Spectrum, Streams};
use tyndall_scene_io::{
    Error, Metadata, RenderOutput, Scene, SceneFile, check_writable, write_exr, write_png,
};

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
        parts: Vec::new(),
        seconds: 3.5,
        version: "0.1.0".into(),
        non_finite: 0,
        figures: vec![
            Figure::total("light paths", 9),
            Figure::largest("error of transmittance", 0.004),
        ],
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
    assert_eq!(channels.len(), 7);
    assert_eq!(channel("samples.Y"), [12.0; 6]);
    assert_eq!(channel("R"), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(
        (channel("G"), channel("B")),
        (vec![1e-30; 6], vec![1e30; 6])
    );
    assert_eq!(channel("variance.G")[5], 0.5);
    let expected = [
        ("channels", "R,G,B"),
        (
            "figures",
            "light paths: 9 in all\nerror of transmittance: 0.004 at most",
        ),
        ("fingerprint", "5eed"),
        ("first_pass", "3"),
        ("integrator", "path"),
        ("non_finite", "0"),
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

/// The middle of everything.
struct Middle;

impl Sampler for Middle {
    fn next_1d(&mut self) -> f32 {
        0.5
    }
}

impl Streams for Middle {
    type Sampler = Self;

    fn sampler(&self, _: Domain, _: u64) -> Self {
        Self
    }
}

/// A red floor far below the world's origin, and the camera high above.
const CROPPED: &str = "
    [film]
    width = 6
    height = 5
    crop = [4, 1, 2, 3]
    [camera]
    position = [1000, 5, 2]
    look_at = [1000, 0, 2]
    up = [0, 0, -1]
    fov = 90
    [materials.floor]
    kind = 'diffuse'
    reflectance = [0.75, 0.5, 0.25]
    [[shapes]]
    kind = 'quad'
    corner = [995, 0, 5]
    edge_u = [10, 0, 0]
    edge_v = [0, 0, -10]
    material = 'floor'
";

#[test]
fn layers_and_the_camera_are_in_the_file() {
    let file = SceneFile::parse(CROPPED, Path::new("floor.toml"), &[]).unwrap();
    let scene = file.build::<Rgb>().unwrap();
    let features = scene.features(&Middle, 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let radiance = [Rgb::splat(1.0); 6];
    let (metadata, view) = (metadata(), scene.view());
    let output = RenderOutput {
        features: Some(&features),
        view: Some(&view),
        ..output(&radiance, &radiance, &metadata)
    };
    write_exr(&path, &output).unwrap();
    let (channels, _) = read(&path);
    let channel = |name: &str| channels.iter().find(|c| c.0 == name).unwrap().1.clone();
    assert_eq!(channels.len(), 14);
    assert_eq!(channel("albedo.R"), [0.75; 6]);
    assert_eq!(channel("albedo.B"), [0.25; 6]);
    assert_eq!(channel("normal.Y"), [1.0; 6]);
    assert_eq!(channel("normal.X"), [0.0; 6]);
    // Pixel (4, 1) of 6 × 5 sees 1.5/3 to the right and 1/3 up, at distance 1.
    let expected = 5.0 * (1.0 + 0.25 + 1.0 / 9.0_f32).sqrt();
    assert!((channel("depth.Z")[0] - expected).abs() < 1e-4);

    let image = read_all_data_from_file(&path).unwrap();
    let attributes = &image.layer_data[0].attributes;
    let window = image.attributes.display_window;
    assert_eq!((window.size.0, window.size.1), (6, 5));
    assert_eq!((window.position.0, window.position.1), (0, 0));
    let offset = attributes.layer_position;
    assert_eq!((offset.0, offset.1), (4, 1));
    assert_eq!(image.layer_data[0].size.0, 2);
    assert!((attributes.screen_window_width - 2.0).abs() < 1e-5);
    let text = |text: &Option<exr::prelude::Text>| text.as_ref().unwrap().to_string();
    assert_eq!(text(&attributes.software_name), "Tyndall 0.1.0");
    assert!(text(&attributes.comments).starts_with("max_depth 8"));
    // Row vectors: the camera is at 0, what it looks at is in front of it, at −z.
    let matrix = attributes.world_to_camera.unwrap();
    let camera = |p: [f32; 3]| {
        [0, 1, 2].map(|j| (0..3).map(|i| p[i] * matrix[4 * i + j]).sum::<f32>() + matrix[12 + j])
    };
    let near = |p: [f32; 3], to: [f32; 3]| (0..3).all(|i| (p[i] - to[i]).abs() < 1e-3);
    assert!(near(camera([1000.0, 5.0, 2.0]), [0.0; 3]));
    assert!(near(camera([1000.0, 0.0, 2.0]), [0.0, 0.0, -5.0]));
    assert!(near(camera([1001.0, 0.0, 1.0]), [1.0, 1.0, -5.0]));
    let few = scene_of_one_pixel().features(&Middle, 1);
    let broken = RenderOutput {
        features: Some(&few),
        ..output
    };
    let message = write_exr(&path, &broken).unwrap_err().to_string();
    assert!(message.contains("6 pixels, 1 of albedo"), "{message}");
}

fn scene_of_one_pixel() -> Scene<Rgb> {
    let text = CROPPED.replace("[4, 1, 2, 3]", "[0, 0, 1, 1]");
    let file = SceneFile::parse(&text, Path::new("floor.toml"), &[]);
    file.and_then(|f| f.build()).unwrap()
}

#[test]
fn a_grey_image_has_one_channel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &output(&[1.0, 2.0], &[0.0, 0.25], &metadata())).unwrap();
    let (channels, _) = read(&path);
    let expected = [
        ("Y", [1.0, 2.0]),
        ("samples.Y", [12.0, 12.0]),
        ("variance.Y", [0.0, 0.25]),
    ];
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
    assert_eq!(read(&path).0.len(), 3);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
}
