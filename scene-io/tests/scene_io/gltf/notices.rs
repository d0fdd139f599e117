//! What is read otherwise than the file says, and that it is said.

use super::builder::{Builder, Folder, meet};
use glam::Vec3;
use serde_json::{Value, json};
use tyndall_core::{Media, Medium, MediumId, Rgb, Shading};
use tyndall_scene_io::{Error, Scene, SceneFile, Summary};

/// A black image of one texel.
const PNG: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNk\
                   YAAAAAYAAjCB0C8AAAAASUVORK5CYII=";

/// A cube, which has no texture coordinates, of one material, and an image for it.
fn cube_of(material: Value) -> Builder {
    let mut b = Builder::new();
    b.camera();
    let material = b.push("materials", material);
    b.push("images", json!({ "uri": PNG }));
    b.push("textures", json!({ "source": 0 }));
    let mesh = b.cube(Some(material));
    b.node(json!({ "mesh": mesh }));
    b
}

/// The notices of a file, all in one, and its scene.
fn read(b: &Builder) -> (String, Scene<Rgb>) {
    let file = b.load().unwrap_or_else(|e| panic!("{e}"));
    (file.notices().join("\n"), file.build().unwrap())
}

/// The scattering coefficient behind the front of the cube.
fn sigma_s(scene: &Scene<Rgb>) -> Option<Rgb> {
    let (_, hit) = meet(scene, [0.1, 0.2, 5.0], [0.0, 0.0, -1.0]).unwrap();
    let id = scene.medium_across(&hit, Vec3::NEG_Z, MediumId::VACUUM);
    let medium = scene.medium(id)?;
    Some(medium.homogeneous().unwrap().sigma_s)
}

#[test]
fn media_make_bodies_of_what_transmits_and_are_missed_elsewhere() {
    let filled = |transmission: f32| {
        let transmission = json!({ "transmissionFactor": transmission });
        read(&cube_of(json!({
            "extras": { "tyndall": { "sigma_s": 2 } },
            "extensions": { "KHR_materials_transmission": transmission },
            "pbrMetallicRoughness": { "metallicFactor": 0 },
        })))
    };
    let (notices, scene) = filled(1.0);
    assert_eq!(
        (notices.as_str(), sigma_s(&scene)),
        ("", Some(Rgb::new(2.0, 2.0, 2.0)))
    );
    let (notices, scene) = filled(0.0);
    assert!(notices.contains("transmissionFactor above 0"), "{notices}");
    assert_eq!(sigma_s(&scene), None);
}

#[test]
fn textures_need_texture_coordinates() {
    let b = cube_of(json!({
        "name": "Wall", "emissiveFactor": [1, 2, 3], "emissiveTexture": { "index": 0 },
    }));
    let (notices, scene) = read(&b);
    assert!(
        notices.contains("\"Wall\" have no texture coordinates"),
        "{notices}"
    );
    let (_, hit) = meet(&scene, [0.1, 0.2, 5.0], [0.0, 0.0, -1.0]).unwrap();
    assert_eq!(scene.emitted(&hit, Vec3::Z), Rgb::new(1.0, 2.0, 3.0));
    let folder = Folder::new();
    folder.write("part.glb", b.glb());
    image::RgbImage::new(1, 1)
        .save(folder.path().join("a.png"))
        .unwrap();
    let text = "[materials.paper]
        kind = 'diffuse'
        reflectance = { file = 'a.png' }
        [[include]]
        file = 'part.glb'
        materials = { Wall = 'paper' }";
    let error = SceneFile::parse(text, &folder.path().join("scene.toml"), &[]).unwrap_err();
    assert!(matches!(error, Error::Scene { .. }), "{error:?}");
    assert!(error.to_string().contains("texture coordinates"), "{error}");
}

#[test]
fn an_index_of_zero_is_read_as_that_of_glass() {
    let b = cube_of(json!({ "extensions": { "KHR_materials_ior": { "ior": 0 } } }));
    let (notices, _) = read(&b);
    assert!(notices.contains("KHR_materials_specular"), "{notices}");
}

#[test]
fn tangents_are_missed_where_a_normal_map_asks_for_them() {
    for (material, said) in [
        (json!({ "normalTexture": { "index": 0 } }), true),
        (json!({}), false),
    ] {
        let mut b = cube_of(material);
        let square = b.square(Some(0));
        let tangents = b.floats(&[[1.0, 0.0, 0.0, 1.0]; 4]);
        b.json["meshes"][square]["primitives"][0]["attributes"]["TANGENT"] = json!(tangents);
        b.node(json!({ "mesh": square, "translation": [2, 0, 0] }));
        let (notices, _) = read(&b);
        assert_eq!(notices.contains("TANGENT"), said, "{notices}");
    }
}

/// Three textures show one image: as colour twice, and once as roughness.
#[test]
fn images_are_decoded_once_for_each_meaning() {
    let mut b = cube_of(json!({
        "emissiveTexture": { "index": 1 }, "emissiveFactor": [1, 1, 1],
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 2 },
        },
    }));
    b.push("samplers", json!({ "magFilter": 9728 }));
    b.push("textures", json!({ "source": 0, "sampler": 0 }));
    b.push("textures", json!({ "source": 0 }));
    let square = b.square(Some(0));
    b.node(json!({ "mesh": square, "translation": [2, 0, 0] }));
    let file = b.load().unwrap();
    let scene = file.build::<Rgb>().unwrap();
    assert_eq!(Summary::new(&file, &scene).texture_bytes, 2 * 4);
}
