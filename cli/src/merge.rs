//! `tyndall merge`.

mod check;

use crate::arguments::exr;
use crate::failure::Error;
use crate::image::{INTERRUPTED, spectra, tell};
use crate::integrators::SHRINKING;
use crate::progress::message;
use check::{independent, same_picture};
use clap::Args;
use std::path::{Path, PathBuf};
use tyndall_core::{Figure, Rgb, Spectrum};
use tyndall_driver::Film;
use tyndall_scene_io::{
    Features, Metadata, RenderOutput, RenderedImage, TooManyPasses, View, check_writable, read_exr,
    write_exr,
};

pub(crate) use check::Refusal;

/// Said of parts that are wider in their radii than one render of as many passes.
const REPEATED: &str = "more biased than one render of as many passes, for every seed begins with \
                        the largest radius: render parts with one --seed, each with a --first-pass";

/// The command line.
#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// The images: of one scene, integrator and size, and of different seeds (or different passes
    /// of a seed). A merge may be merged again.
    #[arg(value_name = "PART.exr", required = true, num_args = 2..)]
    parts: Vec<PathBuf>,
    /// The merged image.
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr)]
    output: PathBuf,
}

/// Averages images and writes the result.
pub(crate) fn run(arguments: &MergeArguments) -> Result<(), Error> {
    check_writable(&arguments.output)?;
    let (first, rest) = (&arguments.parts[0], &arguments.parts[1..]);
    let image = read_exr(first)?;
    match image.radiance.len() {
        1 => merge::<f32>(first, &image, rest, &arguments.output),
        _ => merge::<Rgb>(first, &image, rest, &arguments.output),
    }
}

/// Adds the other parts to the first, one in memory at a time.
fn merge<S: Spectrum>(
    first_path: &Path,
    first: &RenderedImage,
    rest: &[PathBuf],
    output: &Path,
) -> Result<(), Error> {
    let mut film = film::<S>(first_path, first)?;
    let mut features = first.features.clone();
    let mut metadata = Metadata {
        version: env!("CARGO_PKG_VERSION").into(),
        ..first.metadata.clone()
    };
    let mut parts = vec![(first_path, first.metadata.clone())];
    for path in rest {
        let image = read_exr(path)?;
        same_picture((first_path, first), (path, &image))?;
        for (other, metadata) in &parts {
            independent((other, metadata), (path, &image.metadata))?;
        }
        join(&mut metadata, &image.metadata).map_err(|source| Refusal::TooMany {
            path: path.clone(),
            source,
        })?;
        film.merge(&self::film(path, &image)?)?;
        if let (Some(ours), Some(theirs)) = (&mut features, &image.features) {
            let share = image.metadata.passes as f64 / film.passes() as f64;
            average(ours, theirs, share as f32);
        }
        parts.push((path, image.metadata));
    }
    // What was stopped is whole in the merge: its passes are counted.
    metadata
        .notes
        .retain(|note| note != INTERRUPTED && note != REPEATED);
    if metadata.notes.iter().any(|note| note == SHRINKING) && metadata.repeats_passes() {
        metadata.notes.push(REPEATED.into());
    }
    for missing in metadata.missing_passes() {
        message(&format!("note: no part holds {missing}"));
    }
    write(
        output,
        &film,
        features.as_ref(),
        first.view.as_ref(),
        &metadata,
    )?;
    message(&format!(
        "{}: {} passes of {} images, relative error {:.2} %",
        output.display(),
        film.passes(),
        rest.len() + 1,
        100.0 * film.relative_error(),
    ));
    tell(&metadata);
    Ok(())
}

fn write<S: Spectrum>(
    path: &Path,
    film: &Film<S>,
    features: Option<&Features>,
    view: Option<&View>,
    metadata: &Metadata,
) -> Result<(), tyndall_scene_io::Error> {
    let [width, height] = film.resolution();
    let output = RenderOutput {
        width,
        height,
        radiance: &spectra::<S>(film.mean().iter().copied()),
        variance: &spectra::<S>(film.variance_of_mean()),
        features,
        view,
        metadata,
    };
    write_exr(path, &output)
}

/// The passes behind an image.
fn film<S: Spectrum>(path: &Path, image: &RenderedImage) -> Result<Film<S>, Refusal> {
    let variance = check::marked(path, image)?;
    let interleaved = |planes: &[Vec<f32>]| -> Vec<f64> {
        let pixels = 0..planes[0].len();
        pixels
            .flat_map(|i| planes.iter().map(move |plane| f64::from(plane[i])))
            .collect()
    };
    Ok(Film::from_image(
        [image.width, image.height],
        image.metadata.passes,
        interleaved(&image.radiance),
        &interleaved(variance),
    ))
}

/// How the merge came to be: says that it holds another part. Notes stay that are true of all.
fn join(merged: &mut Metadata, part: &Metadata) -> Result<(), TooManyPasses> {
    merged.add_passes(part)?;
    merged.seconds += part.seconds;
    merged.non_finite = merged.non_finite.saturating_add(part.non_finite);
    Figure::gather(&mut merged.figures, part.figures.iter().cloned());
    merged.notes.retain(|note| part.notes.contains(note));
    Ok(())
}

/// Moves features towards those of another part, which has this share of the samples. Depth is a
/// mean over what was met: where one part met nothing, it is that of the other.
fn average(ours: &mut Features, theirs: &Features, share: f32) {
    for (ours, theirs) in ours.albedo.iter_mut().zip(&theirs.albedo) {
        *ours += (*theirs - *ours) * share;
    }
    for (ours, theirs) in ours.normal.iter_mut().zip(&theirs.normal) {
        *ours += (*theirs - *ours) * share;
    }
    for (ours, theirs) in ours.depth.iter_mut().zip(&theirs.depth) {
        if ours.is_infinite() {
            *ours = *theirs;
        } else if theirs.is_finite() {
            *ours += (*theirs - *ours) * share;
        }
    }
}
