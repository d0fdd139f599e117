//! `tyndall diff`.

mod errors;
#[cfg(feature = "flip")]
mod flip;
mod pair;
mod report;
mod significance;

use crate::failure::Error;
use clap::Args;
use pair::Pair;
use report::Report;
use std::io::Write;
use std::path::PathBuf;
use tyndall_scene_io::read_exr;

pub(crate) use pair::Mismatch;

/// What is printed, for `--help`.
pub(crate) const FIGURES: &str = "\
Figures, over the pixels that are finite in both and over channels (grey counts as equal R, G, B):
  MSE         mean of (a − b)²; b is the reference
  relMSE      mean of (a − b)² / (b² + 0.01)
  mean ratio  mean of a over mean of b, ± its standard error if both have variances
  largest     |a − b|, and where
  FLIP        what people see (if built with the feature `flip`): HDR-FLIP over ACES-mapped
              exposures, 0 to 1
  z-test      if both have variances, two or more passes, and no pass in common. In each channel:
              the pixel that differs most, χ² of all pixels, and the mean. Images of one
              expectation are found to differ with a probability of at most 0.1 %, if the means of
              their pixels are normal: take many passes for both.";

/// The command line.
#[derive(Debug, Args)]
pub(crate) struct DiffArguments {
    /// The image, an EXR.
    #[arg(value_name = "A.exr")]
    image: PathBuf,
    /// The reference, an EXR of the same size.
    #[arg(value_name = "B.exr")]
    reference: PathBuf,
    /// For programs: JSON instead of text; what is infinite or missing is null.
    #[arg(long)]
    json: bool,
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
