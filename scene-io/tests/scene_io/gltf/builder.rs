//! Writes small glTF files.

use base64::Engine;
use glam::Vec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use tyndall_core::{Geometry, MediumId, Ray, Rgb, Surface};
use tyndall_scene_io::{Error, Hit, Scene, SceneFile};

/// A glTF file being made: its JSON and its one buffer.
pub(crate) struct Builder {
    pub(crate) json: Value,
    pub(crate) bytes: Vec<u8>,
}

impl Builder {
    /// One scene of no nodes.
    pub(crate) fn new() -> Self {
        Self {
            json: json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }] }),
            bytes: Vec::new(),
        }
    }

    /// Adds to a list at the root; its index.
    pub(crate) fn push(&mut self, list: &str, value: Value) -> usize {
        let entry = &mut self.json[list];
        if entry.is_null() {
            *entry = json!([]);
        }
        let list = entry.as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// A node of the scene.
    pub(crate) fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"]
            .as_array_mut()
            .unwrap()
            .push(json!(index));
        index
    }

    /// A view of new bytes, aligned to four.
    pub(crate) fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        self.push("bufferViews", view)
    }

    pub(crate) fn accessor(
        &mut self,
        view: usize,
        component: u32,
        kind: &str,
        count: usize,
    ) -> usize {
        let accessor = json!({
            "bufferView": view, "componentType": component, "type": kind, "count": count,
        });
        self.push("accessors", accessor)
    }

    /// An accessor of floats.
    pub(crate) fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let view = self.view(&bytes, None);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.accessor(view, 5126, kind, values.len())
    }

    /// An accessor of 16-bit indices.
    pub(crate) fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, None);
        self.accessor(view, 5123, "SCALAR", indices.len())
    }

    /// A mesh of one primitive.
    pub(crate) fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// The unit square in z = 0 from −½ to ½ that looks along +z.
    pub(crate) fn square(&mut self, material: Option<usize>) -> usize {
        let [a, b] = [-0.5, 0.5];
        let positions = self.floats(&[[a, a, 0.0], [b, a, 0.0], [b, b, 0.0], [a, b, 0.0]]);
        let uvs = self.floats(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        let indices = self.indices(&[0, 1, 2, 0, 2, 3]);
        let mut primitive = json!({
            "attributes": { "POSITION": positions, "TEXCOORD_0": uvs }, "indices": indices,
        });
        if let Some(material) = material {
            primitive["material"] = json!(material);
        }
        self.mesh(primitive)
    }

    /// The cube from −½ to ½, closed.
    pub(crate) fn cube(&mut self, material: Option<usize>) -> usize {
        let corner = |i: u32| [0, 1, 2].map(|n| (i >> n & 1) as f32 - 0.5);
        let corners: Vec<_> = (0..8).map(corner).collect();
        let positions = self.floats(&corners);
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let indices: Vec<u16> = faces
            .iter()
            .flat_map(|&[a, b, c, d]| [a, b, c, a, c, d])
            .collect();
        let indices = self.indices(&indices);
        let mut primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
        if let Some(material) = material {
            primitive["material"] = json!(material);
        }
        self.mesh(primitive)
    }

    /// A camera of 45° at (0, 0, 5) that looks along −z.
    pub(crate) fn camera(&mut self) -> usize {
        let perspective = json!({ "yfov": std::f32::consts::FRAC_PI_4, "znear": 0.1 });
        let camera = json!({ "type": "perspective", "perspective": perspective });
        let camera = self.push("cameras", camera);
        self.node(json!({ "camera": camera, "translation": [0, 0, 5] }))
    }

    /// A node with a punctual light.
    pub(crate) fn light(&mut self, light: Value, mut node: Value) {
        let extension = &mut self.json["extensions"]["KHR_lights_punctual"]["lights"];
        if extension.is_null() {
            *extension = json!([]);
        }
        let lights = extension.as_array_mut().unwrap();
        lights.push(light);
        node["extensions"] = json!({ "KHR_lights_punctual": { "light": lights.len() - 1 } });
        self.node(node);
    }

    /// The JSON with the buffer in place.
    pub(crate) fn text(&self) -> String {
        let mut json = self.json.clone();
        if !self.bytes.is_empty() && json.get("buffers").is_none() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
            let uri = format!("data:application/octet-stream;base64,{data}");
            json["buffers"] = json!([{ "byteLength": self.bytes.len(), "uri": uri }]);
        }
        json.to_string()
    }

    /// The binary form.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bytes.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut all = b"glTF\x02\0\0\0".to_vec();
        all.extend((12 + 8 + text.len() as u32 + 8 + bin.len() as u32).to_le_bytes());
        for (kind, data) in [(b"JSON", text), (b"BIN\0", bin)] {
            all.extend((data.len() as u32).to_le_bytes());
            all.extend(kind);
            all.extend(data);
        }
        all
    }

    /// The scene, loaded by itself.
    pub(crate) fn load(&self) -> Result<SceneFile, Error> {
        let folder = Folder::new();
        SceneFile::load(&folder.write("scene.gltf", self.text()), &[])
    }

    pub(crate) fn scene(&self) -> Scene<Rgb> {
        let file = self.load().unwrap_or_else(|e| panic!("{e}"));
        file.build().unwrap_or_else(|e| panic!("{e}"))
    }
}

/// Files of a test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    }
}

/// What a ray of the scene meets first.
pub(crate) fn meet(
    scene: &Scene<Rgb>,
    origin: [f32; 3],
    direction: [f32; 3],
) -> Option<(Surface, Hit)> {
    let ray = Ray::new(origin.into(), Vec3::from(direction).normalize());
    let (_, hit) = scene.intersect(&ray, MediumId::VACUUM)?;
    Some((scene.surface(&hit), hit))
}

/// What is met from (x, y, 5) of the file along −z.
pub(crate) fn front(scene: &Scene<Rgb>, x: f32, y: f32) -> Option<Surface> {
    let from = glam::DVec3::new(x.into(), y.into(), 5.0) - scene.origin();
    meet(scene, from.as_vec3().to_array(), [0.0, 0.0, -1.0]).map(|(surface, _)| surface)
}
