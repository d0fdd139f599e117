//! `tyndall`: renders scenes with participating media. `tyndall --help` lists the exit codes.
#![forbid(unsafe_code)]

mod arguments;
mod checkpoint;
mod diff;
mod failure;
mod image;
mod inspect;
mod integrators;
mod keeper;
mod merge;
mod preview;
mod progress;
mod render;
mod volume;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Diff(arguments) => diff::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Volume(command) => volume::run(&command),
        Command::Completions { shell } => {
            let mut command = Arguments::command();
            clap_complete::generate(shell, &mut command, "tyndall", &mut std::io::stdout());
            Ok(())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => error.report(),
    }
}
