//! `[[shapes]]`, in `f64` and where the file puts them.

use super::material::Material;
use super::reader::{Field, Table};
use super::texture::Textures;
use crate::Error;
use crate::obj::Group;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec2};
use std::sync::Arc;
use tyndall_core::{Aabb, Rgb};
use tyndall_surface::{Mesh, Shape};

/// A shape of one material.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) solid: Solid,
    pub(super) material: usize,
    pub(super) emission: Rgb,
}

/// A shape, in `f64`.
#[derive(Clone, Debug)]
pub(crate) enum Solid {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Quad {
        corner: DVec3,
        edges: [DVec3; 2],
    },
    Disk {
        center: DVec3,
        normal: DVec3,
        radius: f64,
    },
    Mesh(Group),
    /// A mesh that stands in several places; it has triangles, and uses all its vertices.
    Instance {
        mesh: Arc<Mesh>,
        /// A box around the mesh in its own coordinates.
        bounds: [DVec3; 2],
        to_world: DAffine3,
    },
}

impl Solid {
    /// Whether textures can lie on it.
    pub(crate) fn has_uvs(&self) -> bool {
        match self {
            Self::Mesh(group) => !group.uvs.is_empty(),
            Self::Instance { mesh, .. } => !mesh.uvs.is_empty(),
            _ => true,
        }
    }

    /// Smallest and largest corner of a box around it: the smallest one, but for instances.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let around = |center: &DVec3, r: DVec3| vec![*center - r, *center + r];
        let points = match self {
            Self::Sphere { center, radius } => around(center, DVec3::splat(*radius)),
            Self::Disk {
                center,
                normal,
                radius,
            } => around(
                center,
                *radius * (1.0 - normal * normal).max(DVec3::ZERO).map(f64::sqrt),
            ),
            Self::Quad {
                corner,
                edges: [u, v],
            } => vec![*corner, corner + u, corner + v, corner + u + v],
            Self::Mesh(group) => {
                let used = group.triangles.iter().flatten();
                used.map(|&i| group.positions[i as usize]).collect()
            }
            Self::Instance {
                bounds: [min, max],
                to_world,
                ..
            } => {
                let center = to_world.transform_point3(0.5 * (min + max));
                let [a, b, c] = to_world.matrix3.to_cols_array_2d().map(DVec3::from);
                let half = 0.5 * (max - min);
                let reach = a.abs() * half.x + b.abs() * half.y + c.abs() * half.z;
                around(&center, reach)
            }
        };
        around_points(points)
    }

    /// The smallest box around it. That of an instance costs a look at all its vertices.
    pub(super) fn tight_bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Instance { mesh, to_world, .. } => {
                let vertices = mesh.positions.iter();
                around_points(vertices.map(|p| to_world.transform_point3(p.as_dvec3())))
            }
            _ => self.bounds(),
        }
    }

    /// The shape as it is rendered, `origin` being moved to 0.
    pub(super) fn place(self, origin: DVec3) -> Shape {
        let point = |p: DVec3| (p - origin).as_vec3();
        match self {
            Self::Sphere { center, radius } => Shape::Sphere {
                center: point(center),
                radius: radius as f32,
            },
            Self::Quad { corner, edges } => Shape::Quad {
                corner: point(corner),
                edge_u: edges[0].as_vec3(),
                edge_v: edges[1].as_vec3(),
            },
            Self::Disk {
                center,
                normal,
                radius,
            } => Shape::Disk {
                center: point(center),
                normal: normal.as_vec3(),
                radius: radius as f32,
            },
            Self::Mesh(group) => Shape::Mesh(Mesh {
                positions: group.positions.into_iter().map(point).collect(),
                normals: group.normals,
                uvs: group.uvs,
                triangles: group.triangles,
            }),
            Self::Instance { mesh, to_world, .. } => Shape::Instance {
                mesh,
                to_world: DAffine3 {
                    translation: to_world.translation - origin,
                    ..to_world
                },
            },
        }
    }
}

/// The smallest box around points.
pub(crate) fn around_points(points: impl IntoIterator<Item = DVec3>) -> [DVec3; 2] {
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    (points.into_iter()).fold(empty, |[min, max], p| [min.min(p), max.max(p)])
}

/// The box in `f32`, rounded outwards.
pub(super) fn rounded([min, max]: [DVec3; 2], origin: DVec3) -> Aabb {
    Aabb {
        min: (min - origin).as_vec3().map(f32::next_down),
        max: (max - origin).as_vec3().map(f32::next_up),
    }
}

/// Reads shapes one after another; materials that OBJ files bring are added to the scene's.
pub(super) struct Reader<'a> {
    pub(super) textures: Textures<'a>,
    pub(super) names: Vec<String>,
    pub(super) materials: Vec<Material>,
    pub(super) placed: Vec<Placed>,
    /// What was read otherwise than it is meant.
    pub(super) notices: Vec<String>,
}

const KINDS: [&str; 5] = ["sphere", "quad", "box", "disk", "obj"];

impl Reader<'_> {
    pub(super) fn read(&mut self, field: &Field<'_>) -> Result<(), Error> {
        let table = field.table()?;
        let kind = table.required("kind")?.one_of(&KINDS)?;
        let emission = table.optional("emission").map(|f| f.colour()).transpose()?;
        if kind == "obj" {
            self.read_obj(&table, emission)?;
        } else {
            let field = table.required("material")?;
            let material = self.material(&field)?;
            if matches!(kind, "quad" | "disk") && self.materials[material].bsdf.transmits() {
                return Err(field.error(format!(
                    "light enters {:?}, so that the shape must be closed, which a {kind} is not: \
                     use a box, or a material that is `thin` or opaque",
                    self.names[material]
                )));
            }
            let solid = solid(kind, &table)?;
            self.add(solid, material, emission);
        }
        table.finish()
    }

    pub(super) fn add(&mut self, solid: Solid, material: usize, emission: Option<Rgb>) {
        self.placed.push(Placed {
            solid,
            material,
            emission: emission.unwrap_or(self.materials[material].emission),
        });
    }

    pub(super) fn material(&self, field: &Field<'_>) -> Result<usize, Error> {
        let names: Vec<_> = self.names.iter().map(String::as_str).collect();
        field.name_in("material", &names)
    }
}

fn solid(kind: &str, table: &Table<'_>) -> Result<Solid, Error> {
    let vector = |key| table.required(key)?.vector();
    let radius = || Ok::<_, Error>(f64::from(table.required("radius")?.positive()?));
    Ok(match kind {
        "sphere" => Solid::Sphere {
            center: vector("center")?,
            radius: radius()?,
        },
        "disk" => Solid::Disk {
            center: vector("center")?,
            normal: table.required("normal")?.direction()?,
            radius: radius()?,
        },
        "quad" => {
            table.expect(&["edge_u", "edge_v"]);
            let edges = [vector("edge_u")?, vector("edge_v")?];
            if edges[0].cross(edges[1]) == DVec3::ZERO {
                let edge = table.required("edge_v")?;
                return Err(edge.error("must be neither zero nor parallel to `edge_u`"));
            }
            let corner = vector("corner")?;
            Solid::Quad { corner, edges }
        }
        _ => {
            let (min, max) = (vector("min")?, vector("max")?);
            if !min.cmplt(max).all() {
                return Err(table
                    .required("max")?
                    .error("must exceed `min` in x, y and z"));
            }
            let mut group = cuboid(min, max);
            group.transform(&transform(table)?);
            Solid::Mesh(group)
        }
    })
}

/// The surface of a box, normals outwards. Each face shows a texture once: upright along y, those
/// below and above with x to the right.
fn cuboid(min: DVec3, max: DVec3) -> Group {
    let corner = |i: u32| {
        let bit = |n: u32| f64::from(i >> n & 1);
        min + (max - min) * DVec3::new(bit(0), bit(1), bit(2))
    };
    // Corners, and which of them is at the lower left.
    let faces = [
        ([0, 4, 6, 2], 0),
        ([1, 3, 7, 5], 3),
        ([0, 1, 5, 4], 0),
        ([2, 6, 7, 3], 1),
        ([0, 2, 3, 1], 3),
        ([4, 5, 7, 6], 0),
    ];
    let around = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let uvs = |first: usize| (0..4).map(move |i| around[(i + 4 - first) % 4]);
    Group {
        positions: faces.iter().flat_map(|(f, _)| f.map(corner)).collect(),
        normals: Vec::new(),
        uvs: faces.iter().flat_map(|&(_, first)| uvs(first)).collect(),
        triangles: (0..6)
            .flat_map(|face| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i: u32| 4 * face + i)))
            .collect(),
    }
}

/// `transform = { scale, rotate = { axis, degrees }, translate }`, applied in this order.
pub(super) fn transform(table: &Table<'_>) -> Result<DAffine3, Error> {
    let Some(field) = table.optional("transform") else {
        return Ok(DAffine3::IDENTITY);
    };
    let table = field.table()?;
    let scale = match table.optional("scale") {
        None => DVec3::ONE,
        Some(field) if field.is_array() => field.vector()?,
        Some(field) => DVec3::splat(field.number()?),
    };
    if !scale.cmpgt(DVec3::ZERO).all() {
        return Err(field.error("`scale` must be above 0: mirror the mesh where it was modelled"));
    }
    let mut rotation = DQuat::IDENTITY;
    if let Some(field) = table.optional("rotate") {
        let rotate = field.table()?;
        let axis = rotate.required("axis")?.direction()?;
        let angle = rotate.required("degrees")?.number()?.to_radians();
        rotation = DQuat::from_axis_angle(axis, angle);
        rotate.finish()?;
    }
    let translation = table
        .optional("translate")
        .map_or(Ok(DVec3::ZERO), |f| f.vector())?;
    table.finish()?;
    Ok(DAffine3::from_scale_rotation_translation(
        scale,
        rotation,
        translation,
    ))
}

impl Group {
    pub(crate) fn transform(&mut self, transform: &DAffine3) {
        for p in &mut self.positions {
            *p = transform.transform_point3(*p);
        }
        let normal_matrix: DMat3 = transform.matrix3.inverse().transpose();
        for n in &mut self.normals {
            *n = (normal_matrix * n.as_dvec3()).normalize_or_zero().as_vec3();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_face_outwards() {
        let group = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        let center = DVec3::new(0.5, 1.0, 1.5);
        let mut area = 0.0;
        for t in &group.triangles {
            let [a, b, c] = t.map(|i| group.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(a - center) > 0.0);
            area += 0.5 * normal.length();
        }
        assert_eq!(area, 22.0);
    }
}
