//! `tyndall`: renders scenes with participating media.
//!
//! Exit codes: 0 done (a render stopped by Ctrl-C that wrote its image included), 1 the scene, the
//! render or the output failed, 2 the command line was wrong, 130 a second Ctrl-C did not wait.
#![forbid(unsafe_code)]

mod arguments;
mod diff;
mod merge;
mod progress;
mod render;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Render(arguments) => render::run(&arguments).map_err(|e| e.to_string()),
        Command::Diff(arguments) => diff::run(&arguments).map_err(|e| e.to_string()),
        Command::Merge(arguments) => merge::run(&arguments).map_err(|e| e.to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            progress::message(&format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}
