//! The command line.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::time::Duration;
use tyndall_driver::Budget;

#[derive(Debug, Parser)]
#[command(
    name = "tyndall",
    version,
    about = "Renders scenes with participating media"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to an image. Ctrl-C stops after the current pass and writes the image.
    Render(RenderArguments),
    /// Compare an image with a reference. Exits with 0 whether they agree or not: a script takes
    /// the verdict from --json.
    #[command(after_help = DIFF_FIGURES)]
    Diff(DiffArguments),
    /// Average renders of one scene with different seeds, weighted by their passes.
    Merge(MergeArguments),
}

/// What `diff` prints.
const DIFF_FIGURES: &str = "\
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

#[derive(Debug, Args)]
pub(crate) struct DiffArguments {
    /// The image, an EXR.
    #[arg(value_name = "A.exr")]
    pub(crate) image: PathBuf,
    /// The reference, an EXR of the same size.
    #[arg(value_name = "B.exr")]
    pub(crate) reference: PathBuf,
    /// For programs: JSON instead of text; what is infinite or missing is null.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// The images: of one scene, integrator and size, and of different seeds (or different passes
    /// of a seed). A merge may be merged again.
    #[arg(value_name = "PART.exr", required = true, num_args = 2..)]
    pub(crate) parts: Vec<PathBuf>,
    /// The merged image.
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr)]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// The scene file (TOML).
    pub(crate) scene: PathBuf,
    /// The image: radiance and its variance, as EXR.
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr)]
    pub(crate) output: PathBuf,
    /// A tone-mapped copy.
    #[arg(long, value_name = "OUT.png")]
    pub(crate) png: Option<PathBuf>,
    /// Instead of the scene's own integrator.
    #[arg(long, value_name = "NAME")]
    pub(crate) integrator: Option<String>,
    #[command(flatten)]
    budget: BudgetArguments,
    /// Another seed gives an independent image.
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Threads to render on; all cores by default.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
    /// Overrides a value of the scene file, as in `--set film.width=64`.
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

/// When to stop; the scene's own number of passes by default.
#[derive(Debug, Args)]
#[group(multiple = false)]
struct BudgetArguments {
    /// Stop after this many passes (samples a pixel).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    passes: Option<u64>,
    /// Stop after this time, as in 30s, 5m, 1h.
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time: Option<Duration>,
    /// Stop at this relative standard error (root mean square over the image).
    #[arg(long, value_name = "ERROR", value_parser = positive)]
    error: Option<f64>,
}

impl RenderArguments {
    /// What the command line asks for, if it does.
    pub(crate) fn budget(&self) -> Option<Budget> {
        let BudgetArguments {
            passes,
            time,
            error,
        } = self.budget;
        passes
            .map(Budget::Passes)
            .or(time.map(Budget::Time))
            .or(error.map(Budget::RelativeError))
    }
}

fn exr(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("exr") => Ok(path),
        _ => Err("the image is an EXR: name it OUT.exr (a PNG comes with --png)".into()),
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.into(), value.into())),
        _ => Err("expected KEY=VALUE, as in film.width=64".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(value),
        _ => Err("expected a positive number, as in 0.01".into()),
    }
}

fn duration(text: &str) -> Result<Duration, String> {
    let digits = text.trim_end_matches(char::is_alphabetic);
    let seconds = match &text[digits.len()..] {
        "" | "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        unit => return Err(format!("the unit `{unit}` is none of s, m, h")),
    };
    let time = positive(digits).map_err(|_| "expected a time, as in 30s, 5m or 1h".to_string())?;
    Duration::try_from_secs_f64(time * seconds).map_err(|e| e.to_string())
}
