//! `tyndall inspect` of volumes, and `tyndall volume convert`.

mod convert;
mod inspect;
mod peer;

use assert_cmd::Command;
use std::path::Path;

/// What a command that succeeds prints, and what it says.
fn run(folder: &Path, arguments: &[&str]) -> [String; 2] {
    let output = Command::cargo_bin("tyndall")
        .expect("the command is built")
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the command runs");
    let [printed, said] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("text"));
    assert!(output.status.success(), "{arguments:?}: {said}");
    [printed, said]
}
