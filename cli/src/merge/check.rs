//! Which images may be averaged.

use std::fmt::Debug;
use std::path::{Path, PathBuf};
use tyndall_scene_io::{Metadata, PassRange, RenderedImage, TooManyPasses};

/// Why images may not be averaged.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Refusal {
    #[error("{}: {problem}: merge takes images of `tyndall render`, render it again", path.display())]
    Unmarked {
        path: PathBuf,
        problem: &'static str,
    },
    #[error(
        "{}: its {what} is {theirs}, that of {} is {ours}: merge renders of one picture",
        path.display(), first.display()
    )]
    Different {
        path: PathBuf,
        first: PathBuf,
        what: &'static str,
        theirs: String,
        ours: String,
    },
    #[error(
        "{}: holds {shared}, which {} holds too: give every render another --seed, or a --first-pass \
         behind the other's last",
        path.display(), other.display()
    )]
    Overlap {
        path: PathBuf,
        other: PathBuf,
        shared: PassRange,
    },
    #[error("{}: {source} with it: leave it out", path.display())]
    TooMany {
        path: PathBuf,
        source: TooManyPasses,
    },
}

/// The variance of an image that says what a merge must know.
pub(super) fn marked<'a>(path: &Path, image: &'a RenderedImage) -> Result<&'a [Vec<f32>], Refusal> {
    let finite = |planes: &[Vec<f32>]| planes.iter().flatten().all(|x| x.is_finite());
    let problem = match &image.variance {
        _ if image.metadata.fingerprint.is_empty() => {
            "has no attribute `tyndall.fingerprint`, which tells its scene"
        }
        _ if image.metadata.passes == 0 => {
            "has no attribute `tyndall.passes`, which tells its weight"
        }
        None => "has no layer `variance`",
        // The variance after a single pass is infinite.
        Some(variance)
            if !finite(&image.radiance) || !(image.metadata.passes == 1 || finite(variance)) =>
        {
            "has values that are not finite"
        }
        Some(variance) => return Ok(variance),
    };
    let path = path.to_owned();
    Err(Refusal::Unmarked { path, problem })
}

/// Whether an image shows what the first shows, by the same method, and says what a merge must know.
pub(super) fn same_picture(
    (first, ours): (&Path, &RenderedImage),
    (path, theirs): (&Path, &RenderedImage),
) -> Result<(), Refusal> {
    marked(path, theirs)?;
    // Numbers and texts that are written alike are alike.
    let same = |what, ours: &dyn Debug, theirs: &dyn Debug| {
        let [ours, theirs] = [ours, theirs].map(|value| format!("{value:?}"));
        match ours == theirs {
            true => Ok(()),
            false => Err(Refusal::Different {
                path: path.to_owned(),
                first: first.to_owned(),
                what,
                theirs,
                ours,
            }),
        }
    };
    let (a, b) = (&ours.metadata, &theirs.metadata);
    same("scene (fingerprint)", &a.fingerprint, &b.fingerprint)?;
    same("integrator", &a.integrator, &b.integrator)?;
    let size = |image: &RenderedImage| [image.width, image.height];
    same("resolution", &size(ours), &size(theirs))?;
    same("place in the picture", &ours.position, &theirs.position)?;
    same("picture", &ours.picture, &theirs.picture)?;
    same(
        "number of channels",
        &ours.radiance.len(),
        &theirs.radiance.len(),
    )?;
    same("list of layers", &layers(ours), &layers(theirs))
}

/// Names of the layers that an image has beside radiance.
fn layers(image: &RenderedImage) -> Vec<&'static str> {
    let all = [
        ("variance", image.variance.is_some()),
        ("features", image.features.is_some()),
    ];
    let present = all.into_iter().filter(|(_, present)| *present);
    present.map(|(name, _)| name).collect()
}

/// Whether two images share no pass.
pub(super) fn independent(
    (other, ours): (&Path, &Metadata),
    (path, theirs): (&Path, &Metadata),
) -> Result<(), Refusal> {
    match ours.shared_passes(theirs) {
        None => Ok(()),
        Some(shared) => Err(Refusal::Overlap {
            path: path.to_owned(),
            other: other.to_owned(),
            shared,
        }),
    }
}
