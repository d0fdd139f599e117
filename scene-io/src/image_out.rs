//! Images to files: complete or not at all.

mod exr_file;
mod passes;
mod png_file;

pub use exr_file::write_exr;
pub use passes::PassRange;
pub use png_file::write_png;

use crate::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use tempfile::NamedTempFile;

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
    /// How it came to be.
    pub metadata: &'a Metadata,
}

/// How an image came to be; written into the EXR file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// The scene file.
    pub scene: String,
    /// Of all that the picture depends on but the integrator and the seed; empty if unknown.
    /// Images of one fingerprint, integrator and size may be merged.
    pub fingerprint: String,
    /// The integrator and its settings.
    pub integrator: String,
    /// Seed of the random numbers; of a merge, that of the first of `parts`.
    pub seed: u64,
    /// The first pass: random numbers depend on the seed and the pass.
    pub first_pass: u64,
    /// Passes that were averaged.
    pub passes: u64,
    /// Of a merge, the passes of every render in it; empty for one render.
    pub parts: Vec<PassRange>,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Version of the program.
    pub version: String,
    /// What else a reader must know: a bias, samples that were not finite.
    pub notes: Vec<String>,
}

impl<S> RenderOutput<'_, S> {
    fn check(&self, path: &Path) -> Result<(), Error> {
        let pixels = self.width as usize * self.height as usize;
        if pixels == 0 || self.radiance.len() != pixels || self.variance.len() != pixels {
            let (radiance, variance) = (self.radiance.len(), self.variance.len());
            return Err(Error::write(
                path,
                format!("{pixels} pixels, {radiance} of radiance and {variance} of variance"),
            ));
        }
        Ok(())
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
fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), String>,
) -> Result<(), Error> {
    let file = temporary(path)?;
    let mut buffer = BufWriter::new(file.as_file());
    write(&mut buffer).map_err(|e| Error::write(path, e))?;
    buffer.flush().map_err(|e| Error::write(path, e))?;
    drop(buffer);
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
    (builder.tempfile_in(folder)).map_err(|e| Error::write(path, e))
}
