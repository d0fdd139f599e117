//! `tyndall volume`.

mod convert;

use crate::failure::Error;
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};
use tyndall_scene_io::VolumeFormat;

/// The command line.
#[derive(Debug, Subcommand)]
pub(crate) enum VolumeCommand {
    /// Write the grids of a volume file to another: OpenVDB (`.vdb`), NanoVDB (`.nvdb`) or a dense
    /// grid (`.vol`).
    #[command(after_help = FORMATS)]
    Convert(ConvertArguments),
}

/// What each file takes, for `--help`.
const FORMATS: &str = "\
What is written:
  .vdb   OpenVDB 224, zip: float or vec3s, saved as half if read so or with --half
  .nvdb  NanoVDB 32.4, zip: float or Vec3f
  .vol   one grid along the axes, in 32-bit floats: all that is not background, and one voxel around
Names, classes, transforms, backgrounds, tiles and active states are kept where the file can hold them.
A .vol file read is a grid called `density` (one channel) or `albedo` (three); its zeros are inactive.";

#[derive(Debug, Args)]
pub(crate) struct ConvertArguments {
    /// The volume: `.vdb`, `.nvdb` or `.vol`.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The file to write; its extension says what: `.vdb`, `.nvdb` or `.vol`.
    #[arg(short, long, value_name = "OUT", value_parser = output)]
    output: Output,
    /// Only grids of this name; may be repeated. All that can be read by default.
    #[arg(long = "grid", value_name = "NAME")]
    grids: Vec<String>,
    /// Round values to 16 bits, which halves the memory of a grid: only for `.vdb`.
    #[arg(long)]
    half: bool,
    /// Make level sets fog: 1 inside, falling linearly to 0 at the surface over the half width of
    /// their band.
    #[arg(long)]
    fog: bool,
}

/// A file to write, and of which kind it is.
#[derive(Clone, Debug)]
struct Output {
    path: PathBuf,
    format: VolumeFormat,
}

fn output(text: &str) -> Result<Output, String> {
    let path = PathBuf::from(text);
    match VolumeFormat::of(Path::new(text)) {
        Some(format) => Ok(Output { path, format }),
        None => {
            Err("the extension says what is written: name it OUT.vdb, OUT.nvdb or OUT.vol".into())
        }
    }
}

/// Does what it is told.
pub(crate) fn run(command: &VolumeCommand) -> Result<(), Error> {
    match command {
        VolumeCommand::Convert(arguments) => convert::run(arguments),
    }
}
