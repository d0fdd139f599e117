//! Primitives of meshes as triangles.

use super::accessor;
use super::document::Document;
use crate::Error;
use crate::material::FLIP;
use glam::Vec3;
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

/// Reads primitives. Vertices are kept until others are asked for: the primitives of a mesh often
/// share theirs.
pub(super) struct Reader<'a> {
    document: &'a Document,
    last: Option<([Option<Index<Accessor>>; 3], Mesh)>,
    /// Normals and texture coordinates that are no numbers; they become zero.
    pub(super) faults: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn of(document: &'a Document) -> Self {
        Self {
            document,
            last: None,
            faults: 0,
        }
    }

    /// The triangles of a primitive, in its own coordinates, without vertices that none of them
    /// uses; `uv_set` is that of its texture coordinates.
    pub(super) fn read(&mut self, key: &Key, uv_set: u32, field: &str) -> Result<Mesh, Error> {
        let vertices = [Some(key.positions), key.normals, key.uvs];
        if self.last.as_ref().is_none_or(|(last, _)| *last != vertices) {
            let mesh = self.vertices(key, uv_set, field)?;
            self.last = Some((vertices, mesh));
        }
        let Some((_, vertices)) = &self.last else {
            return Ok(Mesh::default());
        };
        let triangles = triangles(self.document, key, vertices.positions.len(), field)?;
        let mesh = compact(vertices, triangles);
        let size = size_of_val(&mesh.positions[..]) + size_of_val(&mesh.triangles[..]);
        self.document.spend(size, field)?;
        Ok(mesh)
    }

    /// All vertices, without triangles.
    fn vertices(&mut self, key: &Key, uv_set: u32, field: &str) -> Result<Mesh, Error> {
        let document = self.document;
        let named = |name: &str| format!("{field}.attributes.{name}");
        let position = named("POSITION");
        let positions = accessor::read::<3>(document, key.positions, &position)?;
        let positions: Vec<_> = positions.into_iter().map(Vec3::from).collect();
        if let Some(bad) = positions.iter().position(|p| !p.is_finite()) {
            let found = positions[bad];
            let why = format!("vertex {bad} is {found}: mend the mesh and export again");
            return Err(document.error(position, why));
        }
        let mut mesh = Mesh {
            positions,
            ..Mesh::default()
        };
        if let Some(index) = key.normals {
            let normals = self.attribute(index, mesh.positions.len(), &named("NORMAL"))?;
            mesh.normals = normals.into_iter().map(Vec3::from).collect();
        }
        if let Some(index) = key.uvs {
            let name = named(&format!("TEXCOORD_{uv_set}"));
            let uvs = self.attribute(index, mesh.positions.len(), &name)?;
            let upwards = |uv: [f32; 2]| FLIP.transform_point2(uv.into());
            mesh.uvs = uvs.into_iter().map(upwards).collect();
        }
        Ok(mesh)
    }

    fn attribute<const N: usize>(
        &mut self,
        index: Index<Accessor>,
        vertices: usize,
        field: &str,
    ) -> Result<Vec<[f32; N]>, Error> {
        same_count(self.document, index, vertices, field)?;
        let mut values = accessor::read(self.document, index, field)?;
        for value in &mut values {
            if !value.iter().all(|x| x.is_finite()) {
                *value = [0.0; N];
                self.faults += 1;
            }
        }
        Ok(values)
    }
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

/// Leaves out vertices that no triangle uses: exporters put many meshes into one list. Takes time
/// by the triangles alone, so that many primitives may share one long list.
fn compact(mesh: &Mesh, mut triangles: Vec<[u32; 3]>) -> Mesh {
    let mut used = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    for corner in triangles.as_flattened_mut() {
        *corner = used.partition_point(|&i| i < *corner) as u32;
    }
    Mesh {
        positions: pick(&mesh.positions, &used),
        normals: pick(&mesh.normals, &used),
        uvs: pick(&mesh.uvs, &used),
        triangles,
    }
}

fn pick<T: Copy>(all: &[T], used: &[u32]) -> Vec<T> {
    if all.is_empty() {
        return Vec::new();
    }
    used.iter().map(|&i| all[i as usize]).collect()
}
