//! `tyndall`: renders scenes with participating media.
//!
//! Exit codes: 0 done (a render stopped by Ctrl-C that wrote its image included), 1 the scene, the
//! render or the output failed, 2 the command line was wrong, 130 a second Ctrl-C did not wait.
#![forbid(unsafe_code)]

mod arguments;
mod progress;
mod render;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments::Command::Render(arguments) = arguments::Arguments::parse().command;
    match render::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            progress::message(&format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}
