//! Checks before anything is built.

use crate::error::SurfaceError;
use crate::shape::{Mesh, Shape, cross};
use glam::Vec3;

/// Beyond it, products of coordinates leave the range of `f32`; Embree draws the same line.
const LARGEST: f32 = 1e18;

/// Whether these shapes can be built.
pub(crate) fn validate(shapes: &[Shape]) -> Result<(), SurfaceError> {
    for (i, shape) in shapes.iter().enumerate() {
        check_shape(i, shape)?;
    }
    let primitives = shapes.iter().map(Shape::primitive_count).sum();
    if u32::try_from(primitives).is_err() {
        return Err(SurfaceError::TooMany { primitives });
    }
    Ok(())
}

fn check_shape(shape: usize, what: &Shape) -> Result<(), SurfaceError> {
    let finite = |field, v| check_finite(shape, field, [v]);
    match *what {
        Shape::Mesh(ref mesh) => check_mesh(shape, mesh),
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
