//! The image of a render, and what a reader of it must know.

use crate::arguments::RenderArguments;
use crate::failure::Error;
use crate::render::scattering;
use tyndall_core::Spectrum;
use tyndall_driver::{Film, PassStreams};
use tyndall_path::Scattering;
use tyndall_scene_io::{IntegratorConfig, Metadata, RenderOutput, Scene, write_exr, write_png};

/// Samples a pixel of albedo, normal and depth, unless there were fewer passes.
const FEATURE_SAMPLES: u64 = 16;

/// What a reader of the image must know.
pub(crate) fn notes<S: Spectrum>(
    config: &IntegratorConfig,
    film: &Film<S>,
    interrupted: bool,
) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(depth) = config.max_depth {
        notes.push(format!(
            "biased: paths of more than {depth} scatterings are left out (max_depth)"
        ));
    }
    match scattering(config) {
        Scattering::Multiple => {}
        Scattering::Single => {
            notes.push("light that media scatter more than once is left out (scattering)".into())
        }
        Scattering::None => {
            notes.push("light that media scatter is left out (scattering)".into());
        }
    }
    if film.mean().iter().all(|value| *value == 0.0) {
        notes.push("the image is black: no light was found".into());
    }
    if film.non_finite() > 0 {
        notes.push(format!(
            "{} samples were not finite and count as black: please report the scene",
            film.non_finite()
        ));
    }
    if interrupted {
        notes.push("interrupted: the image holds the passes finished until then".into());
    }
    notes
}

/// Writes the EXR, then the PNG.
pub(crate) fn write<S: Spectrum>(
    arguments: &RenderArguments,
    scene: &Scene<S>,
    film: &Film<S>,
    metadata: &Metadata,
) -> Result<(), Error> {
    let spectra = |values: Vec<f64>| -> Vec<S> {
        values
            .chunks_exact(S::CHANNELS)
            .map(|pixel| S::from_channels(|i| pixel[i] as f32))
            .collect()
    };
    let radiance = spectra(film.mean().to_vec());
    let variance = spectra(film.variance_of_mean().collect());
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
