//! Scene files: any text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{fs, path::Path};
use tyndall_scene_io::SceneFile;

fn seeds() -> Vec<Vec<u8>> {
    let scenes = fs::read_dir("../scenes").expect("run this in the folder fuzz/");
    let paths = scenes.map(|entry| entry.expect("an entry").path());
    paths.filter_map(|path| fs::read(path).ok()).collect()
}

fuzz_target!(init: tyndall_fuzz::start("scene", &seeds()), |bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = SceneFile::parse(text, Path::new("scene.toml"), &[]);
    }
});
