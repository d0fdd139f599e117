//! glTF files, by themselves and included.

use super::case::{Case, replaced};
use super::scene::broken;

/// A triangle that glows, and a camera.
const GOOD: &str = r#"{
"asset": { "version": "2.0" },
"scene": 0,
"scenes": [{ "nodes": [0, 1] }],
"nodes": [{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 5] }],
"cameras": [{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }],
"meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
"materials": [{ "emissiveFactor": [1, 1, 1] }],
"accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
"bufferViews": [{ "buffer": 0, "byteLength": 36 }],
"buffers": [{ "byteLength": 36, "uri": "mesh.bin" }]
}"#;

const RENDER: &str = "render mesh.gltf -o out.exr --passes 1 --set film.width=4";
const RENDER_GLB: &str = "render mesh.glb -o out.exr --passes 1 --set film.width=4";

/// The corners of the triangle.
fn bin() -> Vec<u8> {
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    corners.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// The binary form.
fn glb() -> Vec<u8> {
    let mut json = replaced(GOOD, ", \"uri\": \"mesh.bin\"", "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut chunks = Vec::new();
    for (kind, data) in [(b"JSON", json), (b"BIN\0", bin())] {
        chunks.extend((data.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(data);
    }
    let mut all = b"glTF\x02\0\0\0".to_vec();
    all.extend((12 + chunks.len() as u32).to_le_bytes());
    all.extend(chunks);
    all
}

pub(crate) fn good() -> Case {
    Case::new("the glTF file", RENDER_GLB, 0, "").file("mesh.glb", glb())
}

pub(crate) fn cases() -> Vec<Case> {
    [documents(), files(), includes()]
        .into_iter()
        .flatten()
        .collect()
}

/// Faults of the JSON.
fn documents() -> Vec<Case> {
    let case = |name, old, new, words| {
        let case = Case::new(name, RENDER, 3, words);
        case.file("mesh.gltf", replaced(GOOD, old, new))
            .file("mesh.bin", bin())
    };
    vec![
        case(
            "glTF 1.0",
            "\"2.0\"",
            "\"1.0\"",
            "mesh.gltf … `asset.version` … export as glTF 2.0",
        ),
        case(
            "a required extension that is unknown",
            "\"scene\": 0,",
            "\"scene\": 0, \"extensionsRequired\": [\"KHR_draco_mesh_compression\"],",
            "mesh.gltf … `extensionsRequired` … KHR_draco_mesh_compression … export without",
        ),
        case(
            "an extension of two lines",
            "\"scene\": 0,",
            "\"scene\": 0, \"extensionsRequired\": [\"a\\nerror: b\"],",
            "mesh.gltf … `extensionsRequired` … a; error: b … export without",
        ),
        case(
            "a buffer on the web",
            "mesh.bin",
            "https://example.com/mesh.bin",
            "mesh.gltf … `buffers[0].uri` … download it",
        ),
        case(
            "a buffer of no base64",
            "mesh.bin",
            "data:;base64,@",
            "mesh.gltf … `buffers[0].uri` … no base64 … export again",
        ),
        case(
            "no camera",
            "\"camera\": 0, ",
            "",
            "mesh.gltf … `cameras` … add one",
        ),
        case(
            "nodes in a circle",
            "{ \"mesh\": 0 }",
            "{ \"mesh\": 0, \"children\": [0] }",
            "mesh.gltf … `nodes[0] … one parent",
        ),
        case(
            "a mesh that is not there",
            "{ \"mesh\": 0 }",
            "{ \"mesh\": 7 }",
            "mesh.gltf … `nodes[0].mesh` … does not have",
        ),
        case(
            "an accessor that is not there",
            "\"POSITION\": 0",
            "\"POSITION\": 7",
            "mesh.gltf … `meshes[0].primitives[0].attributes.POSITION` … there are 1",
        ),
        case(
            "an accessor beyond its view",
            "\"count\": 3",
            "\"count\": 4",
            "mesh.gltf … (accessors[0])` … export again",
        ),
        case(
            "an accessor that claims too much",
            "\"count\": 3",
            "\"count\": 4000000000",
            "mesh.gltf … (accessors[0])` … export again",
        ),
        case(
            "a view beyond its buffer",
            "\"byteLength\": 36 }],\n\"buffers\"",
            "\"byteLength\": 99 }],\n\"buffers\"",
            "mesh.gltf … `bufferViews[0]` … export again",
        ),
        case(
            "a factor above 1",
            "\"emissiveFactor\": [1, 1, 1]",
            "\"pbrMetallicRoughness\": { \"metallicFactor\": 2 }",
            "mesh.gltf … `materials[0].pbrMetallicRoughness.metallicFactor` … from 0 to 1",
        ),
        case(
            "a word as number",
            "\"yfov\": 0.8",
            "\"yfov\": \"wide\"",
            "mesh.gltf … `cameras[0].perspective.yfov` … expected",
        ),
        case(
            "a flat angle of view",
            "\"yfov\": 0.8",
            "\"yfov\": 3.2",
            "mesh.gltf … `cameras[0].perspective.yfov` … between 0 and π",
        ),
    ]
}

/// Faults of the bytes.
fn files() -> Vec<Case> {
    let case = |name, words| Case::new(name, RENDER, 3, words);
    let mut nan = bin();
    nan[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let glb = glb();
    let case_glb =
        |name, bytes: &[u8], words| Case::new(name, RENDER_GLB, 3, words).file("mesh.glb", bytes);
    vec![
        case("no glTF", "mesh.gltf … cannot be read … check the name"),
        case("a text as glTF", "mesh.gltf … `glTF` … line 1 … export")
            .file("mesh.gltf", "solid cube"),
        case("half a glTF", "mesh.gltf … `glTF` … EOF … export").file("mesh.gltf", &GOOD[..50]),
        case(
            "no buffer",
            "mesh.gltf … `buffers[0].uri` … mesh.bin … put it there",
        )
        .file("mesh.gltf", GOOD),
        case(
            "half a buffer",
            "mesh.gltf … `buffers[0].byteLength` … copy it again",
        )
        .file("mesh.gltf", GOOD)
        .file("mesh.bin", &bin()[..20]),
        case(
            "a vertex that is no number",
            "mesh.gltf … `meshes[0].primitives[0].attributes.POSITION` … mend the mesh",
        )
        .file("mesh.gltf", GOOD)
        .file("mesh.bin", nan),
        case_glb(
            "half a GLB",
            &glb[..glb.len() / 2],
            "mesh.glb … `GLB` … copy or export it again",
        ),
        case_glb(
            "the head of a GLB",
            &glb[..10],
            "mesh.glb … `GLB` … copy or export it again",
        ),
        case_glb("an empty GLB", b"", "mesh.glb … `glTF` … export"),
    ]
}

/// `[[include]]`.
fn includes() -> Vec<Case> {
    let case = |name, include: &str, words| {
        broken(
            name,
            "[environment]",
            &format!("[[include]]\n{include}\n[environment]"),
            words,
        )
    };
    vec![
        case(
            "no include",
            "file = 'mesh.gltf'",
            "scene.toml:48:8 … `include.0.file` … mesh.gltf … check the name",
        ),
        case(
            "a scene that includes itself",
            "file = 'scene.toml'",
            "scene.toml:48:8 … `include.0.file` … name a .gltf or .glb file",
        ),
        case(
            "a broken include",
            "file = 'mesh.gltf'",
            "scene.toml:48:8 … `include.0.file` … mesh.gltf … `glTF` … export",
        )
        .file("mesh.gltf", "{"),
        case(
            "an include without such a camera",
            "file = 'mesh.gltf'\ncamera = 'Door'",
            "scene.toml:48:8 … `include.0.file` … mesh.gltf … \"Door\"",
        )
        .file("mesh.gltf", GOOD)
        .file("mesh.bin", bin()),
        case(
            "an include scaled to nothing",
            "file = 'mesh.gltf'\ntransform = { scale = 0 }",
            "scene.toml:49:13 … `include.0.transform` … above 0",
        )
        .file("mesh.gltf", GOOD)
        .file("mesh.bin", bin()),
    ]
}
