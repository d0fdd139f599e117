//! The files that a scene is made of: what a fingerprint must not miss.

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tyndall_scene_io::SceneFile;

/// The film and the camera of all scenes here.
const VIEW: &str = "film = { width = 4, height = 4 }\n\
                    camera = { position = [0, 0, 5], look_at = [0, 0, 0], fov = 40 }\n";

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

/// A glTF scene with a camera and nothing to see.
const GLTF: &str = r#"{
    "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
    "nodes": [{ "camera": 0 }],
    "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }]
}"#;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    fn image(&self, name: &str) {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        image::RgbImage::new(2, 2).save(path).unwrap();
    }

    /// The names of the sources of a scene, relative to the folder.
    fn sources(&self, scene: &str, overrides: &[(&str, &str)]) -> Vec<String> {
        let own = |&(key, value): &(&str, &str)| (key.to_owned(), value.to_owned());
        let overrides: Vec<_> = overrides.iter().map(own).collect();
        let file = SceneFile::load(&self.0.path().join(scene), &overrides).unwrap();
        let relative = |p: &Path| p.strip_prefix(self.0.path()).unwrap().display().to_string();
        file.sources().iter().map(|p| relative(p)).collect()
    }
}

#[test]
fn scene_files_are_followed_through_the_files_that_they_name() {
    let folder = Folder::new();
    folder.write(
        "scene.toml",
        format!(
            "{VIEW}include = [{{ file = 'old.gltf' }}]\n\
             [[shapes]]\nkind = 'obj'\nfile = 'meshes/m.obj'\n"
        ),
    );
    folder.write(
        "meshes/m.obj",
        format!("mtllib sub/two words.mtl\n{TRIANGLE}usemtl x\nf 1/1 2/2 3/3\n"),
    );
    // The texture is named as Windows does.
    folder.write(
        "meshes/sub/two words.mtl",
        "newmtl x\nmap_Kd -s 2 2 2 tex\\wood.png\n",
    );
    for place in ["meshes", "meshes/sub"] {
        folder.image(&format!("{place}/tex/wood.png"));
    }
    folder.write("old.gltf", "");
    folder.write("new.gltf", GLTF);
    let found = folder.sources("scene.toml", &[("include.0.file", "new.gltf")]);
    let expected = [
        "scene.toml",
        "new.gltf",
        "meshes/m.obj",
        "meshes/sub/two words.mtl",
        "meshes/sub/tex/wood.png",
    ];
    assert_eq!(found, expected);
}

#[test]
fn overrides_of_a_gltf_scene_name_files_too() {
    let folder = Folder::new();
    folder.write("scene.gltf", GLTF);
    folder.image("sky.png");
    let material = "{ kind = 'diffuse', reflectance = { file = 'sky.png' } }";
    let found = folder.sources("scene.gltf", &[("materials.a", material)]);
    assert_eq!(found, ["scene.gltf", "sky.png"]);
}

#[test]
fn binary_gltf_is_told_by_its_bytes() {
    let folder = Folder::new();
    let json = GLTF.replace(
        r#""nodes": [{ "camera": 0 }]"#,
        r#""nodes": [{ "camera": 0 }], "buffers": [{ "byteLength": 1, "uri": "a%20b.bin" }]"#,
    );
    let json = format!("{json:<width$}", width = json.len().next_multiple_of(4));
    let length = json.len() as u32;
    let mut bytes = b"glTF".to_vec();
    bytes.extend([2, length + 20, length].map(u32::to_le_bytes).concat());
    bytes.extend(b"JSON");
    bytes.extend(json.bytes());
    folder.write("scene.gltf", bytes);
    folder.write("a b.bin", [0]);
    assert_eq!(folder.sources("scene.gltf", &[]), ["scene.gltf", "a b.bin"]);
}
