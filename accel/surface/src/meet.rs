//! Where exactly a ray meets the primitive that a backend has chosen.
//!
//! Backends decide in `f32`; here the same question is answered in `f64`, where products of two
//! `f32` are exact, so that distance and position do not depend on the backend or on how the ray
//! was shifted.

use crate::instance;
use crate::octahedral;
use crate::shape::{Shape, disk_axes};
use glam::{DVec2, DVec3, Vec2};
use tyndall_core::Ray;

/// A ray in `f64`.
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl From<&Ray> for Line {
    fn from(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
        }
    }
}

impl Line {
    /// Parameter of the point of the line closest to `p`.
    fn closest(&self, p: DVec3) -> f64 {
        (p - self.origin).dot(self.direction) / self.direction.length_squared()
    }
}

/// The distance at which a ray meets a primitive, and where on it, as
/// [`ShapeHit::uv`](crate::ShapeHit::uv).
pub(crate) type Meeting = (f64, Vec2);

impl Shape {
    /// Where `primitive` is met, which a backend has found at about `t`; the nearest point of it
    /// if the ray misses by a rounding error.
    pub(crate) fn meet(&self, primitive: u32, line: &Line, t: f64) -> Meeting {
        match *self {
            Self::Mesh(ref mesh) => {
                let corners = mesh.corners(primitive).map(|p| p.as_dvec3());
                triangle(line, corners, t)
            }
            Self::Instance {
                ref mesh,
                ref to_world,
            } => triangle(line, instance::corners(mesh, to_world, primitive), t),
            Self::Quad {
                corner,
                edge_u,
                edge_v,
            } => {
                let edges = [edge_u, edge_v].map(|e| e.as_dvec3());
                flat(line, t, corner.as_dvec3(), edges, into_square)
            }
            Self::Sphere { center, radius } => sphere(line, center.as_dvec3(), radius.into()),
            Self::Disk {
                center,
                normal,
                radius,
            } => {
                let axes = disk_axes(normal).map(|axis| f64::from(radius) * axis);
                let corner = center.as_dvec3() - axes[0] - axes[1];
                flat(line, t, corner, axes.map(|axis| 2.0 * axis), into_disk)
            }
        }
    }
}

/// The distances at which a line enters and leaves a sphere; `None` if it misses.
///
/// t = b ± √((r² − |c − o − b·d|²)/d²), b = (c − o)·d/d². The discriminant is taken from the
/// rejected vector, which does not cancel where r is small against the distance: Haines, Günther
/// & Akenine-Möller (2019), "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
/// Gems, eq. 5.
pub(crate) fn sphere_roots(line: &Line, center: DVec3, radius: f64) -> Option<[f64; 2]> {
    let b = line.closest(center);
    let rejected = center - line.origin - b * line.direction;
    let inside = radius * radius - rejected.length_squared();
    let half = (inside / line.direction.length_squared()).sqrt();
    (inside >= 0.0).then_some([b - half, b + half])
}

/// As [`Shape::meet`], for a triangle.
pub(crate) fn triangle(line: &Line, [p0, p1, p2]: [DVec3; 3], t: f64) -> Meeting {
    flat(line, t, p0, [p1 - p0, p2 - p0], into_triangle)
}

fn sphere(line: &Line, center: DVec3, radius: f64) -> Meeting {
    let t = match sphere_roots(line, center, radius) {
        Some([front, _]) if front > 0.0 => front,
        Some([_, back]) => back,
        None => line.closest(center),
    };
    let outwards = line.origin + t * line.direction - center;
    (t, octahedral::encode(outwards.normalize()))
}

/// Meets `corner + u·edge_u + v·edge_v` (Möller & Trumbore 1997) with (u, v) moved `into` the
/// primitive.
///
/// Where that is far from what the backend has found, the ray runs along the plane to within
/// rounding and their intersection means nothing: the primitive is then met where the ray is at
/// `t`.
fn flat(
    line: &Line,
    t: f64,
    corner: DVec3,
    [edge_u, edge_v]: [DVec3; 2],
    into: impl Fn(DVec2) -> DVec2,
) -> Meeting {
    let at = |uv: DVec2| line.closest(corner + uv.x * edge_u + uv.y * edge_v);
    let across = line.direction.cross(edge_v);
    let s = line.origin - corner;
    let exact = DVec2::new(s.dot(across), line.direction.dot(s.cross(edge_u)));
    let exact = exact / across.dot(edge_u);
    let uv = into(exact);
    let size = edge_u.length() + edge_v.length();
    if uv.distance(exact) <= 1e-3 && (at(uv) - t).abs() <= 1e-3 * (t + size) {
        return (at(uv), uv.as_vec2());
    }
    let normal = edge_u.cross(edge_v);
    let near = s + t * line.direction;
    let areas = DVec2::new(
        near.cross(edge_v).dot(normal),
        edge_u.cross(near).dot(normal),
    );
    let uv = into(areas / normal.length_squared());
    (at(uv), uv.as_vec2())
}

fn into_square(uv: DVec2) -> DVec2 {
    uv.clamp(DVec2::ZERO, DVec2::ONE)
}

/// Moves barycentric coordinates into the triangle.
pub(crate) fn into_triangle(uv: DVec2) -> DVec2 {
    let uv = uv.max(DVec2::ZERO);
    uv / (uv.x + uv.y).max(1.0)
}

fn into_disk(uv: DVec2) -> DVec2 {
    let p = 2.0 * uv - 1.0;
    0.5 + 0.5 * p / p.length().max(1.0)
}
