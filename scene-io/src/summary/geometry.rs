//! Surfaces.

use crate::SceneFile;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use tyndall_core::SurfaceKind;
use tyndall_surface::{Mesh, Shape};

/// The surfaces of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GeometrySummary {
    /// How many shapes there are of each kind: `mesh`, `instance`, `sphere`, `quad`, `disk`.
    pub shapes: BTreeMap<&'static str, usize>,
    /// Triangles that rays can meet, every instance counted.
    pub triangles: u64,
    /// Triangles that are stored: those of a mesh count once, however often it is placed.
    pub unique_triangles: u64,
    /// Bytes of the meshes, without the structure that rays are traced through.
    pub mesh_bytes: u64,
    /// Shapes that reflect or refract without blur.
    pub delta_shapes: usize,
    /// Shapes that light passes straight: bounds of media.
    pub null_shapes: usize,
}

pub(super) fn summarise(file: &SceneFile) -> GeometrySummary {
    let mut summary = GeometrySummary::default();
    let mut placed = HashMap::new();
    for part in &file.parts {
        let mut store = |mesh: &Mesh| {
            summary.unique_triangles += mesh.triangles.len() as u64;
            summary.mesh_bytes += bytes(mesh);
        };
        let kind = match &part.shape {
            Shape::Mesh(mesh) => {
                store(mesh);
                "mesh"
            }
            Shape::Instance { mesh, .. } => {
                placed
                    .entry(Arc::as_ptr(mesh))
                    .or_insert_with(|| store(mesh));
                "instance"
            }
            Shape::Sphere { .. } => "sphere",
            Shape::Quad { .. } => "quad",
            Shape::Disk { .. } => "disk",
        };
        *summary.shapes.entry(kind).or_default() += 1;
        let mesh = part.shape.mesh();
        summary.triangles += mesh.map_or(0, |mesh| mesh.triangles.len() as u64);
        match kind_of(file, part.material) {
            SurfaceKind::Delta => summary.delta_shapes += 1,
            SurfaceKind::Null => summary.null_shapes += 1,
            SurfaceKind::Finite => {}
        }
    }
    summary
}

/// What the surfaces of a material are, seen from vacuum.
pub(super) fn kind_of(file: &SceneFile, material: usize) -> SurfaceKind {
    let bsdf = &file.materials[material].bsdf;
    bsdf.kind(bsdf.ior().unwrap_or(1.0))
}

fn bytes(mesh: &Mesh) -> u64 {
    let sizes = [
        size_of_val(mesh.positions.as_slice()),
        size_of_val(mesh.normals.as_slice()),
        size_of_val(mesh.uvs.as_slice()),
        size_of_val(mesh.triangles.as_slice()),
    ];
    sizes.into_iter().sum::<usize>() as u64
}

/// Bytes of the images that materials name, each once.
pub(super) fn texture_bytes(file: &SceneFile) -> u64 {
    let maps = file.materials.iter().flat_map(|m| m.maps.textures());
    let textures: HashMap<_, _> = maps.map(|t| (t.address(), t.bytes())).collect();
    textures.into_values().sum()
}
