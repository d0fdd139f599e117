//! OpenVDB files: what OpenVDB writes is read, what is written OpenVDB reads, and what is broken is an
//! error.

mod broken;
mod encoder;
mod formats;
mod peer;
mod written;

use std::path::Path;
use tyndall_scene_io::{VolumeGrid, read_volume};

/// All grids of a file, or what is wrong with it.
fn read(path: &Path) -> Result<Vec<VolumeGrid>, String> {
    read_volume(path, |_| true).map_err(|e| {
        let (message, file) = (e.to_string(), format!("{}: ", path.display()));
        let problem = message.strip_prefix(&file);
        problem.expect("the message names the file").to_owned()
    })
}

/// All grids of a file with these bytes.
fn read_bytes(bytes: &[u8]) -> Result<Vec<VolumeGrid>, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    read(file.path())
}
