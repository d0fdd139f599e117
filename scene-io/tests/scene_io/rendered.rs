//! Images read back from files.

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, LineOrder, Vec2, WritableImage, f16,
};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use tyndall_core::{Figure, Rgb, Spectrum};
use tyndall_scene_io::{
    Metadata, PassRange, RenderOutput, RenderedImage, SceneFile, read_exr, write_exr,
};

const WIDTH: usize = 7;
const HEIGHT: usize = 5;
const PIXELS: usize = WIDTH * HEIGHT;

fn file() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    (folder, path)
}

fn metadata() -> Metadata {
    let range = |seed, first, count| PassRange { seed, first, count };
    Metadata {
        scene: "mist.toml".into(),
        fingerprint: "00ff".into(),
        integrator: "path, σ".into(),
        seed: u64::MAX,
        first_pass: 3,
        passes: 12,
        parts: vec![range(u64::MAX, 3, 8), range(1, 0, 4)],
        seconds: 3.25,
        version: "0.1.0".into(),
        non_finite: 5,
        figures: vec![
            Figure::total("light paths", 1 << 60),
            Figure::range("radius: σ", 0.1),
        ],
        notes: vec!["a".into(), "b".into()],
    }
}

/// Planes of 0, 1, 2, … times these factors.
fn ramps(factors: &[f32]) -> Vec<Vec<f32>> {
    let ramp = |factor: &f32| (0..PIXELS).map(|i| i as f32 * factor).collect();
    factors.iter().map(ramp).collect()
}

fn round_trip<S: Spectrum>() -> RenderedImage {
    let (_folder, path) = file();
    let spectra = |factor: f32| -> Vec<S> {
        let spectrum = |i| S::from_channels(|c| i as f32 * factor * (c + 1) as f32);
        (0..PIXELS).map(spectrum).collect()
    };
    let output = RenderOutput {
        width: WIDTH as u32,
        height: HEIGHT as u32,
        radiance: &spectra(1.0),
        variance: &spectra(0.25),
        features: None,
        view: None,
        metadata: &metadata(),
    };
    write_exr(&path, &output).unwrap();
    read_exr(&path).unwrap()
}

#[test]
fn what_is_written_is_read() {
    let colour = round_trip::<Rgb>();
    assert_eq!((colour.width, colour.height), (7, 5));
    assert_eq!((colour.position, colour.picture), ([0, 0], [7, 5]));
    assert_eq!(colour.radiance, ramps(&[1.0, 2.0, 3.0]));
    assert_eq!(colour.variance, Some(ramps(&[0.25, 0.5, 0.75])));
    assert_eq!(colour.samples, Some(vec![12.0; PIXELS]));
    assert_eq!(colour.metadata, metadata());
    assert!(colour.features.is_none() && colour.view.is_none());
    let grey = round_trip::<f32>();
    assert_eq!(grey.radiance, ramps(&[1.0]));
    assert_eq!(grey.variance, Some(ramps(&[0.25])));
}

#[test]
fn passes_that_cannot_be_are_an_error() {
    let range = |seed, first, count| PassRange { seed, first, count };
    let huge = vec![range(1, 0, u64::MAX), range(2, 0, 2)];
    for (first_pass, passes, parts, problem) in [
        (u64::MAX, 2, vec![], "more than can be"),
        (
            0,
            2,
            vec![range(1, u64::MAX, 2), range(2, 0, 2)],
            "more than can be",
        ),
        (0, 4, vec![range(1, 0, 2), range(2, 0, 3)], "do not add up"),
        (0, 1, huge, "do not add up"),
    ] {
        let (_folder, path) = file();
        let metadata = Metadata {
            first_pass,
            passes,
            parts,
            ..Metadata::default()
        };
        let output = RenderOutput {
            width: 1,
            height: 1,
            radiance: &[1.0_f32],
            variance: &[1.0_f32],
            features: None,
            view: None,
            metadata: &metadata,
        };
        write_exr(&path, &output).unwrap();
        let error = read_exr(&path).unwrap_err().to_string();
        assert!(
            error.contains("a.exr") && error.contains(problem),
            "{error}"
        );
    }
}

#[test]
fn features_and_the_camera_of_a_crop_are_read() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell_fog.toml");
    let overrides = [
        ("film.width", "16"),
        ("film.height", "12"),
        ("film.crop", "[3, 2, 8, 9]"),
    ];
    let overrides = overrides.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let scene = (SceneFile::load(&scene, &overrides).unwrap())
        .build::<Rgb>()
        .unwrap();
    let features = scene.features(&tyndall_driver::PassStreams::new(0, 0), 4);
    let view = scene.view();
    let [width, height] = tyndall_core::Sensor::resolution(&scene);
    let black = vec![Rgb::default(); (width * height) as usize];
    let (_folder, path) = file();
    let output = RenderOutput {
        width,
        height,
        radiance: &black,
        variance: &black,
        features: Some(&features),
        view: Some(&view),
        metadata: &metadata(),
    };
    write_exr(&path, &output).unwrap();
    let image = read_exr(&path).unwrap();
    assert_eq!(image.features, Some(features));
    assert_eq!(image.view, Some(view));
    assert_eq!((image.position, image.picture), ([3, 2], [16, 12]));
}

/// A layer of 32-bit floats.
fn layer(name: &str, channels: &[(&str, f32)]) -> Layer<AnyChannels<FlatSamples>> {
    let channel = |(name, factor): &(&str, f32)| {
        AnyChannel::new(*name, FlatSamples::F32(ramps(&[*factor]).remove(0)))
    };
    Layer::new(
        (WIDTH, HEIGHT),
        LayerAttributes::named(name),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.iter().map(channel).collect()),
    )
}

fn write(path: &Path, layers: Vec<Layer<AnyChannels<FlatSamples>>>) {
    let display = ImageAttributes::new(IntegerBounds::from_dimensions((WIDTH, HEIGHT)));
    let image = Image::from_layers(display, layers);
    image.write().to_file(path).unwrap();
}

fn read_layers(layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Result<RenderedImage, String> {
    let (_folder, path) = file();
    write(&path, layers);
    read_exr(&path).map_err(|e| {
        let message = e.to_string();
        let (file, problem) = message.split_once("a.exr: ").unwrap();
        assert!(!file.is_empty() && !problem.contains('\n'));
        problem.to_owned()
    })
}

#[test]
fn any_encoding_and_any_type_of_sample_is_read() {
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    let all = [Blocks::ScanLines, Blocks::Tiles(Vec2(3, 2))];
    for (compression, blocks) in compressions
        .into_iter()
        .flat_map(|c| all.map(move |blocks| (c, blocks)))
    {
        let values = ramps(&[0.5]).remove(0);
        let half = values.iter().map(|&x| f16::from_f32(x)).collect();
        let whole = (0..PIXELS as u32).collect();
        let channels = [
            ("A", FlatSamples::F32(values.clone())),
            ("R", FlatSamples::F32(values.clone())),
            ("G", FlatSamples::F16(half)),
            ("B", FlatSamples::U32(whole)),
        ];
        let channels = channels.map(|(name, samples)| AnyChannel::new(name, samples));
        let layer = Layer::new(
            (WIDTH, HEIGHT),
            LayerAttributes::default(),
            Encoding {
                compression,
                blocks,
                line_order: LineOrder::Increasing,
            },
            AnyChannels::sort(channels.into()),
        );
        let image = read_layers(vec![layer]).unwrap();
        assert_eq!(image.radiance, ramps(&[0.5, 0.5, 1.0]), "{compression}");
        assert_eq!(image.variance, None);
        assert_eq!(image.metadata, Metadata::default());
    }
}

#[test]
fn the_picture_is_chosen_among_layers() {
    let rgb = |factor: f32| [("R", factor), ("G", factor), ("B", factor)];
    let named = |prefix: &str, factor| {
        rgb(factor).map(|(name, factor)| (format!("{prefix}.{name}"), factor))
    };
    let one = |layers: &[(&str, f32)]| {
        let mut channels = Vec::new();
        for (prefix, factor) in layers {
            if prefix.is_empty() {
                channels.extend(rgb(*factor).map(|(name, f)| (name.to_owned(), f)));
            } else {
                channels.extend(named(prefix, *factor));
            }
        }
        let channels: Vec<_> = channels.iter().map(|(n, f)| (n.as_str(), *f)).collect();
        read_layers(vec![layer("", &channels)])
    };
    let chosen = |image: Result<RenderedImage, String>| image.unwrap().radiance[0][1];
    // Without a prefix first, then by what renderers call it, then the only one.
    assert_eq!(
        chosen(one(&[("beauty", 1.0), ("", 2.0), ("albedo", 3.0)])),
        2.0
    );
    assert_eq!(
        chosen(one(&[("View.Diffuse", 1.0), ("View.Combined", 2.0)])),
        2.0
    );
    assert_eq!(chosen(one(&[("albedo", 1.0), ("strange", 2.0)])), 2.0);
    let why = one(&[("left", 1.0), ("right", 2.0)]).unwrap_err();
    assert!(why.contains("`left`, `right`"), "{why}");
    // Parts.
    let parts = |a: &str, b: &str| read_layers(vec![layer(a, &rgb(1.0)), layer(b, &rgb(2.0))]);
    assert_eq!(chosen(parts("diffuse", "Beauty")), 2.0);
    assert_eq!(chosen(parts("rgba", "left")), 1.0);
    let why = parts("left", "right").unwrap_err();
    assert!(why.contains("`left`, `right`"), "{why}");
    // Grey, beside colours and alone.
    let grey = read_layers(vec![layer("", &[("Y", 4.0), ("A", 1.0)])]).unwrap();
    assert_eq!(grey.radiance, ramps(&[4.0]));
    let why = read_layers(vec![layer("", &[("Z", 1.0), ("normal.X", 1.0)])]).unwrap_err();
    assert!(
        why.contains("no channels R, G, B") && why.contains("`Z`, `normal.X`"),
        "{why}"
    );
    let why = read_layers(vec![layer("", &[("Y", 1.0), ("RY", 1.0), ("BY", 1.0)])]).unwrap_err();
    assert!(why.contains("luminance"), "{why}");
}

#[test]
fn broken_files_are_errors_and_allocate_nothing() {
    let (_folder, path) = file();
    write(
        &path,
        vec![layer("", &[("R", 1.0), ("G", 2.0), ("B", 3.0)])],
    );
    let good = fs::read(&path).unwrap();
    for length in (0..good.len()).step_by(7) {
        fs::write(&path, &good[..length]).unwrap();
        let why = read_exr(&path).unwrap_err().to_string();
        assert!(why.contains("a.exr: "), "{why}");
    }
    // The data window promises lines of 2²⁷ pixels, which take 8 GB.
    let name = b"dataWindow\0box2i\0";
    let at = good.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    let mut huge = good.clone();
    huge[at + 8..at + 12].copy_from_slice(&i32::to_le_bytes(1 << 27));
    fs::write(&path, &huge).unwrap();
    let why = read_exr(&path).unwrap_err().to_string();
    assert!(why.contains("it promises 134217729 × 5 pixels"), "{why}");
    fs::write(&path, "solid cube").unwrap();
    assert!(read_exr(&path).unwrap_err().to_string().contains("no EXR"));
    let missing = read_exr(&path.with_file_name("none.exr")).unwrap_err();
    assert!(missing.to_string().contains("none.exr: cannot be read"));
}

#[test]
fn damaged_attributes_are_errors() {
    for (key, value) in [
        ("passes", "many"),
        ("seed", "-1"),
        ("parts", "1 2"),
        ("seconds", "x"),
        ("figures", "light paths: many"),
    ] {
        let mut damaged = layer("", &[("Y", 1.0)]);
        damaged.attributes.other.insert(
            format!("tyndall.{key}").as_str().into(),
            exr::prelude::AttributeValue::Text(value.into()),
        );
        let why = read_layers(vec![damaged]).unwrap_err();
        assert!(why.contains(&format!("tyndall.{key}")), "{why}");
    }
}

#[test]
fn an_image_knows_which_passes_it_lacks_and_repeats() {
    let range = |seed, first, count| PassRange { seed, first, count };
    let with = |parts: &[PassRange]| Metadata {
        parts: parts.to_vec(),
        ..metadata()
    };
    let gaps = with(&[
        range(2, 9, 1),
        range(1, 4, 2),
        range(1, 0, 3),
        range(2, 3, 4),
    ]);
    assert_eq!(gaps.missing_passes(), [range(1, 3, 1), range(2, 7, 2)]);
    assert!(gaps.repeats_passes(), "4 and 5 of both seeds");
    let none = with(&[range(1, 0, 3), range(1, 3, 4), range(2, 7, 2)]);
    assert_eq!(none.missing_passes(), []);
    assert!(!none.repeats_passes());
}
