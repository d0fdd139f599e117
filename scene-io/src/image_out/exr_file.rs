//! OpenEXR.

use super::{Metadata, RenderOutput, write_whole};
use crate::Error;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    Text, WritableImage,
};
use std::path::Path;
use tyndall_core::Spectrum;

/// Writes radiance and variance as 32-bit floats.
///
/// Channels are `R`, `G`, `B` or, with one channel, `Y`; the variance of the mean is `variance.R`
/// and so on. Metadata are attributes `tyndall.scene`, `.fingerprint`, `.integrator`, `.seed`,
/// `.first_pass` (if not 0), `.passes`, `.parts` (of a merge: a line of seed, first pass and passes
/// each), `.seconds`, `.version` and `.notes` (one a line).
///
/// # Errors
/// [`Error::Write`]; a file that was there before is untouched then.
pub fn write_exr<S: Spectrum>(path: &Path, output: &RenderOutput<'_, S>) -> Result<(), Error> {
    output.check(path)?;
    let names: &[&str] = if S::CHANNELS == 1 {
        &["Y"]
    } else {
        &["R", "G", "B"]
    };
    let plane = |values: &[S], i| FlatSamples::F32(values.iter().map(|s| s.channel(i)).collect());
    let channels = (names.iter().enumerate()).flat_map(|(i, name)| {
        let variance = format!("variance.{name}");
        [
            AnyChannel::new(*name, plane(output.radiance, i)),
            AnyChannel::new(variance.as_str(), plane(output.variance, i)),
        ]
    });
    let mut attributes = LayerAttributes::default();
    attributes.other.extend(described(output.metadata));
    let layer = Layer::new(
        (output.width as usize, output.height as usize),
        attributes,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.collect()),
    );
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = Image::from_layer(layer);
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| Error::write(path, e))?;
    write_whole(path, |file| {
        std::io::Write::write_all(file, bytes.get_ref()).map_err(|e| e.to_string())
    })
}

fn described(metadata: &Metadata) -> impl Iterator<Item = (Text, AttributeValue)> {
    let first_pass = match metadata.first_pass {
        0 => String::new(),
        pass => pass.to_string(),
    };
    let texts = [
        ("scene", metadata.scene.clone()),
        ("fingerprint", metadata.fingerprint.clone()),
        ("integrator", metadata.integrator.clone()),
        ("seed", metadata.seed.to_string()),
        ("first_pass", first_pass),
        ("parts", metadata.parts_text()),
        ("passes", metadata.passes.to_string()),
        ("seconds", metadata.seconds.to_string()),
        ("version", metadata.version.clone()),
        ("notes", metadata.notes.join("\n")),
    ];
    texts
        .into_iter()
        .filter(|(_, text)| !text.is_empty())
        .map(|(key, text)| {
            // EXR texts are bytes; UTF-8 passes as it is.
            let text: exr::prelude::Text = Text::from_bytes_unchecked(text.bytes().collect());
            (
                Text::from(format!("tyndall.{key}").as_str()),
                AttributeValue::Text(text),
            )
        })
}
