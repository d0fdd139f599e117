//! How texture coordinates run over a surface.

use crate::instance;
use crate::shape::{Mesh, Shape, disk_axes};
use crate::surfaces::{ShapeHit, Surfaces};
use glam::{DVec3, Vec3};

impl Surfaces {
    /// How the position changes with the texture coordinates of [`Surfaces::uv`]: \[∂p/∂u, ∂p/∂v\],
    /// in scene units for one unit of the coordinate; neither unit vectors nor orthogonal.
    ///
    /// `None` for a mesh without texture coordinates, for a triangle over which they do not span an
    /// area or whose derivatives leave the range of `f32`, and for a sphere, whose map has creases.
    pub fn tangents(&self, hit: &ShapeHit) -> Option<[Vec3; 2]> {
        let tangents = match *self.shape(hit.shape) {
            Shape::Mesh(ref mesh) => {
                let corners = mesh.corners(hit.primitive).map(|p| p.as_dvec3());
                of_triangle(mesh, hit.primitive, corners)?
            }
            Shape::Instance {
                ref mesh,
                ref to_world,
            } => {
                let corners = instance::corners(mesh, to_world, hit.primitive);
                of_triangle(mesh, hit.primitive, corners)?
            }
            Shape::Quad { edge_u, edge_v, .. } => [edge_u, edge_v].map(|e| e.as_dvec3()),
            Shape::Disk { normal, radius, .. } => {
                disk_axes(normal).map(|axis| 2.0 * f64::from(radius) * axis)
            }
            Shape::Sphere { .. } => return None,
        };
        let tangents = tangents.map(|t| t.as_vec3());
        let usable = |t: &Vec3| t.is_finite() && *t != Vec3::ZERO;
        tangents.iter().all(usable).then_some(tangents)
    }
}

/// Solves pᵢ − p0 = (uᵢ − u0)·∂p/∂u + (vᵢ − v0)·∂p/∂v for i = 1, 2.
fn of_triangle(mesh: &Mesh, triangle: u32, [p0, p1, p2]: [DVec3; 3]) -> Option<[DVec3; 2]> {
    if mesh.uvs.is_empty() {
        return None;
    }
    let [a, b, c] = mesh.triangles[triangle as usize].map(|i| mesh.uvs[i as usize].as_dvec2());
    let (s, t) = (b - a, c - a);
    let area = s.perp_dot(t);
    let (e, f) = (p1 - p0, p2 - p0);
    (area != 0.0).then(|| [(t.y * e - s.y * f) / area, (s.x * f - t.x * e) / area])
}
