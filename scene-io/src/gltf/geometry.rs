//! Primitives of meshes as triangles.

use super::accessor;
use super::document::Document;
use crate::Error;
use glam::{Vec2, Vec3};
use gltf::json::Index;
use gltf::json::accessor::Accessor;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use tyndall_surface::Mesh;

/// What a primitive is made of: primitives of equal keys have the same triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Key {
    positions: Index<Accessor>,
    normals: Option<Index<Accessor>>,
    uvs: Option<Index<Accessor>>,
    indices: Option<Index<Accessor>>,
    topology: Topology,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Topology {
    List,
    Strip,
    Fan,
}

/// The key of a primitive whose texture coordinates are set `uv_set`, if it has any; `None` if it
/// is points or lines.
pub(super) fn key(
    document: &Document,
    primitive: &Primitive,
    uv_set: u32,
    field: &str,
) -> Result<Option<Key>, Error> {
    let topology = match primitive.mode {
        Checked::Valid(Mode::Triangles) => Topology::List,
        Checked::Valid(Mode::TriangleStrip) => Topology::Strip,
        Checked::Valid(Mode::TriangleFan) => Topology::Fan,
        _ => return Ok(None),
    };
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let positions = attribute(Semantic::Positions).ok_or_else(|| {
        document.error(
            format!("{field}.attributes.POSITION"),
            "is missing: export again",
        )
    })?;
    Ok(Some(Key {
        positions,
        normals: attribute(Semantic::Normals),
        uvs: attribute(Semantic::TexCoords(uv_set)),
        indices: primitive.indices,
        topology,
    }))
}

/// Reads the triangles of a primitive, in its own coordinates, without vertices that none of them
/// uses. Normals and texture coordinates that are no numbers become zero, and are counted in
/// `faults`.
pub(super) fn read(
    document: &Document,
    key: &Key,
    uv_set: u32,
    field: &str,
    faults: &mut usize,
) -> Result<Mesh, Error> {
    let named = |name: &str| format!("{field}.attributes.{name}");
    let position = named("POSITION");
    let positions = accessor::read::<3>(document, key.positions, &position)?;
    let positions: Vec<_> = positions.into_iter().map(Vec3::from).collect();
    if let Some(bad) = positions.iter().position(|p| !p.is_finite()) {
        let why = format!(
            "vertex {bad} is {}: mend the mesh and export again",
            positions[bad]
        );
        return Err(document.error(position, why));
    }
    let mut number = |finite: bool| {
        *faults += usize::from(!finite);
        finite
    };
    let mut normals = Vec::new();
    if let Some(index) = key.normals {
        let name = named("NORMAL");
        same_count(document, index, positions.len(), &name)?;
        let values = accessor::read::<3>(document, index, &name)?;
        let finite = |n: Vec3| if number(n.is_finite()) { n } else { Vec3::ZERO };
        normals = values.into_iter().map(Vec3::from).map(finite).collect();
    }
    let mut uvs = Vec::new();
    if let Some(index) = key.uvs {
        let name = named(&format!("TEXCOORD_{uv_set}"));
        same_count(document, index, positions.len(), &name)?;
        let values = accessor::read::<2>(document, index, &name)?;
        let finite = |uv: Vec2| {
            if number(uv.is_finite()) {
                uv
            } else {
                Vec2::ZERO
            }
        };
        uvs = values.into_iter().map(Vec2::from).map(finite).collect();
    }
    let triangles = triangles(document, key, positions.len(), field)?;
    Ok(compact(Mesh {
        positions,
        normals,
        uvs,
        triangles,
    }))
}

fn same_count(
    document: &Document,
    index: Index<Accessor>,
    vertices: usize,
    field: &str,
) -> Result<(), Error> {
    let count = accessor::count(document, index);
    if count == vertices as u64 {
        return Ok(());
    }
    let why = format!("has {count} values for {vertices} vertices: export again");
    Err(document.error(field, why))
}

fn triangles(
    document: &Document,
    key: &Key,
    vertices: usize,
    field: &str,
) -> Result<Vec<[u32; 3]>, Error> {
    let field = format!("{field}.indices");
    let corners = match key.indices {
        Some(index) => accessor::read_indices(document, index, &field)?,
        None => (0..vertices as u32).collect(),
    };
    if let Some(at) = corners.iter().position(|&i| i as usize >= vertices) {
        let bad = corners[at];
        let why = format!("index {at} is {bad}, but there are {vertices} vertices: export again");
        return Err(document.error(field, why));
    }
    Ok(match key.topology {
        Topology::List => corners.as_chunks().0.to_vec(),
        // Every second triangle of a strip runs the other way round (glTF 2.0, §3.7.2.1).
        Topology::Strip => (corners.windows(3).enumerate())
            .map(|(i, w)| [w[0], w[1 + i % 2], w[2 - i % 2]])
            .collect(),
        Topology::Fan => {
            let rim = corners.get(1..).unwrap_or_default();
            rim.windows(2).map(|w| [w[0], w[1], corners[0]]).collect()
        }
    })
}

/// Leaves out vertices that no triangle uses: exporters put many meshes into one list.
fn compact(mesh: Mesh) -> Mesh {
    const UNUSED: u32 = u32::MAX;
    let mut renamed = vec![UNUSED; mesh.positions.len()];
    let mut used = Vec::new();
    let triangles = mesh.triangles.iter().map(|corners| {
        corners.map(|i| {
            let name = &mut renamed[i as usize];
            if *name == UNUSED {
                *name = used.len() as u32;
                used.push(i as usize);
            }
            *name
        })
    });
    let triangles = triangles.collect();
    if used.len() == mesh.positions.len() {
        return mesh;
    }
    Mesh {
        positions: pick(&mesh.positions, &used),
        normals: pick(&mesh.normals, &used),
        uvs: pick(&mesh.uvs, &used),
        triangles,
    }
}

fn pick<T: Copy>(all: &[T], used: &[usize]) -> Vec<T> {
    if all.is_empty() {
        return Vec::new();
    }
    used.iter().map(|&i| all[i]).collect()
}
