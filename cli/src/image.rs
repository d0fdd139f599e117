//! The image of a render, and what a reader of it must know.

use crate::arguments::RenderArguments;
use crate::failure::Error;
use crate::progress::message;
use tyndall_core::Spectrum;
use tyndall_driver::{Film, PassStreams};
use tyndall_scene_io::{Metadata, RenderOutput, Scene, write_exr, write_png};

/// Samples a pixel of albedo, normal and depth, unless there were fewer passes.
const FEATURE_SAMPLES: u64 = 16;

/// What a render that was stopped says.
pub(crate) const INTERRUPTED: &str = "interrupted: the image holds the passes finished until then";

/// What a reader of the image must know, the biases of its integrator first.
pub(crate) fn notes<S: Spectrum>(
    mut notes: Vec<String>,
    film: &Film<S>,
    interrupted: bool,
) -> Vec<String> {
    if film.mean().iter().all(|value| *value == 0.0) {
        notes.push("the image is black: no light was found".into());
    }
    if interrupted {
        notes.push(INTERRUPTED.into());
    }
    notes
}

/// Says what a reader of the image must know, and what its integrator tells.
pub(crate) fn tell(metadata: &Metadata) {
    if !metadata.figures.is_empty() {
        let figures: Vec<_> = metadata.figures.iter().map(ToString::to_string).collect();
        message(&figures.join("; "));
    }
    for note in &metadata.notes {
        message(&format!("note: {note}"));
    }
    if metadata.non_finite > 0 {
        message(&format!(
            "note: {} samples were not finite and count as black: please report the scene",
            metadata.non_finite
        ));
    }
}

/// The pixels of a film's values.
pub(crate) fn spectra<S: Spectrum>(values: impl IntoIterator<Item = f64>) -> Vec<S> {
    let values: Vec<_> = values.into_iter().collect();
    let pixels = values.chunks_exact(S::CHANNELS);
    pixels
        .map(|pixel| S::from_channels(|i| pixel[i] as f32))
        .collect()
}

/// Writes the EXR, then the PNG.
pub(crate) fn write<S: Spectrum>(
    arguments: &RenderArguments,
    scene: &Scene<S>,
    film: &Film<S>,
    metadata: &Metadata,
) -> Result<(), Error> {
    let radiance = spectra::<S>(film.mean().iter().copied());
    let variance = spectra::<S>(film.variance_of_mean());
    let [width, height] = film.resolution();
    // Another render of the same seed sees the same features, however often it was interrupted.
    let streams = PassStreams::new(arguments.seed, 0);
    let samples = film.passes().min(FEATURE_SAMPLES) as u32;
    let features = scene.features(&streams, samples);
    let output = RenderOutput {
        width,
        height,
        radiance: &radiance,
        variance: &variance,
        features: Some(&features),
        view: Some(&scene.view()),
        metadata,
    };
    write_exr(&arguments.output, &output)?;
    if let Some(png) = &arguments.png {
        write_png(png, &output, None)?;
    }
    Ok(())
}
