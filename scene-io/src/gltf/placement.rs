//! Which primitive stands where: once, and it is moved there; more often, and its mesh is shared.

use super::document::Document;
use super::geometry::{self, Key};
use super::node::{self, Placed};
use crate::Error;
use crate::file::{Solid, around_points};
use crate::obj::Group;
use glam::{DAffine3, DVec3};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use std::collections::HashMap;
use std::sync::Arc;
use tyndall_surface::{Mesh, is_flat};

/// A primitive of a mesh, and one place where it stands.
pub(super) struct Placement {
    mesh: usize,
    primitive: usize,
    pub(super) material: Option<usize>,
    to_world: DAffine3,
}

/// Memory that a shape takes, at least.
const SHAPE: usize = 256;

/// All primitives of the nodes.
pub(super) fn primitives(
    document: &Document,
    nodes: &[Placed],
    notices: &mut Vec<String>,
) -> Result<Vec<Placement>, Error> {
    let root = &document.root;
    let mut placements = Vec::new();
    let mut rest = [false; 2];
    for placed in nodes {
        let node = &root.nodes[placed.node];
        let Some(mesh) = node.mesh.map(|m| m.value()) else {
            continue;
        };
        let primitives = &root.meshes[mesh].primitives;
        rest[0] |= node.skin.is_some();
        rest[1] |= primitives
            .iter()
            .any(|p| p.targets.as_ref().is_some_and(|t| !t.is_empty()));
        let instances = node::instances(document, placed.node)?;
        let count = instances.len().saturating_mul(primitives.len());
        document.spend(
            count.saturating_mul(SHAPE),
            format!("nodes[{}].mesh", placed.node),
        )?;
        for instance in instances {
            for (primitive, description) in primitives.iter().enumerate() {
                placements.push(Placement {
                    mesh,
                    primitive,
                    material: description.material.map(|m| m.value()),
                    to_world: placed.to_world * instance,
                });
            }
        }
    }
    let path = document.path.display();
    for (left_out, what) in rest.into_iter().zip(["skins", "morph targets"]) {
        if left_out {
            notices.push(format!(
                "{path}: left out: {what}; meshes are shown as they rest"
            ));
        }
    }
    Ok(placements)
}

/// What the shapes of a material need to know of it.
#[derive(Clone, Copy)]
pub(super) struct Traits {
    pub(super) uv_set: u32,
    pub(super) has_normal_map: bool,
}

/// The shapes of the placements, and their materials.
pub(super) fn solids(
    document: &Document,
    placements: Vec<Placement>,
    traits: impl Fn(Option<usize>) -> Traits,
    notices: &mut Vec<String>,
) -> Result<Vec<(Solid, Option<usize>)>, Error> {
    let mut reader = Reader {
        document,
        geometry: geometry::Reader::of(document),
        uses: HashMap::new(),
        shared: HashMap::new(),
    };
    let mut keyed = Vec::new();
    let mut left_out = Vec::new();
    for placement in placements {
        let primitive = placement.source(document);
        let Traits {
            uv_set,
            has_normal_map,
        } = traits(placement.material);
        match geometry::key(document, primitive, uv_set, &placement.field())? {
            Some(key) => {
                *reader.uses.entry(key).or_insert(0_usize) += 1;
                keyed.push((key, uv_set, placement));
            }
            None => left_out.push("points and lines"),
        }
        let has = |semantic| primitive.attributes.contains_key(&Checked::Valid(semantic));
        if has(Semantic::Colors(0)) {
            left_out.push("vertex colours");
        }
        if has_normal_map && has(Semantic::Tangents) {
            left_out.push("TANGENT; normal maps follow the texture coordinates");
        }
    }
    let mut solids = Vec::with_capacity(keyed.len());
    for (key, uv_set, placement) in keyed {
        if let Some(solid) = reader.solid(&key, uv_set, &placement)? {
            solids.push((solid, placement.material));
        }
    }
    left_out.sort_unstable();
    left_out.dedup();
    let path = document.path.display();
    notices.extend(
        left_out
            .iter()
            .map(|what| format!("{path}: left out: {what}")),
    );
    if reader.geometry.faults > 0 {
        let count = reader.geometry.faults;
        notices.push(format!(
            "{path}: {count} normals or texture coordinates are no numbers and count as absent"
        ));
    }
    Ok(solids)
}

impl Placement {
    fn field(&self) -> String {
        format!("meshes[{}].primitives[{}]", self.mesh, self.primitive)
    }

    fn source<'a>(&self, document: &'a Document) -> &'a Primitive {
        &document.root.meshes[self.mesh].primitives[self.primitive]
    }
}

struct Reader<'a> {
    document: &'a Document,
    geometry: geometry::Reader<'a>,
    uses: HashMap<Key, usize>,
    /// Meshes, and boxes around them.
    shared: HashMap<Key, (Arc<Mesh>, [DVec3; 2])>,
}

impl Reader<'_> {
    /// `None` if it has no triangles.
    fn solid(
        &mut self,
        key: &Key,
        uv_set: u32,
        placement: &Placement,
    ) -> Result<Option<Solid>, Error> {
        let field = placement.field();
        let to_world = placement.to_world;
        if self.uses.get(key) == Some(&1) {
            let mesh = self.geometry.read(key, uv_set, &field)?;
            let baked = || Solid::Mesh(baked(&mesh, &to_world));
            return Ok((!mesh.triangles.is_empty()).then(baked));
        }
        let (mesh, bounds) = match self.shared.get(key) {
            Some(shared) => shared.clone(),
            None => {
                let mesh = self.geometry.read(key, uv_set, &field)?;
                let bounds = around_points(mesh.positions.iter().map(|p| p.as_dvec3()));
                self.shared
                    .entry(*key)
                    .or_insert((Arc::new(mesh), bounds))
                    .clone()
            }
        };
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        if !is_flat(&to_world) {
            return Ok(Some(Solid::Instance {
                mesh,
                bounds,
                to_world,
            }));
        }
        let size = mesh.positions.len() * 36 + mesh.triangles.len() * 12;
        self.document.spend(size, &field)?;
        Ok(Some(Solid::Mesh(baked(&mesh, &to_world))))
    }
}

/// The mesh in the coordinates of the world. A reflection turns triangles round, so that their
/// outside stays outside (glTF 2.0, §3.7.4).
fn baked(mesh: &Mesh, to_world: &DAffine3) -> Group {
    let mirrored = to_world.matrix3.determinant() < 0.0;
    let mut group = Group {
        positions: mesh.positions.iter().map(|p| p.as_dvec3()).collect(),
        normals: mesh.normals.clone(),
        uvs: mesh.uvs.clone(),
        triangles: mesh.triangles.clone(),
    };
    if is_flat(to_world) {
        // What is flattened has no other normal than that of its plane.
        group.normals.clear();
    }
    if mirrored {
        group.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    group.transform(to_world);
    group
}
