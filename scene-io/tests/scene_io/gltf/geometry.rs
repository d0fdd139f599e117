//! Accessors and topologies: what a mesh is made of.

use super::builder::{Builder, Folder, front, meet};
use glam::Vec3;
use serde_json::json;
use tyndall_core::Rgb;
use tyndall_scene_io::SceneFile;

/// A scene of one primitive before a camera.
fn scene_of(make: impl FnOnce(&mut Builder) -> serde_json::Value) -> Builder {
    let mut b = Builder::new();
    b.camera();
    let primitive = make(&mut b);
    let mesh = b.mesh(primitive);
    b.node(json!({ "mesh": mesh }));
    b
}

/// Whether the unit square about the origin is there, looks at +z, and nothing else is.
fn assert_square(b: &Builder, what: &str) {
    let scene = b.scene();
    for (x, y) in [(-0.4, -0.3), (0.4, 0.3), (0.3, -0.45), (-0.3, 0.45)] {
        let surface = front(&scene, x, y).unwrap_or_else(|| panic!("{what}: hole at {x}, {y}"));
        assert!(
            (surface.position - Vec3::new(x, y, 0.0)).length() < 1e-5,
            "{what}: {surface:?}"
        );
        assert!(surface.geometric_normal.z > 0.999, "{what}: {surface:?}");
        assert_eq!(surface.shading_normal, surface.geometric_normal, "{what}");
    }
    for (x, y) in [(-0.6, 0.0), (0.6, 0.0), (0.0, -0.6), (0.0, 0.6)] {
        assert!(
            front(&scene, x, y).is_none(),
            "{what}: something at {x}, {y}"
        );
    }
}

const CORNERS: [[f32; 3]; 4] = [
    [-0.5, -0.5, 0.0],
    [0.5, -0.5, 0.0],
    [0.5, 0.5, 0.0],
    [-0.5, 0.5, 0.0],
];

#[test]
fn indices_of_all_sizes_and_none() {
    let indices = [0_u32, 1, 2, 0, 2, 3];
    for (component, size) in [(5121, 1), (5123, 2), (5125, 4)] {
        let b = scene_of(|b| {
            let bytes: Vec<u8> = (indices.iter())
                .flat_map(|i| i.to_le_bytes()[..size].to_vec())
                .collect();
            let view = b.view(&bytes, None);
            let indices = b.accessor(view, component, "SCALAR", 6);
            json!({ "attributes": { "POSITION": b.floats(&CORNERS) }, "indices": indices })
        });
        assert_square(&b, &format!("indices of {size} bytes"));
    }
    let b = scene_of(|b| {
        let corners = indices.map(|i| CORNERS[i as usize]);
        json!({ "attributes": { "POSITION": b.floats(&corners) } })
    });
    assert_square(&b, "no indices");
}

#[test]
fn strips_and_fans_face_as_their_first_triangle() {
    let strip = [0, 1, 3, 2].map(|i: usize| CORNERS[i]);
    for (mode, corners) in [(5, strip), (6, CORNERS)] {
        let b =
            scene_of(|b| json!({ "attributes": { "POSITION": b.floats(&corners) }, "mode": mode }));
        assert_square(&b, &format!("mode {mode}"));
    }
}

#[test]
fn points_and_lines_are_left_out_and_said() {
    let mut b =
        scene_of(|b| json!({ "attributes": { "POSITION": b.floats(&CORNERS) }, "mode": 1 }));
    let square = b.square(None);
    b.node(json!({ "mesh": square }));
    let notices = b.load().unwrap().notices().to_vec();
    assert_eq!(notices.len(), 1, "{notices:?}");
    assert!(notices[0].contains("points and lines"), "{notices:?}");
    assert_square(&b, "with lines beside it");
}

#[test]
fn interleaved_attributes_are_told_apart() {
    let b = scene_of(|b| {
        let indices = [0, 1, 2, 0, 2, 3];
        let bytes: Vec<u8> = (CORNERS.iter())
            .flat_map(|p| [p[0], p[1], p[2], 0.6, 0.0, 0.8])
            .flat_map(f32::to_le_bytes)
            .collect();
        let view = b.view(&bytes, Some(24));
        let positions = b.accessor(view, 5126, "VEC3", 4);
        let normals = b.accessor(view, 5126, "VEC3", 4);
        b.json["accessors"][normals]["byteOffset"] = json!(12);
        let attributes = json!({ "POSITION": positions, "NORMAL": normals });
        json!({ "attributes": attributes, "indices": b.indices(&indices) })
    });
    let surface = front(&b.scene(), 0.1, 0.2).unwrap();
    assert!((surface.position - Vec3::new(0.1, 0.2, 0.0)).length() < 1e-6);
    assert!((surface.shading_normal - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
    assert!(surface.geometric_normal.z > 0.999);
}

#[test]
fn sparse_accessors_replace_values() {
    let with_base = [true, false];
    for base in with_base {
        let b = scene_of(|b| {
            // Without a base all are zero, and every corner is replaced.
            let replaced: Vec<u16> = if base { vec![1, 3] } else { vec![0, 1, 2, 3] };
            let wrong = CORNERS.map(|p| [9.0, p[1], 3.0]);
            let first = [CORNERS[0], wrong[1], CORNERS[2], wrong[3]];
            let positions = b.floats(&first);
            let indices: Vec<u8> = replaced.iter().flat_map(|i| i.to_le_bytes()).collect();
            let values: Vec<u8> = (replaced.iter())
                .flat_map(|&i| CORNERS[usize::from(i)])
                .flat_map(f32::to_le_bytes)
                .collect();
            let (indices, values) = (b.view(&indices, None), b.view(&values, None));
            let accessor = &mut b.json["accessors"][positions];
            if !base {
                accessor.as_object_mut().unwrap().remove("bufferView");
            }
            accessor["sparse"] = json!({
                "count": replaced.len(),
                "indices": { "bufferView": indices, "componentType": 5123 },
                "values": { "bufferView": values },
            });
            let order = b.indices(&[0, 1, 2, 0, 2, 3]);
            json!({ "attributes": { "POSITION": positions }, "indices": order })
        });
        assert_square(&b, &format!("sparse, base {base}"));
    }
}

/// `KHR_mesh_quantization`: positions of 16 bits that the node scales, normals of 8.
#[test]
fn integers_become_fractions() {
    let mut b = Builder::new();
    b.camera();
    b.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let bytes: Vec<u8> = (CORNERS.iter())
        .flat_map(|p| [p[0], p[1], p[2], 0.0])
        .flat_map(|x| ((x * 2.0 * 32767.0) as i16).to_le_bytes())
        .collect();
    let view = b.view(&bytes, Some(8));
    let positions = b.accessor(view, 5122, "VEC3", 4);
    let normals: Vec<u8> = [76_i8, 0, 102, 0]
        .repeat(4)
        .iter()
        .map(|x| *x as u8)
        .collect();
    let view = b.view(&normals, Some(4));
    let normals = b.accessor(view, 5120, "VEC3", 4);
    for accessor in [positions, normals] {
        b.json["accessors"][accessor]["normalized"] = json!(true);
    }
    let indices = b.indices(&[0, 1, 2, 0, 2, 3]);
    let attributes = json!({ "POSITION": positions, "NORMAL": normals });
    let mesh = b.mesh(json!({ "attributes": attributes, "indices": indices }));
    b.node(json!({ "mesh": mesh, "scale": [0.5, 0.5, 0.5] }));
    let scene = b.scene();
    assert!(front(&scene, 0.499, 0.499).is_some() && front(&scene, 0.501, 0.0).is_none());
    let normal = front(&scene, 0.0, 0.1).unwrap().shading_normal;
    let expected = Vec3::new(76.0, 0.0, 102.0).normalize();
    assert!((normal - expected).length() < 1e-6, "{normal}");
}

/// The same scene as text with embedded data, as text with a file beside it, and as one file.
#[test]
fn containers_hold_the_same() {
    let b = scene_of(|b| {
        let positions = b.floats(&CORNERS);
        json!({ "attributes": { "POSITION": positions }, "indices": b.indices(&[0, 1, 2, 0, 2, 3]) })
    });
    let folder = Folder::new();
    folder.write("some data.bin", &b.bytes);
    let mut beside = Builder::new();
    beside.json = b.json.clone();
    let length = b.bytes.len();
    beside.json["buffers"] = json!([{ "byteLength": length, "uri": "some%20data.bin" }]);
    for (name, content) in [
        ("a.gltf", b.text().into_bytes()),
        ("b.gltf", beside.text().into_bytes()),
        ("c.glb", b.glb()),
        ("d.GLB", b.glb()),
    ] {
        let path = folder.write(name, content);
        let scene = SceneFile::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let scene = scene.build::<Rgb>().unwrap();
        assert!(
            meet(&scene, [0.4, 0.4, 1.0], [0.0, 0.0, -1.0]).is_some(),
            "{name}"
        );
    }
}

/// Vertices that no triangle uses do not widen a mesh, and normals that are no numbers are absent.
#[test]
fn what_exporters_get_wrong_is_survived() {
    let b = scene_of(|b| {
        let mut corners = CORNERS.to_vec();
        corners.insert(0, [1e6, 0.0, 0.0]);
        let nan = [f32::NAN, 0.0, 1.0];
        let normals = vec![nan; 5];
        let attributes = json!({ "POSITION": b.floats(&corners), "NORMAL": b.floats(&normals) });
        json!({ "attributes": attributes, "indices": b.indices(&[1, 2, 3, 1, 3, 4]) })
    });
    assert_square(&b, "with a stray vertex");
    let scene = b.scene();
    assert!(tyndall_core::Geometry::bounds(&scene).size().x < 1.1);
    let notices = b.load().unwrap().notices().to_vec();
    assert!(notices[0].contains("5 normals"), "{notices:?}");
}
