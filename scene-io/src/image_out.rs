//! Images to files: complete or not at all.

mod exr_file;
mod passes;
mod png_file;

pub use exr_file::write_exr;
pub use passes::{PassRange, TooManyPasses};
pub use png_file::write_png;

use crate::{Error, Features};
use glam::Vec3;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;
use tempfile::NamedTempFile;
use tyndall_core::Figure;

/// A rendered image.
#[derive(Clone, Debug)]
pub struct RenderOutput<'a, S> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Radiance, row by row from the top.
    pub radiance: &'a [S],
    /// Variance of `radiance` as an estimate of the mean, in the same order.
    pub variance: &'a [S],
    /// What the sensor's rays meet first, in the same order.
    pub features: Option<&'a Features>,
    /// Which part of which picture it is, and from where it was taken.
    pub view: Option<&'a View>,
    /// How it came to be.
    pub metadata: &'a Metadata,
}

/// The camera of an image, as image files describe it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct View {
    /// Width and height in pixels of the whole picture.
    pub picture: [u32; 2],
    /// The pixel of it that is the first of the image.
    pub offset: [u32; 2],
    /// The camera's axes in the world: right, up, back.
    pub axes: [Vec3; 3],
    /// The world's origin in the camera's axes.
    pub shift: Vec3,
    /// Width of the whole picture in scene units, at distance 1 from a camera with perspective.
    pub screen_width: f32,
}

/// How an image came to be; written into the EXR file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// The scene file.
    pub scene: String,
    /// Identifies the scene's contents: only images of equal ones can be merged.
    pub fingerprint: String,
    /// The integrator and all its options, defaults filled in: name, then ` key value`, between
    /// commas.
    pub integrator: String,
    /// Seed of the random numbers; of a merge, that of the first of `parts`.
    pub seed: u64,
    /// Index of the first pass; images of one seed whose passes overlap share random numbers.
    pub first_pass: u64,
    /// Passes that were averaged, which is the number of samples of every pixel.
    pub passes: u64,
    /// Of a merge, the passes of every render in it; empty for one render.
    pub parts: Vec<PassRange>,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Version of the program.
    pub version: String,
    /// Samples that were NaN or infinite and count as black: a defect.
    pub non_finite: u64,
    /// What the integrator tells of its passes: errors met, radii, light paths.
    pub figures: Vec<Figure>,
    /// What else a reader must know: a bias.
    pub notes: Vec<String>,
}

impl<S> RenderOutput<'_, S> {
    fn check(&self, path: &Path) -> Result<(), Error> {
        let pixels = self.width as usize * self.height as usize;
        let mut counts = vec![
            ("radiance", self.radiance.len()),
            ("variance", self.variance.len()),
        ];
        if let Some(features) = self.features {
            counts.push(("albedo", features.albedo.len()));
            counts.push(("normal", features.normal.len()));
            counts.push(("depth", features.depth.len()));
        }
        match counts
            .iter()
            .find(|(_, count)| pixels == 0 || *count != pixels)
        {
            None => Ok(()),
            Some((what, count)) => {
                let why = format!("{pixels} pixels, {count} of {what}");
                Err(Error::write(path, why))
            }
        }
    }
}

/// Whether an image could be written to `path`: asked before hours are spent on it. Leaves nothing.
///
/// # Errors
/// [`Error::Write`].
pub fn check_writable(path: &Path) -> Result<(), Error> {
    if path.is_dir() {
        return Err(Error::write(path, "it is a folder: name a file in it"));
    }
    temporary(path).map(drop)
}

/// Writes to a temporary file beside `path`, then renames it.
pub(crate) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), String>,
) -> Result<(), Error> {
    let file = temporary(path)?;
    let mut buffer = BufWriter::new(file.as_file());
    write(&mut buffer).map_err(|e| Error::write(path, e))?;
    buffer.flush().map_err(|e| Error::write(path, e))?;
    drop(buffer);
    // Else a loss of power after the renaming could leave an empty file in place of the old image.
    (file.as_file().sync_all()).map_err(|e| Error::write(path, e))?;
    (file.persist(path)).map_err(|e| Error::write(path, e.error))?;
    Ok(())
}

/// A file in the folder of `path` that vanishes unless it is renamed.
fn temporary(path: &Path) -> Result<NamedTempFile, Error> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tyndall-");
    #[cfg(unix)]
    {
        // What the user's mask allows, as for any other file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    (builder.tempfile_in(folder)).map_err(|e| match e.kind() {
        ErrorKind::NotFound => Error::write(path, "its folder is not there: make the folder"),
        ErrorKind::NotADirectory => Error::write(path, "its folder is a file: name another place"),
        _ => Error::write(path, format!("{e}: name another place")),
    })
}
