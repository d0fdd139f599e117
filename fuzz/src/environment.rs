//! Images of environments: EXR and Radiance HDR.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::TempDir;
use tyndall_scene_io::SceneFile;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

const SCENE: &str = "\
camera = { kind = 'pinhole', position = [0, 0, 5], look_at = [0, 0, 0], fov = 40 }
film = { width = 4, height = 4 }
environment = { file = 'image' }
";

fn seeds() -> Vec<Vec<u8>> {
    let mut images = tyndall_fuzz::exr_images();
    let mut plain = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n".to_vec();
    plain.extend([128, 64, 32, 129].repeat(4));
    images.push(plain);
    // Runs are for widths of 8 and more: each channel of a line is a run of eight.
    let mut runs = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 8\n".to_vec();
    let line = [2, 2, 0, 8, 136, 128, 136, 64, 136, 32, 136, 129];
    runs.extend(line.repeat(2));
    images.push(runs);
    images
}

fuzz_target!(init: tyndall_fuzz::start("environment", &seeds()), |bytes: &[u8]| {
    fs::write(FOLDER.path().join("image"), bytes).expect("the folder is writable");
    if let Ok(file) = SceneFile::parse(SCENE, &FOLDER.path().join("s.toml"), &[]) {
        let _ = file.build::<tyndall_core::Rgb>();
    }
});
