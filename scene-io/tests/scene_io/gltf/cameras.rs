//! Cameras look as those of scene files do that say the same.

use super::builder::{Builder, Folder};
use glam::DQuat;
use serde_json::{Value, json};
use std::path::Path;
use tyndall_core::{Rgb, Sensor};
use tyndall_scene_io::{Scene, SceneFile};

fn rays(scene: &Scene<Rgb>) -> Vec<[f32; 6]> {
    let [width, height] = scene.resolution();
    let mut rays = Vec::new();
    for px in [
        [0, 0],
        [width - 1, 0],
        [width / 2, height / 3],
        [7, height - 1],
    ] {
        let ray = scene.sensor_ray(px, [0.3, 0.8, 0.1, 0.6]).ray;
        let [x, y, z] = ray.origin.to_array();
        let [dx, dy, dz] = ray.direction.to_array();
        rays.push([x, y, z, dx, dy, dz]);
    }
    rays
}

fn assert_same(a: &Scene<Rgb>, b: &Scene<Rgb>) {
    assert_eq!(a.resolution(), b.resolution());
    for (a, b) in rays(a).iter().zip(rays(b)) {
        let apart = a
            .iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(apart < 2e-6, "{a:?} {b:?}");
    }
}

/// A camera at (1, 2, 3), turned by 30° about y and then tilted down by 20°, in a node that is moved
/// and stretched.
fn turned(camera: Value) -> Builder {
    let mut b = Builder::new();
    let turn = DQuat::from_rotation_y(30_f64.to_radians());
    let turn = turn * DQuat::from_rotation_x(-20_f64.to_radians());
    let camera = b.push("cameras", camera);
    let node = json!({ "camera": camera, "name": "eye", "rotation": turn.to_array() });
    let child = b.push("nodes", node);
    b.node(json!({ "children": [child], "translation": [1, 2, 3] }));
    let square = b.square(None);
    b.node(json!({ "mesh": square }));
    b
}

fn toml(rest: &str) -> Scene<Rgb> {
    let text = format!("[camera]\nposition = [1, 2, 3]\n{rest}");
    let file = SceneFile::parse(&text, Path::new("x.toml"), &[]);
    file.and_then(|f| f.build())
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Where `turned` looks: (0, 0, −1) tilted, then turned.
fn look_at() -> String {
    let (tilt, turn) = (20_f64.to_radians(), 30_f64.to_radians());
    let x = 1.0 - tilt.cos() * turn.sin();
    let (y, z) = (2.0 - tilt.sin(), 3.0 - tilt.cos() * turn.cos());
    format!("look_at = [{x}, {y}, {z}]")
}

#[test]
fn perspective_cameras_see_what_those_of_scene_files_do() {
    let perspective = json!({ "yfov": 0.7, "aspectRatio": 1.6, "znear": 0.1 });
    let b = turned(json!({ "type": "perspective", "perspective": perspective }));
    let width = 2.0 * (0.35_f64.tan() * 1.6).atan();
    let film = "[film]\nwidth = 640\nheight = 400";
    let same = toml(&format!(
        "{}\nfov = {}\n{film}",
        look_at(),
        width.to_degrees()
    ));
    assert_same(&b.scene(), &same);
}

#[test]
fn orthographic_cameras_too() {
    let orthographic = json!({ "xmag": 2.0, "ymag": 1.0, "zfar": 9.0, "znear": 0.1 });
    let b = turned(json!({ "type": "orthographic", "orthographic": orthographic }));
    let film = "[film]\nwidth = 640\nheight = 320";
    let kind = "kind = 'orthographic'\nheight = 2";
    assert_same(&b.scene(), &toml(&format!("{}\n{kind}\n{film}", look_at())));
}

#[test]
fn films_take_the_shape_of_the_picture_unless_they_have_one() {
    let folder = Folder::new();
    let perspective = json!({ "yfov": 0.7, "aspectRatio": 2.0, "znear": 0.1 });
    let b = turned(json!({ "type": "perspective", "perspective": perspective }));
    let path = folder.write("scene.glb", b.glb());
    let resolution = |overrides: &[(&str, &str)]| {
        let overrides: Vec<_> = overrides
            .iter()
            .map(|(k, v)| (k.to_string(), v.to_string()))
            .collect();
        let file = SceneFile::load(&path, &overrides).unwrap_or_else(|e| panic!("{e}"));
        let scene = file.build::<Rgb>().unwrap();
        // The vertical angle stays whatever the picture's shape.
        let ray = scene.sensor_ray([0, 0], [0.0; 4]).ray;
        let center = scene.resolution().map(|n| n / 2);
        let top = scene.sensor_ray([center[0], 0], [0.0; 4]).ray.direction;
        let middle = scene.sensor_ray(center, [0.0; 4]).ray.direction;
        assert!((top.dot(middle).acos() - 0.35).abs() < 1e-3, "{ray:?}");
        scene.resolution()
    };
    assert_eq!(resolution(&[]), [640, 320]);
    assert_eq!(resolution(&[("film.width", "100")]), [100, 50]);
    assert_eq!(resolution(&[("film.height", "100")]), [200, 100]);
    assert_eq!(
        resolution(&[("film.width", "64"), ("film.height", "64")]),
        [64, 64]
    );
}

#[test]
fn cameras_are_chosen_by_name_and_replaced_by_overrides() {
    let folder = Folder::new();
    let mut b = Builder::new();
    b.camera();
    let other = json!({ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } });
    let other = b.push("cameras", other);
    b.json["cameras"][other]["name"] = json!("second");
    b.node(json!({ "camera": other, "name": "node", "translation": [7, 0, 0] }));
    let path = folder.write("scene.gltf", b.text());
    let at = |key: &str, value: &str| {
        let file = SceneFile::load(&path, &[(key.into(), value.into())]);
        let scene = file
            .unwrap_or_else(|e| panic!("{e}"))
            .build::<Rgb>()
            .unwrap();
        scene.sensor_ray([0, 0], [0.5; 4]).ray.origin.to_array()
    };
    assert_eq!(at("film.width", "8"), [0.0, 0.0, 5.0]);
    assert_eq!(at("include.0.camera", "second"), [7.0, 0.0, 0.0]);
    assert_eq!(at("include.0.camera", "node"), [7.0, 0.0, 0.0]);
    let why = SceneFile::load(&path, &[("include.0.camera".into(), "third".into())]);
    let why = why.unwrap_err().to_string();
    assert!(
        why.contains("`cameras`: has no camera \"third\"") && why.contains("node"),
        "{why}"
    );
}
