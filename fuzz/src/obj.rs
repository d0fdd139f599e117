//! Wavefront OBJ, and after a zero byte the MTL file that it may name as `m.mtl`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::TempDir;
use tyndall_scene_io::SceneFile;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

const SCENE: &str = "\
camera = { kind = 'pinhole', position = [0, 0, 5], look_at = [0, 0, 0], fov = 40 }
film = { width = 4, height = 4 }
shapes = [{ kind = 'obj', file = 'o.obj' }]
";

fn seeds() -> Vec<Vec<u8>> {
    let quad = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";
    let faces = [
        "usemtl a\nf 1/1/1 2/2/1 3/3/1 4/4/1\n",
        "o x\ng y\nf -4//1 -3//1 -2//1\nusemtl b\nf 1 3 4\nl 1 2\np 1\n",
    ];
    let materials = "newmtl a\nKd 0.5 0.5 0.5\nKe 1 0 0\nNi 1.5\nd 0.5\nmap_Kd t.png\nnewmtl b\n";
    faces
        .map(|faces| format!("{quad}{faces}\0{materials}").into_bytes())
        .to_vec()
}

fuzz_target!(init: tyndall_fuzz::start("obj", &seeds()), |bytes: &[u8]| {
    let mut parts = bytes.splitn(2, |&b| b == 0);
    for name in ["o.obj", "m.mtl"] {
        let part = parts.next().unwrap_or_default();
        fs::write(FOLDER.path().join(name), part).expect("the folder is writable");
    }
    if let Ok(file) = SceneFile::parse(SCENE, &FOLDER.path().join("s.toml"), &[]) {
        let _ = file.build::<f32>();
    }
});
