//! The command line.

use crate::diff::DiffArguments;
use crate::integrators::INTEGRATORS;
use crate::merge::MergeArguments;
use crate::volume::VolumeCommand;
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;
use tyndall_driver::Budget;

/// What a script can tell from the exit code.
const EXIT_CODES: &str = "\
Exit codes:
  0    done; also a render stopped by Ctrl-C that wrote its image
  1    the render failed, or anything else that has no code of its own
  2    the command line is wrong
  3    the scene, a file that it names, an image or a volume cannot be read, rendered or converted
  4    an image or a file cannot be written (no rights, disk full); what was there is untouched
  5    the checkpoint to resume from is damaged or of another render
  130  a second Ctrl-C did not wait for the pass";

#[derive(Debug, Parser)]
#[command(
    name = "tyndall",
    version,
    about = "Renders scenes with participating media: scene files (TOML) and glTF (.gltf, .glb)",
    after_help = EXIT_CODES
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to an image. Ctrl-C stops and writes what there is.
    Render(RenderArguments),
    /// Compare an image with a reference. Exits with 0 whether they agree or not: a script takes
    /// the verdict from --json.
    #[command(after_help = crate::diff::FIGURES)]
    Diff(DiffArguments),
    /// Average renders of one scene with different seeds or passes, weighted by their passes.
    Merge(MergeArguments),
    /// Tell what a scene holds and which transport it needs, or what the grids of a volume hold.
    Inspect(InspectArguments),
    /// Convert volume files.
    #[command(subcommand)]
    Volume(VolumeCommand),
    /// Print a script that completes the command in a shell.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// Leaves room for as many passes as anybody can render.
const LAST_FIRST_PASS: u64 = 1 << 62;

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// The scene: a scene file (TOML), or a glTF file (`.gltf`, `.glb`).
    pub(crate) scene: PathBuf,
    /// The image, as EXR: radiance, its variance, samples, and the albedo, normal and depth that
    /// denoisers take.
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr)]
    pub(crate) output: PathBuf,
    /// A tone-mapped copy.
    #[arg(long, value_name = "OUT.png", value_parser = png)]
    pub(crate) png: Option<PathBuf>,
    /// Instead of the scene's own integrator.
    #[arg(long, value_name = "NAME", value_parser = INTEGRATORS)]
    pub(crate) integrator: Option<String>,
    #[command(flatten)]
    budget: BudgetArguments,
    /// Another seed gives an independent image.
    #[arg(long, default_value_t = 0, value_parser = |text: &str| whole(text, 0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Begin with this pass, counted from 0: a part of a render whose other passes are rendered
    /// elsewhere with the same seed, to be joined by `tyndall merge`.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = |text: &str| whole(text, 0..=LAST_FIRST_PASS))]
    pub(crate) first_pass: u64,
    /// Threads to render on; all cores by default.
    #[arg(long, value_parser = |text: &str| whole(text, 1..=u16::MAX))]
    pub(crate) threads: Option<u16>,
    /// Overrides a value of the scene file, as in `--set film.width=64`.
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
    /// Go on from OUT.exr.checkpoint, which a render leaves now and then and on Ctrl-C: the
    /// image is the same to the bit as without the interruption.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Show the image in a running tev while it renders.
    #[arg(long, value_name = "HOST:PORT", value_parser = address)]
    pub(crate) tev: Option<String>,
    /// Time between checkpoints.
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "60s")]
    pub(crate) checkpoint_interval: Duration,
}

#[derive(Debug, Args)]
pub(crate) struct InspectArguments {
    /// A scene: a scene file (TOML), or a glTF file (`.gltf`, `.glb`); or a volume: `.vdb`, `.nvdb`
    /// or `.vol`.
    pub(crate) file: PathBuf,
    /// For programs: JSON instead of text.
    #[arg(long)]
    pub(crate) json: bool,
    /// Overrides a value of a scene file, as in `--set film.width=64`.
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

/// When to stop; the scene's own number of passes by default.
#[derive(Debug, Args)]
#[group(multiple = false)]
struct BudgetArguments {
    /// Stop after this many passes (samples a pixel).
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1..=u64::MAX))]
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

pub(crate) fn exr(text: &str) -> Result<PathBuf, String> {
    let path = named(text, "exr");
    path.ok_or_else(|| "the image is an EXR: name it OUT.exr (a PNG comes with --png)".into())
}

fn png(text: &str) -> Result<PathBuf, String> {
    named(text, "png").ok_or_else(|| "the copy is a PNG: name it OUT.png".into())
}

/// A path with this extension.
fn named(text: &str, extension: &str) -> Option<PathBuf> {
    let path = PathBuf::from(text);
    let found = path.extension()?;
    found.eq_ignore_ascii_case(extension).then_some(path)
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.into(), value.into())),
        _ => Err("expected KEY=VALUE, as in film.width=64".into()),
    }
}

fn address(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.into()),
        _ => Err("expected HOST:PORT, as in localhost:14158 (where tev listens by default)".into()),
    }
}

fn whole<T>(text: &str, range: RangeInclusive<T>) -> Result<T, String>
where
    T: FromStr + PartialOrd + Display,
{
    let (least, most) = (range.start(), range.end());
    let number = text.parse().ok().filter(|n| range.contains(n));
    number.ok_or_else(|| format!("expected a whole number from {least} to {most}"))
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
    Duration::try_from_secs_f64(time * seconds).map_err(|_| "is too long: lower it".to_string())
}
