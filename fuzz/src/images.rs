//! Small images of every kind.

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, LineOrder, Vec2, WritableImage, f16,
};
use std::{fs, io::Cursor};
use tyndall_core::Rgb;
use tyndall_scene_io::{Metadata, PassRange, RenderOutput, write_exr};

const SIDE: usize = 5;

/// EXR images: ours, and those of every encoding, type of sample and number of parts.
///
/// # Panics
/// If the temporary folder cannot be written.
pub fn exr_images() -> Vec<Vec<u8>> {
    let encodings = [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::Tiles(Vec2(3, 2))),
        (Compression::ZIP1, Blocks::ScanLines),
        (Compression::ZIP16, Blocks::Tiles(Vec2(4, 4))),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::B44, Blocks::ScanLines),
        (Compression::B44A, Blocks::Tiles(Vec2(5, 5))),
    ];
    let mut images = vec![ours()];
    for (compression, blocks) in encodings {
        let encoding = Encoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        images.push(written(vec![layer("", encoding)]));
    }
    let parts = ["left", "ViewLayer.Combined"].map(|name| layer(name, Encoding::SMALL_LOSSLESS));
    images.push(written(parts.into()));
    images
}

fn ours() -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.exr");
    let radiance: Vec<_> = (0..6).map(|i| Rgb::new(i as f32, 0.5, 1e30)).collect();
    let metadata = Metadata {
        scene: "mist.toml".into(),
        fingerprint: "0123456789abcdef".into(),
        integrator: "path".into(),
        passes: 12,
        parts: (0..2)
            .map(|seed| PassRange {
                seed,
                first: 0,
                count: 6,
            })
            .collect(),
        ..Metadata::default()
    };
    let output = RenderOutput {
        width: 3,
        height: 2,
        radiance: &radiance,
        variance: &radiance,
        features: None,
        view: None,
        metadata: &metadata,
    };
    write_exr(&path, &output).expect("the folder is writable");
    fs::read(path).expect("the image is there")
}

fn layer(name: &str, encoding: Encoding) -> Layer<AnyChannels<FlatSamples>> {
    let values = || (0..SIDE * SIDE).map(|i| i as f32 / 7.0);
    let channels = [
        ("R", FlatSamples::F32(values().collect())),
        ("G", FlatSamples::F16(values().map(f16::from_f32).collect())),
        ("B", FlatSamples::U32(values().map(|x| x as u32).collect())),
        ("variance.R", FlatSamples::F32(values().collect())),
    ];
    let channels = channels.map(|(name, samples)| AnyChannel::new(name, samples));
    Layer::new(
        (SIDE, SIDE),
        LayerAttributes::named(name),
        encoding,
        AnyChannels::sort(channels.into()),
    )
}

fn written(layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let display = ImageAttributes::new(IntegerBounds::from_dimensions((SIDE, SIDE)));
    let mut bytes = Cursor::new(Vec::new());
    let image = Image::from_layers(display, layers);
    (image.write().to_buffered(&mut bytes)).expect("small images can be written");
    bytes.into_inner()
}
