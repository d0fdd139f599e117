//! Points on shapes, uniform by area.

use crate::instance;
use crate::octahedral;
use crate::shape::{Shape, cross};
use crate::surfaces::{ShapeHit, Surfaces};
use glam::{Vec2, Vec3};
use std::f64::consts::PI;
use tyndall_core::warp;

impl Surfaces {
    /// Area of a primitive in square scene units.
    ///
    /// # Panics
    /// If there is no such primitive of a mesh.
    pub fn area(&self, shape: u32, primitive: u32) -> f32 {
        let area = match *self.shape(shape) {
            Shape::Mesh(ref mesh) => 0.5 * cross(mesh.corners(primitive)).length(),
            Shape::Instance {
                ref mesh,
                ref to_world,
            } => {
                let of_mesh = cross(mesh.corners(primitive));
                0.5 * (instance::of_normals(to_world) * of_mesh).length()
            }
            Shape::Sphere { radius, .. } => 4.0 * PI * f64::from(radius).powi(2),
            Shape::Quad { edge_u, edge_v, .. } => cross([Vec3::ZERO, edge_u, edge_v]).length(),
            Shape::Disk { radius, .. } => PI * f64::from(radius).powi(2),
        };
        area as f32
    }

    /// A point of a primitive for `u` in \[0, 1)²; density 1 over [`Surfaces::area`] per area.
    ///
    /// # Panics
    /// If there is no such primitive of a mesh.
    pub fn sample(&self, shape: u32, primitive: u32, u: [f32; 2]) -> ShapeHit {
        let uv = match self.shape(shape) {
            Shape::Mesh(_) | Shape::Instance { .. } => triangle(u),
            Shape::Quad { .. } => u.into(),
            Shape::Sphere { .. } => octahedral::encode(warp::uniform_sphere(u).as_dvec3()),
            Shape::Disk { .. } => 0.5 + 0.5 * warp::disk(u),
        };
        ShapeHit {
            shape,
            primitive,
            uv,
        }
    }
}

/// Barycentric coordinates, uniform over the triangle: (√u₀·(1−u₁), √u₀·u₁) (Turk 1990).
fn triangle(u: [f32; 2]) -> Vec2 {
    let root = u[0].sqrt();
    Vec2::new(root * (1.0 - u[1]), root * u[1])
}
