//! EXR images, as `tyndall diff` and `tyndall merge` read them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::TempDir;
use tyndall_scene_io::read_exr;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

fuzz_target!(init: tyndall_fuzz::start("exr", &tyndall_fuzz::exr_images()), |bytes: &[u8]| {
    let path = FOLDER.path().join("image.exr");
    fs::write(&path, bytes).expect("the folder is writable");
    let _ = read_exr(&path);
});
