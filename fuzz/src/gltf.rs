//! glTF: GLB by its first bytes, or else JSON with its buffers and images in data URIs.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::TempDir;
use tyndall_scene_io::SceneFile;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

/// A triangle: positions, then indices.
const BUFFER: [u8; 42] = {
    let one = 1.0_f32.to_le_bytes();
    let mut buffer = [0; 42];
    let mut i = 0;
    while i < 4 {
        buffer[12 + i] = one[i];
        buffer[28 + i] = one[i];
        i += 1;
    }
    buffer[38] = 1;
    buffer[40] = 2;
    buffer
};

/// With everything that a scene can hold; `buffer` is what stands in the buffer's object.
fn json(buffer: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,2,3]}}],
"nodes":[{{"mesh":0,"scale":[1,2,1],"children":[1]}},{{"mesh":0,"translation":[0,0,1]}},{{"camera":0,"translation":[0,0,5]}},{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.7,"znear":0.1}}}}],
"extensionsUsed":["KHR_lights_punctual","KHR_materials_ior","KHR_materials_transmission","KHR_materials_volume"],
"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","intensity":9,"spot":{{"outerConeAngle":0.5}}}}]}}}},
"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[1,0.5,0.2,1],"roughnessFactor":0.3}},"emissiveFactor":[0.1,0,0],"alphaMode":"MASK",
"extensions":{{"KHR_materials_ior":{{"ior":1.4}},"KHR_materials_transmission":{{"transmissionFactor":1}},"KHR_materials_volume":{{"thicknessFactor":1,"attenuationDistance":2,"attenuationColor":[1,0.5,0.5]}}}}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},{{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
"buffers":[{{{buffer}"byteLength":42}}]}}"#
    )
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = bytes.chunks_exact(3).flat_map(|b| {
        let word = u32::from_be_bytes([0, b[0], b[1], b[2]]);
        [18, 12, 6, 0].map(|shift| DIGITS[(word >> shift & 63) as usize])
    });
    digits.map(char::from).collect()
}

/// A chunk of a GLB, padded to four bytes.
fn chunk(kind: &[u8; 4], bytes: &[u8], padding: u8) -> Vec<u8> {
    let length = bytes.len().next_multiple_of(4);
    let mut chunk = (length as u32).to_le_bytes().to_vec();
    chunk.extend(kind);
    chunk.extend(bytes);
    chunk.resize(8 + length, padding);
    chunk
}

fn seeds() -> Vec<Vec<u8>> {
    let uri = format!(
        r#""uri":"data:application/octet-stream;base64,{}","#,
        base64(&BUFFER)
    );
    let chunks = [
        chunk(b"JSON", json("").as_bytes(), b' '),
        chunk(b"BIN\0", &BUFFER, 0),
    ]
    .concat();
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + chunks.len() as u32).to_le_bytes());
    glb.extend(chunks);
    vec![json(&uri).into_bytes(), glb]
}

fuzz_target!(init: tyndall_fuzz::start("gltf", &seeds()), |bytes: &[u8]| {
    let name = if bytes.starts_with(b"glTF") { "s.glb" } else { "s.gltf" };
    let path = FOLDER.path().join(name);
    fs::write(&path, bytes).expect("the folder is writable");
    if let Ok(file) = SceneFile::load(&path, &[]) {
        let _ = file.build::<tyndall_core::Rgb>();
    }
});
