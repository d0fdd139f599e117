//! Bad inputs to the command: each ends in one message that names the file, the field and the mend,
//! with an exit code of its kind, and leaves the folder as it was.

mod assets;
mod case;
mod command;
mod gltf;
mod images;
mod scene;
mod volumes;

use crate::support::images::{said, tyndall};
use case::Case;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// What is there before a row writes `out.exr`, if anything is.
const OLDER_IMAGE: &[u8] = b"an older image";

/// A folder with the files of a row.
fn folder(case: &Case, older_image: bool) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    if older_image {
        fs::write(folder.path().join("out.exr"), OLDER_IMAGE).expect("a writable folder");
    }
    for (name, bytes) in &case.files {
        let path = folder.path().join(name);
        match name.ends_with('/') {
            true => fs::create_dir(path),
            false => fs::write(path, bytes),
        }
        .expect("a writable folder");
    }
    folder
}

/// All entries of a folder; files with their bytes.
fn contents(folder: &Path) -> BTreeMap<String, Option<Vec<u8>>> {
    let entries = fs::read_dir(folder).expect("a folder");
    let entries = entries.map(|entry| {
        let path = entry.expect("an entry").path();
        (path.display().to_string(), fs::read(&path).ok())
    });
    entries.collect()
}

/// The first of `words` that `text` does not hold after those before it.
fn missing<'a>(text: &str, words: &'a str) -> Option<&'a str> {
    let mut rest = text;
    words
        .split(" … ")
        .find(|word| match rest.split_once(*word) {
            Some((_, after)) => {
                rest = after;
                false
            }
            None => true,
        })
}

/// What is wrong with how the command takes a bad input.
fn fault(case: &Case, older_image: bool) -> Option<String> {
    let folder = folder(case, older_image);
    let before = contents(folder.path());
    let output = tyndall(&folder, &case.arguments);
    let said = said(&output);
    let errors = said.lines().filter(|l| l.starts_with("error: ")).count();
    // A wrong command line comes with a hint to --help on lines of its own.
    let lone = case.code == 2 || said.lines().count() == 1;
    let missing = missing(&said, case.words);
    let why = if output.status.code() != Some(case.code) {
        format!("{} instead of exit code {}", output.status, case.code)
    } else if errors != 1 || !lone || !said.starts_with("error: ") {
        "not one message".into()
    } else if ["panicked", "backtrace"].iter().any(|w| said.contains(w)) {
        "a panic".into()
    } else if let Some(word) = missing {
        format!("{word:?} is missing")
    } else if !output.stdout.is_empty() {
        "something on the standard output".into()
    } else if contents(folder.path()) != before {
        "the folder is not as it was".into()
    } else {
        return None;
    };
    Some(format!("{}: {why}: {}", case.name, said.trim_end()))
}

#[test]
fn bad_inputs_end_in_one_message_and_leave_nothing() {
    let cases: Vec<_> = [
        scene::cases(),
        assets::cases(),
        gltf::cases(),
        images::cases(),
        command::cases(),
        volumes::cases(),
    ]
    .into_iter()
    .flatten()
    .collect();
    let names: BTreeSet<_> = cases.iter().map(|case| case.name).collect();
    assert_eq!(names.len(), cases.len(), "a name stands twice");
    assert!(cases.len() >= 60, "only {}", cases.len());
    let faults: Vec<_> = (cases.iter())
        .flat_map(|case| [false, true].map(|older| fault(case, older)))
        .flatten()
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The rows break one thing each: without that they would succeed.
#[test]
fn the_inputs_are_good_but_for_what_the_rows_break() {
    for case in [scene::good(), assets::good(), gltf::good(), images::good()] {
        let folder = folder(&case, true);
        let output = tyndall(&folder, &case.arguments);
        assert!(output.status.success(), "{}: {}", case.name, said(&output));
        let image = fs::read(folder.path().join("out.exr")).expect("an image");
        assert!(image != OLDER_IMAGE, "{}", case.name);
    }
    for case in volumes::good() {
        let folder = folder(&case, false);
        let output = tyndall(&folder, &case.arguments);
        assert!(output.status.success(), "{}: {}", case.name, said(&output));
    }
}
