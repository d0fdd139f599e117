//! Checks before anything is built.

use crate::error::SurfaceError;
use crate::instance;
use crate::shape::{Mesh, Shape, cross};
use glam::{DAffine3, DVec3, Vec3};
use std::collections::HashSet;
use std::sync::Arc;
use tyndall_core::Aabb;

/// Beyond it, products of coordinates leave the range of `f32`; Embree draws the same line.
const LARGEST: f32 = 1e18;

/// Whether these shapes can be built.
pub(crate) fn validate(shapes: &[Shape]) -> Result<(), SurfaceError> {
    let mut seen = HashSet::new();
    let mut primitives = 0;
    for (i, shape) in shapes.iter().enumerate() {
        let known = match shape {
            Shape::Instance { mesh, .. } => !seen.insert(Arc::as_ptr(mesh)),
            _ => false,
        };
        check_shape(i, shape, known)?;
        let copied = match shape {
            Shape::Instance { to_world, .. } => !known || !instance::is_shared(to_world),
            _ => true,
        };
        primitives += if copied { shape.primitive_count() } else { 1 };
    }
    if u32::try_from(primitives).is_err() {
        return Err(SurfaceError::TooMany { primitives });
    }
    Ok(())
}

/// `known` if its mesh has been checked before.
fn check_shape(shape: usize, what: &Shape, known: bool) -> Result<(), SurfaceError> {
    let finite = |field, v| check_finite(shape, field, [v]);
    match *what {
        Shape::Mesh(ref mesh) => check_mesh(shape, mesh),
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => {
            if !known {
                check_mesh(shape, mesh)?;
            }
            check_transform(shape, to_world)
        }
        Shape::Sphere { center, radius } => {
            finite("center", center)?;
            check_radius(shape, radius)
        }
        Shape::Quad {
            corner,
            edge_u,
            edge_v,
        } => {
            finite("corner", corner)?;
            finite("edge_u", edge_u)?;
            finite("edge_v", edge_v)?;
            if cross([Vec3::ZERO, edge_u, edge_v]).length_squared() == 0.0 {
                return Err(SurfaceError::Edges { shape });
            }
            Ok(())
        }
        Shape::Disk {
            center,
            normal,
            radius,
        } => {
            finite("center", center)?;
            finite("normal", normal)?;
            if normal.try_normalize().is_none() {
                return Err(SurfaceError::Normal { shape });
            }
            check_radius(shape, radius)
        }
    }
}

fn check_mesh(shape: usize, mesh: &Mesh) -> Result<(), SurfaceError> {
    let vertices = mesh.positions.len();
    check_finite(shape, "positions", mesh.positions.iter().copied())?;
    check_finite(shape, "normals", mesh.normals.iter().copied())?;
    check_finite(shape, "uvs", mesh.uvs.iter().map(|uv| uv.extend(0.0)))?;
    for (field, found) in [("normals", mesh.normals.len()), ("uvs", mesh.uvs.len())] {
        if found != 0 && found != vertices {
            return Err(SurfaceError::Attribute {
                shape,
                field,
                found,
                vertices,
            });
        }
    }
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&i| i as usize >= vertices) {
            return Err(SurfaceError::Index {
                shape,
                triangle,
                vertex,
                vertices,
            });
        }
    }
    Ok(())
}

fn check_transform(shape: usize, to_world: &DAffine3) -> Result<(), SurfaceError> {
    let columns = to_world
        .to_cols_array_2d()
        .map(|c| DVec3::from(c).as_vec3());
    check_finite(shape, "to_world", columns)?;
    if instance::is_flat(to_world) {
        return Err(SurfaceError::Flat {
            shape,
            determinant: to_world.matrix3.determinant(),
        });
    }
    Ok(())
}

/// Whether instances, and rays in the space of their meshes, stay within [`LARGEST`]. `boxes` are
/// those around the shapes.
pub(crate) fn check_range(shapes: &[Shape], boxes: &[Aabb]) -> Result<(), SurfaceError> {
    let limit = f64::from(LARGEST);
    for (shape, (what, bounds)) in shapes.iter().zip(boxes).enumerate() {
        let Shape::Instance { to_world, .. } = what else {
            continue;
        };
        if bounds.is_empty() {
            continue;
        }
        let size = bounds.size().as_dvec3().length();
        let farthest = bounds.min.abs().max(bounds.max.abs()).as_dvec3();
        let rays = to_world.inverse().matrix3.abs() * DVec3::splat(3.0 * size);
        if farthest.max(rays).max_element() > limit {
            return Err(SurfaceError::Range { shape });
        }
    }
    Ok(())
}

fn check_radius(shape: usize, radius: f32) -> Result<(), SurfaceError> {
    check_finite(shape, "radius", [Vec3::splat(radius)])?;
    if radius <= 0.0 {
        return Err(SurfaceError::Radius { shape, radius });
    }
    Ok(())
}

fn check_finite(
    shape: usize,
    field: &'static str,
    values: impl IntoIterator<Item = Vec3>,
) -> Result<(), SurfaceError> {
    let within = |v: Vec3| v.abs().cmple(Vec3::splat(LARGEST)).all();
    match values.into_iter().position(|v| !within(v)) {
        Some(index) => Err(SurfaceError::NotFinite {
            shape,
            field,
            index,
        }),
        None => Ok(()),
    }
}
