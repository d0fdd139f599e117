//! The graph of nodes, and meshes that stand in several places.

use super::builder::{Builder, front, meet};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use serde_json::{Value, json};
use tyndall_core::Rgb;
use tyndall_scene_io::Scene;

/// Transformations with rotation, shear by a parent, reflection and scale.
fn places() -> Vec<Value> {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 0.5).to_array();
    vec![
        json!({ "translation": [-2, 0, 0], "rotation": turn, "scale": [1.0, 0.5, 1.5] }),
        json!({ "translation": [0, 1, 0], "rotation": turn, "scale": [-1.0, 1.0, 1.0] }),
        json!({ "translation": [2, 0, -1], "scale": [1.0, 2.0, -0.7] }),
    ]
}

/// The cube in all places below a node of its own that stretches: as one mesh, or as one each.
fn cubes(shared: bool) -> Builder {
    let mut b = Builder::new();
    b.camera();
    let one = b.cube(None);
    let mut children = Vec::new();
    for mut place in places() {
        place["mesh"] = json!(if shared { one } else { b.cube(None) });
        children.push(b.push("nodes", place));
    }
    b.node(json!({ "children": children, "scale": [1.0, 1.2, 1.0] }));
    b
}

fn grid(scene: &Scene<Rgb>, mut see: impl FnMut(f32, f32, Option<(Vec3, Vec3)>)) {
    for i in 0..80 {
        for j in 0..50 {
            let (x, y) = (-3.2 + 0.081 * i as f32, -2.0 + 0.083 * j as f32);
            let hit = meet(scene, [x, y, 5.0], [0.02, -0.03, -1.0]);
            see(x, y, hit.map(|(s, _)| (s.position, s.geometric_normal)));
        }
    }
}

#[test]
fn instances_equal_copies() {
    let (shared, copies) = (cubes(true).scene(), cubes(false).scene());
    let mut expected = Vec::new();
    grid(&copies, |_, _, hit| expected.push(hit));
    let met = expected.iter().flatten().count();
    assert!(met > 500, "{met}");
    let (mut expected, mut edges) = (expected.into_iter(), 0);
    grid(&shared, |x, y, hit| match (hit, expected.next().unwrap()) {
        (Some((p, n)), Some((q, m))) => {
            assert!((p - q).length() < 1e-5, "{x}, {y}: {p} {q}");
            edges += usize::from((n - m).length() > 1e-4);
        }
        (None, None) => {}
        // Rays that graze an edge.
        _ => edges += 1,
    });
    assert!(edges < 5, "{edges}");
}

/// Of closed meshes, what is met from outside faces outwards, reflected or not.
#[test]
fn reflections_keep_the_outside_outside() {
    for shared in [true, false] {
        let mut seen = 0;
        grid(&cubes(shared).scene(), |x, y, hit| {
            if let Some((_, normal)) = hit {
                let along = normal.dot(Vec3::new(0.02, -0.03, -1.0));
                assert!(along < 0.0, "shared {shared}: {x}, {y}: {normal}");
                seen += 1;
            }
        });
        assert!(seen > 500);
    }
}

#[test]
fn matrices_equal_translation_rotation_and_scale() {
    let mut b = Builder::new();
    b.camera();
    let turn = DQuat::from_rotation_z(0.4);
    let (scale, shift) = (DVec3::new(2.0, 1.0, 1.0), DVec3::new(-1.0, 0.2, 0.0));
    let matrix = DAffine3::from_scale_rotation_translation(scale, turn, shift);
    let [left, right] = [0, 1].map(|_| b.square(None));
    let columns = glam::DMat4::from(matrix).to_cols_array();
    b.node(json!({ "mesh": left, "matrix": columns }));
    let shift = [1.0, 0.2, 0.0];
    b.node(json!({ "mesh": right, "translation": shift, "rotation": turn.to_array(), "scale": scale.to_array() }));
    let scene = b.scene();
    for i in 0..40 {
        let (x, y) = (-0.95 + 0.05 * i as f32, 0.3);
        let there = |shift: f32| front(&scene, x * 0.9 + shift, y).is_some();
        if x.abs() < 0.9 {
            assert_eq!(there(-1.0), there(1.0), "{x}");
        }
    }
}

/// A chain of a hundred thousand nodes is no deeper than one.
#[test]
fn long_chains_of_nodes_load() {
    let mut b = Builder::new();
    b.camera();
    let square = b.square(None);
    let mut below = b.push("nodes", json!({ "mesh": square }));
    for _ in 0..100_000 {
        below = b.push("nodes", json!({ "children": [below] }));
    }
    b.json["scenes"][0]["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!(below));
    assert!(front(&b.scene(), 0.1, 0.1).is_some());
}

#[test]
fn instances_by_attributes_stand_where_they_say() {
    let mut b = Builder::new();
    b.camera();
    b.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let square = b.square(None);
    let translations = b.floats(&[[-2.0, 0.0, 0.0], [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    let scales = b.floats(&[[1.0; 3], [0.5; 3], [2.0; 3]]);
    let attributes = json!({ "TRANSLATION": translations, "SCALE": scales });
    b.node(json!({
        "mesh": square, "translation": [0, 1, 0],
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } },
    }));
    let scene = b.scene();
    for (x, half) in [(-2.0, 0.5), (0.0, 0.25), (2.0, 1.0)] {
        assert!(front(&scene, x + 0.95 * half, 1.05).is_some(), "{x}");
        assert!(front(&scene, x + 1.05 * half, 1.05).is_none(), "{x}");
    }
    assert!(b.load().unwrap().notices().is_empty());
}

/// A scale of zero is no reason to fail: a plane without thickness is still a plane.
#[test]
fn flattened_meshes_are_flat() {
    for copies in [1, 2] {
        let mut b = Builder::new();
        b.camera();
        let cube = b.cube(None);
        for i in 0..copies {
            b.node(json!({ "mesh": cube, "scale": [1, 1, 0], "translation": [0, 0, -i] }));
        }
        let z = front(&b.scene(), 0.3, 0.2).unwrap().position.z;
        assert_eq!(z, 0.0, "{copies}");
    }
}

/// Ten thousand balls of glass in fog: today's limit was three thousand.
#[test]
fn ten_thousand_instances_of_glass_load() {
    let mut b = Builder::new();
    b.camera();
    let glass = b.push(
        "materials",
        json!({
            "pbrMetallicRoughness": { "roughnessFactor": 0, "metallicFactor": 0 },
            "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 1 },
                "KHR_materials_volume": { "thicknessFactor": 1 },
            },
        }),
    );
    let fog = b.push(
        "materials",
        json!({ "extras": { "tyndall": { "surface": "none", "sigma_s": 0.1 } } }),
    );
    let (cube, room) = (b.cube(Some(glass)), b.cube(Some(fog)));
    b.node(json!({ "mesh": room, "scale": [400, 400, 400] }));
    for i in 0..10_000 {
        let at = [2 * (i % 100), 2 * (i / 100 % 10), -2 * (i / 1000)];
        b.node(json!({ "mesh": cube, "translation": at }));
    }
    let scene = b.scene();
    let (surface, _) = meet(&scene, [2.1, 2.2, 5.0], [0.0, 0.0, -1.0]).unwrap();
    assert_eq!(surface.position.z, 0.5);
}

/// A scene far from the origin is moved there, its instances too.
#[test]
fn far_instances_are_recentred() {
    let mut b = Builder::new();
    b.camera();
    b.json["nodes"][0]["translation"] = json!([1e6, 0, 5]);
    let square = b.square(None);
    for x in [1e6, 1e6 + 2.0] {
        b.node(json!({ "mesh": square, "translation": [x, 0.0, 0.0] }));
    }
    let scene = b.scene();
    assert!((scene.origin().x - (1e6 + 1.0)).abs() < 1e-6);
    let there = |x: f32| meet(&scene, [x, 0.0, 5.0], [0.0, 0.0, -1.0]).is_some();
    assert!(there(-1.49) && !there(-1.51) && there(1.49) && !there(0.49));
}

#[test]
fn the_scene_is_the_default_one_or_the_first() {
    let mut b = Builder::new();
    b.camera();
    let square = b.square(None);
    let aside = b.push("nodes", json!({ "mesh": square, "translation": [2, 0, 0] }));
    b.node(json!({ "mesh": square }));
    b.push("scenes", json!({ "name": "other", "nodes": [0, aside] }));
    let at = |b: &Builder, x| front(&b.scene(), x, 0.1).is_some();
    assert!(at(&b, 0.0) && !at(&b, 2.0));
    b.json["scene"] = json!(1);
    assert!(!at(&b, 0.0) && at(&b, 2.0));
    b.json.as_object_mut().unwrap().remove("scene");
    assert!(at(&b, 0.0) && !at(&b, 2.0));
    b.json.as_object_mut().unwrap().remove("scenes");
    assert!(at(&b, 0.0) && at(&b, 2.0));
}
