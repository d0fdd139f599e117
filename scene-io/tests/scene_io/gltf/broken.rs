//! What is wrong with a glTF file is said in one message: the file, where in it, and the mend.

use super::builder::{Builder, Folder};
use super::faults::FAULTS;
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
    for (pointer, value, field, words) in FAULTS {
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
