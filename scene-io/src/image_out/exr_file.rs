//! OpenEXR.

use super::{Metadata, RenderOutput, View, write_whole};
use crate::Error;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, Text, Vec2, WritableImage,
};
use std::path::Path;
use tyndall_core::Spectrum;

/// Writes an image with all its layers as 32-bit floats.
///
/// | channels | what |
/// |---|---|
/// | `R`, `G`, `B`, or `Y` of one channel | radiance |
/// | `variance.R`, … or `variance.Y` | variance of the radiance as an estimate of the mean |
/// | `samples.Y` | samples a pixel |
/// | `albedo.R`, …, `normal.X`, `.Y`, `.Z`, `depth.Z` | [`Features`](crate::Features), if given |
///
/// Metadata are attributes `tyndall.scene`, `.fingerprint`, `.integrator`, `.seed`, `.first_pass`,
/// `.passes`, `.parts` (of a merge: a line of seed, first pass and passes each), `.seconds`,
/// `.version`, `.channels`, `.non_finite` (samples that were not finite), `.figures` (what the integrator
/// tells of its passes, as [`Figure`](tyndall_core::Figure) writes it) and `.notes`, one a line;
/// those that are empty are left out. `software` and `comments` repeat the version and the notes for other programs.
/// With a [`View`], the display window is the whole picture and the data window the image's part of
/// it, and `worldToCamera`, `screenWindowCenter` and `screenWindowWidth` describe the camera (of
/// row vectors, looking along −z, as OpenEXR has it).
///
/// # Errors
/// [`Error::Write`]; a file that was there before is untouched then.
pub fn write_exr<S: Spectrum>(path: &Path, output: &RenderOutput<'_, S>) -> Result<(), Error> {
    output.check(path)?;
    let size = Vec2(output.width as usize, output.height as usize);
    let mut attributes = described(output.metadata, colours::<S>());
    let mut display = IntegerBounds::from_dimensions(size);
    if let Some(view) = output.view {
        place(&mut attributes, view);
        let [width, height] = view.picture.map(|n| n as usize);
        display = IntegerBounds::from_dimensions((width, height));
    }
    let channels = AnyChannels::sort(planes(output).into());
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut image = Image::from_layer(layer);
    image.attributes = ImageAttributes::new(display);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| Error::write(path, e))?;
    write_whole(path, |file| {
        std::io::Write::write_all(file, bytes.get_ref()).map_err(|e| e.to_string())
    })
}

/// Names of the channels of radiance.
fn colours<S: Spectrum>() -> &'static [&'static str] {
    if S::CHANNELS == 1 {
        &["Y"]
    } else {
        &["R", "G", "B"]
    }
}

fn planes<S: Spectrum>(output: &RenderOutput<'_, S>) -> Vec<AnyChannel<FlatSamples>> {
    let channel =
        |name: String, values: Vec<f32>| AnyChannel::new(name.as_str(), FlatSamples::F32(values));
    let mut planes = Vec::new();
    for (i, name) in colours::<S>().iter().enumerate() {
        let plane = |values: &[S]| values.iter().map(|s| s.channel(i)).collect();
        planes.push(channel(name.to_string(), plane(output.radiance)));
        planes.push(channel(format!("variance.{name}"), plane(output.variance)));
    }
    let samples = vec![output.metadata.passes as f32; output.radiance.len()];
    planes.push(channel("samples.Y".into(), samples));
    let Some(features) = output.features else {
        return planes;
    };
    for (i, name) in ["R", "G", "B"].iter().enumerate() {
        let albedo = features.albedo.iter().map(|c| c.0[i]).collect();
        planes.push(channel(format!("albedo.{name}"), albedo));
    }
    for (i, name) in ["X", "Y", "Z"].iter().enumerate() {
        let normal = features.normal.iter().map(|n| n[i]).collect();
        planes.push(channel(format!("normal.{name}"), normal));
    }
    planes.push(channel("depth.Z".into(), features.depth.clone()));
    planes
}

fn described(metadata: &Metadata, colours: &[&str]) -> LayerAttributes {
    let notes = metadata.notes.join("\n");
    let figures: Vec<_> = metadata.figures.iter().map(ToString::to_string).collect();
    let texts = [
        ("scene", metadata.scene.clone()),
        ("fingerprint", metadata.fingerprint.clone()),
        ("integrator", metadata.integrator.clone()),
        ("seed", metadata.seed.to_string()),
        ("first_pass", metadata.first_pass.to_string()),
        ("parts", metadata.parts_text()),
        ("passes", metadata.passes.to_string()),
        ("seconds", metadata.seconds.to_string()),
        ("version", metadata.version.clone()),
        ("channels", colours.join(",")),
        ("non_finite", metadata.non_finite.to_string()),
        ("figures", figures.join("\n")),
        ("notes", notes.clone()),
    ];
    let mut attributes = LayerAttributes::default();
    let given = texts.into_iter().filter(|(_, value)| !value.is_empty());
    attributes.other.extend(given.map(|(key, value)| {
        let key = text(&format!("tyndall.{key}"));
        (key, AttributeValue::Text(text(&value)))
    }));
    attributes.software_name = Some(text(format!("Tyndall {}", metadata.version).trim_end()));
    attributes.comments = (!notes.is_empty()).then(|| text(&notes));
    attributes
}

/// EXR texts are bytes; UTF-8 passes as it is.
fn text(text: &str) -> Text {
    Text::from_bytes_unchecked(text.bytes().collect())
}

fn place(attributes: &mut LayerAttributes, view: &View) {
    let [x, y] = view.offset.map(|n| n as i32);
    attributes.layer_position = Vec2(x, y);
    attributes.screen_window_width = view.screen_width;
    let [right, up, back] = view.axes;
    let column = |i: usize| [right[i], up[i], back[i], 0.0];
    let shift = [view.shift.x, view.shift.y, view.shift.z, 1.0];
    let rows = [column(0), column(1), column(2), shift].concat();
    // No zero with a sign.
    let rows: Vec<_> = rows.iter().map(|x| x + 0.0).collect();
    attributes.world_to_camera = rows.try_into().ok();
}
