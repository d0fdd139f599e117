//! `tyndall diff`.

mod errors;
#[cfg(feature = "flip")]
mod flip;
mod pair;
mod report;
mod significance;

use crate::arguments::DiffArguments;
use pair::{Mismatch, Pair};
use report::Report;
use std::io::Write;
use tyndall_scene_io::read_exr;

/// Why images were not compared.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    #[error(transparent)]
    Image(#[from] tyndall_scene_io::Error),
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    #[error("the figures could not be written: {0}")]
    Output(#[from] std::io::Error),
}

/// Compares two images and prints the figures. Success says that they could be compared, not that
/// they agree.
pub(crate) fn run(arguments: &DiffArguments) -> Result<(), Error> {
    let image = read_exr(&arguments.image)?;
    let reference = read_exr(&arguments.reference)?;
    let pair = Pair::new(arguments, &image, &reference)?;
    let report = Report::of(arguments, &pair);
    let mut out = std::io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &report).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    Ok(out.flush()?)
}
