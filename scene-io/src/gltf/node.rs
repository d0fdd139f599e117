//! The graph of nodes: what stands where.

use super::accessor;
use super::document::Document;
use crate::Error;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::accessor::Accessor;
use gltf::json::scene::Node;
use gltf::json::{Index, Value};

/// Which scene of a file is meant.
#[derive(Clone, Debug)]
pub(crate) enum SceneChoice {
    /// Its place in the list.
    Index(usize),
    Name(String),
}

/// A node of the scene, and its transformation to the world.
pub(super) struct Placed {
    pub(super) node: usize,
    pub(super) to_world: DAffine3,
}

/// All nodes of a scene, each before its children: those of the scene chosen, or of the file's own,
/// or of its first, or all.
pub(super) fn walk(
    document: &Document,
    choice: Option<&SceneChoice>,
    transform: DAffine3,
) -> Result<Vec<Placed>, Error> {
    let root = &document.root;
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    let mut waiting: Vec<_> = roots(document, choice)?.into_iter().rev().collect();
    let mut transforms = vec![transform; waiting.len()];
    while let (Some(index), Some(parent)) = (waiting.pop(), transforms.pop()) {
        let node = &root.nodes[index.value()];
        let field = format!("nodes[{}]", index.value());
        if std::mem::replace(&mut seen[index.value()], true) {
            let why = "has two parents, or is below itself: give each node one parent";
            return Err(document.error(field, why));
        }
        let to_world = parent * transform_of(document, node, &field)?;
        if !to_world.is_finite() {
            let why = "is moved or scaled, with its parents, beyond what numbers hold";
            return Err(document.error(field, format!("{why}: mend its transformation")));
        }
        for child in node.children.iter().flatten().rev() {
            waiting.push(*child);
            transforms.push(to_world);
        }
        placed.push(Placed {
            node: index.value(),
            to_world,
        });
    }
    Ok(placed)
}

fn roots(document: &Document, choice: Option<&SceneChoice>) -> Result<Vec<Index<Node>>, Error> {
    let root = &document.root;
    let scene = match choice {
        Some(SceneChoice::Index(i)) => Some(*i),
        Some(SceneChoice::Name(name)) => {
            let named = |s: &gltf::json::Scene| s.name.as_deref() == Some(name);
            let found = root.scenes.iter().position(named);
            Some(found.ok_or_else(|| {
                let names = root.scenes.iter().filter_map(|s| s.name.as_deref());
                let names: Vec<_> = names.collect();
                let why = format!("has no scene {name:?}; its scenes: {}", names.join(", "));
                document.error("scenes", why)
            })?)
        }
        None => root
            .scene
            .map(|s| s.value())
            .or((!root.scenes.is_empty()).then_some(0)),
    };
    let Some(scene) = scene else {
        let mut is_child = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
            is_child[child.value()] = true;
        }
        let all = (0..root.nodes.len()).filter(|&i| !is_child[i]);
        return Ok(all.map(|i| Index::new(i as u32)).collect());
    };
    let found = root.scenes.get(scene).ok_or_else(|| {
        let count = root.scenes.len();
        document.error(
            "scenes",
            format!("has no scene {scene}; there are {count}, counting from 0"),
        )
    })?;
    Ok(found.nodes.clone())
}

/// From the coordinates of a node to those of its parent.
fn transform_of(document: &Document, node: &Node, field: &str) -> Result<DAffine3, Error> {
    let fault = |key: &str, why: &str| document.error(format!("{field}.{key}"), why);
    if let Some(m) = node.matrix {
        let m = m.map(f64::from);
        let row = [m[3], m[7], m[11], m[15] - 1.0];
        if !m.iter().all(|x| x.is_finite()) || row.iter().any(|x| x.abs() > 1e-5) {
            return Err(fault(
                "matrix",
                "must be finite, with 0, 0, 0, 1 in its last row: mend it and export again",
            ));
        }
        let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        return Ok(DAffine3::from_mat3_translation(linear, column(3)));
    }
    let vector = |v: Option<[f32; 3]>, or: DVec3| v.map_or(or, |v| DVec3::from(v.map(f64::from)));
    let translation = vector(node.translation, DVec3::ZERO);
    let scale = vector(node.scale, DVec3::ONE);
    let rotation = node
        .rotation
        .map_or(DQuat::IDENTITY, |r| DQuat::from_array(r.0.map(f64::from)));
    for (key, vector) in [("translation", translation), ("scale", scale)] {
        if !vector.is_finite() {
            return Err(fault(key, "must be finite: mend it and export again"));
        }
    }
    let Some(rotation) = normalized(rotation) else {
        return Err(fault(
            "rotation",
            "must be a quaternion other than zero: export again",
        ));
    };
    Ok(DAffine3::from_scale_rotation_translation(
        scale,
        rotation,
        translation,
    ))
}

fn normalized(q: DQuat) -> Option<DQuat> {
    let length = q.length();
    (length.is_finite() && length > 0.0).then(|| (q * length.recip()).normalize())
}

/// The transformations of the instances of a node, by `EXT_mesh_gpu_instancing`: from their
/// coordinates to those of the node. One, which does nothing, if it has none.
pub(super) fn instances(document: &Document, index: usize) -> Result<Vec<DAffine3>, Error> {
    const NAME: &str = "EXT_mesh_gpu_instancing";
    let node = &document.root.nodes[index];
    let extension = node.extensions.as_ref().and_then(|e| e.others.get(NAME));
    let Some(extension) = extension else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let field = format!("nodes[{index}].extensions.{NAME}.attributes");
    let attributes = &extension["attributes"];
    let translations = attribute::<3>(document, attributes, "TRANSLATION", &field)?;
    let rotations = attribute::<4>(document, attributes, "ROTATION", &field)?;
    let scales = attribute::<3>(document, attributes, "SCALE", &field)?;
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let Some(count) = counts.into_iter().flatten().max() else {
        return Err(document.error(
            field,
            "has none of TRANSLATION, ROTATION, SCALE: export again",
        ));
    };
    if counts.into_iter().flatten().any(|n| n != count) {
        return Err(document.error(field, "differ in their number of values: export again"));
    }
    let mut transforms = Vec::with_capacity(count);
    for i in 0..count {
        let vector = |of: &Option<Vec<[f32; 3]>>, or: DVec3| {
            of.as_ref().map_or(or, |v| DVec3::from(v[i].map(f64::from)))
        };
        let translation = vector(&translations, DVec3::ZERO);
        let scale = vector(&scales, DVec3::ONE);
        let rotation = rotations
            .as_ref()
            .map_or(DQuat::IDENTITY, |r| DQuat::from_array(r[i].map(f64::from)));
        let rotation =
            normalized(rotation).filter(|_| translation.is_finite() && scale.is_finite());
        let rotation = rotation.ok_or_else(|| {
            let why = format!("instance {i} is not finite, or rotated by zero: export again");
            document.error(&field, why)
        })?;
        transforms.push(DAffine3::from_scale_rotation_translation(
            scale,
            rotation,
            translation,
        ));
    }
    Ok(transforms)
}

fn attribute<const N: usize>(
    document: &Document,
    attributes: &Value,
    name: &str,
    field: &str,
) -> Result<Option<Vec<[f32; N]>>, Error> {
    let Some(value) = attributes.get(name) else {
        return Ok(None);
    };
    let field = format!("{field}.{name}");
    let count = document.root.accessors.len() as u64;
    let index = value.as_u64().filter(|&i| i < count);
    let index: Index<Accessor> = Index::new(
        index.ok_or_else(|| document.error(&field, "is no accessor of this file: export again"))?
            as u32,
    );
    accessor::read(document, index, &field).map(Some)
}
