//! Scenes that the repository brings.

use std::path::Path;
use tyndall_core::Rgb;
use tyndall_scene_io::SceneFile;

#[test]
fn the_demo_scenes_load_and_build() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let file = SceneFile::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
            file.build::<Rgb>().unwrap_or_else(|e| panic!("{e}"));
            count += 1;
        }
    }
    assert!(count >= 4, "found {count} scenes");
}
