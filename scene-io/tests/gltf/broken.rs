//! What is wrong with a glTF file is said in one message: the file, where in it, and the mend.

use crate::builder::{Builder, Folder};
use serde_json::{Value, json};
use tyndall_core::Rgb;
use tyndall_scene_io::SceneFile;

const PNG: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNk\
                   YAAAAAYAAjCB0C8AAAAASUVORK5CYII=";

/// A file without fault, with a bit of everything. Accessors: positions, texture coordinates and
/// indices of the square.
fn good() -> Builder {
    let mut b = Builder::new();
    b.camera();
    let extensions = json!({
        "KHR_materials_transmission": { "transmissionFactor": 0.5 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 1 },
        "KHR_materials_ior": { "ior": 1.4 },
    });
    let pbr = json!({ "baseColorTexture": { "index": 0 }, "metallicFactor": 0 });
    b.push(
        "materials",
        json!({ "pbrMetallicRoughness": pbr, "extensions": extensions }),
    );
    b.push("images", json!({ "uri": PNG }));
    b.push("textures", json!({ "source": 0 }));
    let square = b.square(Some(0));
    b.node(json!({ "mesh": square }));
    let spot = json!({ "innerConeAngle": 0.1, "outerConeAngle": 0.2 });
    b.light(
        json!({ "type": "spot", "intensity": 1, "spot": spot }),
        json!({}),
    );
    let text: Value = serde_json::from_str(&b.text()).unwrap();
    b.json["buffers"] = text["buffers"].clone();
    b
}

fn message(folder: &Folder, content: impl AsRef<[u8]>) -> String {
    let path = folder.write("bad.gltf", content);
    let file = SceneFile::load(&path, &[]);
    match file.and_then(|f| f.build::<Rgb>().map(drop)) {
        Ok(()) => String::new(),
        Err(e) => e.to_string(),
    }
}

#[test]
fn the_good_file_is_good() {
    assert_eq!(message(&Folder::new(), good().text()), "");
}

/// Where in the JSON what is put (nothing: it is taken away), and the field and the words of the
/// message.
const BAD: &[(&str, &str, &str, &str)] = &[
    (
        "/asset/version",
        "\"1.0\"",
        "asset.version",
        "export as glTF 2.0",
    ),
    (
        "/asset/minVersion",
        "\"2.1\"",
        "asset.version",
        "export as glTF 2.0",
    ),
    ("/asset", "", "glTF", "missing field `asset`"),
    (
        "/extensionsRequired",
        "[\"KHR_draco_mesh_compression\"]",
        "extensionsRequired",
        "KHR_draco_mesh_compression not supported",
    ),
    (
        "/extensionsRequired",
        "[\"KHR_materials_volume_scatter\"]",
        "extensionsRequired",
        "draft_extensions = true",
    ),
    ("/scene", "7", "scene", "does not have"),
    (
        "/scenes/0/nodes",
        "[99]",
        "scenes[0].nodes[0]",
        "does not have",
    ),
    ("/nodes", "\"x\"", "nodes", "invalid type"),
    ("/nodes/0/children", "[0]", "nodes[0]", "one parent"),
    ("/nodes/0/children", "[1]", "nodes[1]", "one parent"),
    ("/nodes/1/mesh", "9", "nodes[1].mesh", "does not have"),
    ("/nodes/1/mesh", "-1", "nodes[1].mesh", "invalid"),
    (
        "/nodes/1/rotation",
        "[0, 0, 0, 0]",
        "nodes[1].rotation",
        "other than zero",
    ),
    ("/nodes/1/scale", "[1e39, 1, 1]", "nodes[1].scale", "finite"),
    (
        "/nodes/1/matrix",
        "[1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]",
        "nodes[1].matrix",
        "last row",
    ),
    (
        "/nodes/1/extensions",
        "{\"EXT_mesh_gpu_instancing\": {}}",
        "nodes[1].extensions.EXT_mesh_gpu_instancing.attributes",
        "none of",
    ),
    (
        "/nodes/1/extensions",
        "{\"EXT_mesh_gpu_instancing\": {\"attributes\": {\"SCALE\": 77}}}",
        "attributes.SCALE",
        "no accessor",
    ),
    (
        "/meshes/0/primitives/0/attributes/POSITION",
        "99",
        "meshes[0].primitives[0].attributes.POSITION",
        "there are 3",
    ),
    (
        "/meshes/0/primitives/0/attributes",
        "{}",
        "meshes[0].primitives[0].attributes.POSITION",
        "is missing",
    ),
    (
        "/meshes/0/primitives/0/attributes/TEXCOORD_0",
        "0",
        "attributes.TEXCOORD_0",
        "other than VEC2",
    ),
    (
        "/meshes/0/primitives/0/indices",
        "77",
        "meshes[0].primitives[0].indices",
        "does not have",
    ),
    (
        "/meshes/0/primitives/0/indices",
        "1",
        "meshes[0].primitives[0].indices",
        "other than SCALAR",
    ),
    (
        "/meshes/0/primitives/0/mode",
        "9",
        "meshes[0].primitives[0].mode",
        "does not know",
    ),
    (
        "/meshes/0/primitives/0/material",
        "5",
        "meshes[0].primitives[0].material",
        "does not have",
    ),
    (
        "/accessors/0/count",
        "5",
        "meshes[0].primitives[0].attributes.POSITION (accessors[0])",
        "reaches beyond",
    ),
    (
        "/accessors/0/count",
        "0",
        "attributes.POSITION",
        "no values",
    ),
    (
        "/accessors/0/count",
        "9223372036854775807",
        "attributes.POSITION",
        "reaches beyond",
    ),
    (
        "/accessors/0/byteOffset",
        "18446744073709551615",
        "attributes.POSITION",
        "reaches beyond",
    ),
    (
        "/accessors/0/componentType",
        "5130",
        "accessors[0].componentType",
        "does not know",
    ),
    (
        "/accessors/0/type",
        "\"VEC2\"",
        "attributes.POSITION",
        "other than VEC3",
    ),
    (
        "/accessors/0/type",
        "\"MAT2\"",
        "attributes.POSITION",
        "reaches beyond",
    ),
    (
        "/accessors/0/bufferView",
        "",
        "accessors[0].bufferView",
        "is missing",
    ),
    (
        "/accessors/0/bufferView",
        "44",
        "accessors[0].bufferView",
        "does not have",
    ),
    (
        "/accessors/0/sparse",
        "{\"count\": 9, \"indices\": {\"bufferView\": 2, \"componentType\": 5123}, \"values\": {\"bufferView\": 0}}",
        "attributes.POSITION (accessors[0]).sparse",
        "at most all",
    ),
    (
        "/accessors/0/sparse",
        "{\"count\": 4, \"indices\": {\"bufferView\": 2, \"componentType\": 5123}, \"values\": {\"bufferView\": 0}}",
        "attributes.POSITION (accessors[0]).sparse",
        "do not increase",
    ),
    (
        "/accessors/1/count",
        "3",
        "attributes.TEXCOORD_0",
        "3 values for 4 vertices",
    ),
    (
        "/accessors/2/componentType",
        "5122",
        "meshes[0].primitives[0].indices",
        "5121, 5123 or 5125",
    ),
    (
        "/accessors/2/componentType",
        "5121",
        "meshes[0].primitives[0].indices",
        "",
    ),
    (
        "/accessors/2/bufferView",
        "0",
        "meshes[0].primitives[0].indices",
        "4 vertices",
    ),
    (
        "/bufferViews/0/buffer",
        "3",
        "bufferViews[0].buffer",
        "does not have",
    ),
    (
        "/bufferViews/0/byteLength",
        "99999",
        "bufferViews[0]",
        "of buffer 0",
    ),
    (
        "/bufferViews/0/byteOffset",
        "18446744073709551615",
        "bufferViews[0]",
        "of buffer 0",
    ),
    (
        "/bufferViews/0/byteStride",
        "4",
        "attributes.POSITION",
        "byteStride of 4",
    ),
    (
        "/bufferViews/0/byteStride",
        "3",
        "bufferViews[0].byteStride",
        "does not know",
    ),
    (
        "/buffers/0/byteLength",
        "999999",
        "buffers[0].byteLength",
        "cut off",
    ),
    ("/buffers/0/uri", "", "buffers[0].uri", "is missing"),
    (
        "/buffers/0/uri",
        "\"none.bin\"",
        "buffers[0].uri",
        "cannot be read",
    ),
    (
        "/buffers/0/uri",
        "\"/dev/zero\"",
        "buffers[0].uri",
        "it is no file",
    ),
    (
        "/buffers/0/uri",
        "\"https://there/x.bin\"",
        "buffers[0].uri",
        "download it",
    ),
    (
        "/buffers/0/uri",
        "\"data:;base64,@@\"",
        "buffers[0].uri",
        "no base64",
    ),
    (
        "/buffers/0/uri",
        "\"data:text/plain,abc\"",
        "buffers[0].uri",
        "not base64",
    ),
    (
        "/images/0/uri",
        "\"none.png\"",
        "images[0].uri",
        "cannot be read",
    ),
    (
        "/images/0/uri",
        "\"data:image/png;base64,AAAA\"",
        "images[0]",
        "neither a PNG nor a JPEG",
    ),
    (
        "/images/0",
        "{}",
        "images[0]",
        "neither a uri nor a bufferView",
    ),
    (
        "/textures/0/source",
        "4",
        "textures[0].source",
        "does not have",
    ),
    ("/textures/0/source", "", "textures[0].source", "is missing"),
    (
        "/materials/0/pbrMetallicRoughness/metallicFactor",
        "2",
        "materials[0].pbrMetallicRoughness.metallicFactor",
        "from 0 to 1",
    ),
    (
        "/materials/0/pbrMetallicRoughness/baseColorFactor",
        "[1, 1, -1, 1]",
        "materials[0].pbrMetallicRoughness.baseColorFactor",
        "from 0 to 1",
    ),
    (
        "/materials/0/pbrMetallicRoughness/baseColorTexture/index",
        "3",
        "materials[0].pbrMetallicRoughness.baseColorTexture.index",
        "does not have",
    ),
    (
        "/materials/0/emissiveFactor",
        "[-1, 0, 0]",
        "materials[0].emissiveFactor",
        "not negative",
    ),
    (
        "/materials/0/alphaMode",
        "\"FADE\"",
        "materials[0].alphaMode",
        "does not know",
    ),
    (
        "/materials/0/extensions/KHR_materials_ior/ior",
        "0.5",
        "KHR_materials_ior.ior",
        "from 1 to 10",
    ),
    (
        "/materials/0/extensions/KHR_materials_volume/attenuationDistance",
        "0",
        "KHR_materials_volume.attenuationDistance",
        "above 0",
    ),
    (
        "/materials/0/extensions/KHR_materials_volume/attenuationColor",
        "[2, 0, 0]",
        "KHR_materials_volume.attenuationColor",
        "from 0 to 1",
    ),
    (
        "/materials/0/extras",
        "{\"tyndall\": {\"sigma\": 1}}",
        "materials[0].extras.tyndall",
        "unknown field",
    ),
    (
        "/materials/0/extras",
        "{\"tyndall\": {\"sigma_s\": 1, \"g\": 2}}",
        "materials[0]",
        "0.999",
    ),
    (
        "/materials/0/extras",
        "{\"tyndall\": {\"sigma_s\": -1}}",
        "materials[0]",
        "at least 0",
    ),
    (
        "/materials/0/extensions/KHR_materials_transmission/transmissionTexture",
        "{\"index\": 9}",
        "materials[0].extensions.KHR_materials_transmission.transmissionTexture.index",
        "does not have",
    ),
    (
        "/cameras/0/perspective/yfov",
        "4",
        "cameras[0].perspective.yfov",
        "between 0 and π",
    ),
    (
        "/cameras/0/perspective/aspectRatio",
        "0",
        "cameras[0]",
        "width over its height",
    ),
    ("/cameras/0/perspective", "", "cameras[0]", "is missing"),
    ("/nodes/0/camera", "", "cameras", "no camera: add one"),
    (
        "/extensions/KHR_lights_punctual/lights/0/intensity",
        "-1",
        "extensions.KHR_lights_punctual.lights[0]",
        "not negative",
    ),
    (
        "/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle",
        "3",
        "extensions.KHR_lights_punctual.lights[0].spot",
        "π/2",
    ),
    (
        "/extensions/KHR_lights_punctual/lights/0/type",
        "\"area\"",
        "lights[0].type",
        "does not know",
    ),
    (
        "/nodes/2/extensions/KHR_lights_punctual/light",
        "4",
        "nodes[2].extensions.KHR_lights_punctual.light",
        "does not have",
    ),
];

/// Sets a place of a tree, or takes it away.
fn set(tree: &mut Value, pointer: &str, value: &str) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = tree
        .pointer_mut(parent)
        .unwrap_or_else(|| panic!("{pointer}"));
    match (parent, value) {
        (Value::Object(map), "") => {
            map.remove(key).unwrap_or_else(|| panic!("{pointer}"));
        }
        (Value::Object(map), _) => {
            map.insert(key.into(), serde_json::from_str(value).unwrap());
        }
        (parent, _) => {
            parent[key.parse::<usize>().unwrap()] = serde_json::from_str(value).unwrap();
        }
    }
}

#[test]
fn every_fault_is_named_with_file_place_and_mend() {
    let folder = Folder::new();
    let mut faults = Vec::new();
    for (pointer, value, field, words) in BAD {
        let mut bad = good();
        set(&mut bad.json, pointer, value);
        let message = message(&folder, bad.text());
        // Smaller indices than there were are fine, if they are in range.
        if words.is_empty() && message.is_empty() {
            continue;
        }
        let named = message.starts_with(&format!("{}/bad.gltf: `", folder.path().display()));
        let field = message
            .split('`')
            .nth(1)
            .is_some_and(|found| found.contains(field));
        if !(named && field && message.contains(words) && message.lines().count() == 1) {
            faults.push(format!("{pointer} = {value}: {message:?}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn values_that_are_no_numbers_or_out_of_range_are_named() {
    let folder = Folder::new();
    let mut b = good();
    b.json.as_object_mut().unwrap().remove("buffers");
    b.bytes[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    let why = message(&folder, b.text());
    assert!(
        why.contains("POSITION`: vertex 1 is [NaN, -0.5, 0]"),
        "{why}"
    );
    let mut b = good();
    b.json.as_object_mut().unwrap().remove("buffers");
    let indices = b.bytes.len() - 12;
    b.bytes[indices + 4] = 4;
    let why = message(&folder, b.text());
    assert!(
        why.contains("indices`: index 2 is 4, but there are 4 vertices"),
        "{why}"
    );
}

#[test]
fn files_that_are_no_gltf_are_named() {
    let folder = Folder::new();
    for text in ["", "{", "[]", "x", "{} {}", "glTF", "\u{0}"] {
        let why = message(&folder, text);
        assert!(
            why.contains("bad.gltf: `G") || why.contains("bad.gltf: `glTF`"),
            "{text:?}: {why}"
        );
    }
    let deep = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"extras\": {}",
        "[".repeat(100_000)
    );
    let why = message(&folder, deep);
    assert!(why.contains("bad.gltf: `"), "{why}");
}

/// Every beginning of a binary file but the whole is a fault, and none a panic.
#[test]
fn files_that_are_cut_off_are_named() {
    let folder = Folder::new();
    let mut b = good();
    b.json.as_object_mut().unwrap().remove("buffers");
    let whole = b.glb();
    assert_eq!(message(&folder, &whole), "");
    for length in (0..whole.len()).step_by(7) {
        let why = message(&folder, &whole[..length]);
        assert!(why.contains("bad.gltf"), "{length}: {why:?}");
    }
}

/// Bytes changed at random never make more of a file than an error.
#[test]
fn random_bytes_do_not_panic() {
    let folder = Folder::new();
    let mut b = good();
    b.json.as_object_mut().unwrap().remove("buffers");
    let whole = b.glb();
    let mut seed = 1_u64;
    let mut random = |n: usize| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    for _ in 0..3_000 {
        let mut bytes = whole.clone();
        for _ in 0..1 + random(3) {
            let digits = b"0123456789-.e[]{},\"\xff";
            let at = random(bytes.len());
            bytes[at] = digits[random(digits.len())];
        }
        message(&folder, bytes);
    }
}

/// A few bytes that claim to be much are refused before anything is made of them.
#[test]
fn claims_beyond_the_means_of_a_file_are_named() {
    let folder = Folder::new();
    let mut bomb = good();
    let sparse = json!({ "count": 1,
        "indices": { "bufferView": 2, "componentType": 5123 }, "values": { "bufferView": 0 } });
    bomb.json["accessors"][0] = json!({ "componentType": 5126, "type": "VEC3",
        "count": 1_000_000_000_000_u64, "sparse": sparse });
    let why = message(&folder, bomb.text());
    assert!(why.contains("64 times as large as the file"), "{why}");
    // A mesh of many primitives in many nodes.
    let mut bomb = good();
    let primitive = bomb.json["meshes"][0]["primitives"][0].clone();
    bomb.json["meshes"][0]["primitives"] = json!(vec![primitive; 3_000]);
    for _ in 0..30_000 {
        bomb.node(json!({ "mesh": 0 }));
    }
    let why = message(&folder, bomb.text());
    assert!(why.contains("64 times as large as the file"), "{why}");
}
