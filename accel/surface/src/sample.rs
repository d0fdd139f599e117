//! Points on shapes, uniform by area or as seen from a point.

use crate::instance;
use crate::octahedral;
use crate::shape::{Shape, cross};
use crate::surfaces::{ShapeHit, Surfaces};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};
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
        self.hit(shape, primitive, uv)
    }

    /// A point of a primitive to be lit by or seen from `from`, for `u` in \[0, 1)², and its density
    /// per steradian there; `None` if the primitive is seen edge-on or from within rounding.
    ///
    /// A sphere seen from outside is sampled uniformly over the cone that it fills (Shirley, Wang &
    /// Zimmerman 1996), any other primitive by area.
    ///
    /// # Panics
    /// If there is no such primitive of a mesh.
    pub fn sample_from(
        &self,
        shape: u32,
        primitive: u32,
        from: Vec3,
        u: [f32; 2],
    ) -> Option<(ShapeHit, f32)> {
        if let Some(cone) = self.cone(shape, from) {
            let uv = octahedral::encode(cone.normal(u));
            return Some((self.hit(shape, primitive, uv), cone.pdf_w()));
        }
        let hit = self.sample(shape, primitive, u);
        let pdf_w = self.pdf_from_w(&hit, from);
        (pdf_w > 0.0).then_some((hit, pdf_w))
    }

    /// The density with which [`Surfaces::sample_from`] finds `hit` from `from`.
    pub fn pdf_from_w(&self, hit: &ShapeHit, from: Vec3) -> f32 {
        let to = hit.position - from;
        let cosine = to.dot(hit.geometric_normal);
        if let Some(cone) = self.cone(hit.shape, from) {
            // The far side is not seen.
            return if cosine < 0.0 { cone.pdf_w() } else { 0.0 };
        }
        // d²/(|cos θ| A), cos θ = `cosine`/d
        let d2 = to.length_squared();
        let pdf_w = d2 * d2.sqrt() / (cosine.abs() * self.area(hit.shape, hit.primitive));
        if pdf_w.is_finite() { pdf_w } else { 0.0 }
    }

    /// The cone that a sphere fills for a point outside of it.
    fn cone(&self, shape: u32, from: Vec3) -> Option<Cone> {
        let Shape::Sphere { center, radius } = *self.shape(shape) else {
            return None;
        };
        let axis = center.as_dvec3() - from.as_dvec3();
        let sin2 = f64::from(radius).powi(2) / axis.length_squared();
        (sin2 < 1.0).then(|| Cone {
            axis: axis.normalize(),
            sin2,
            height: sin2 / (1.0 + (1.0 - sin2).sqrt()),
        })
    }
}

/// The directions in which a sphere is seen.
struct Cone {
    /// Towards the centre.
    axis: DVec3,
    /// Squared sine of the half angle.
    sin2: f64,
    /// 1 − cosine of the half angle.
    height: f64,
}

impl Cone {
    fn pdf_w(&self) -> f32 {
        (1.0 / (TAU * self.height)) as f32
    }

    /// The sphere's normal where it is first met in a uniform direction of the cone (Pharr, Jakob &
    /// Humphreys 2023, §6.2.4).
    fn normal(&self, u: [f32; 2]) -> DVec3 {
        let below = f64::from(u[0]) * self.height; // 1 − cos θ
        let sin2 = below * (2.0 - below);
        let cos =
            sin2 / self.sin2.sqrt() + (1.0 - below) * (1.0 - sin2 / self.sin2).max(0.0).sqrt();
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * f64::from(u[1])).sin_cos();
        let (s, t) = self.axis.any_orthonormal_pair();
        sin * (cos_phi * s + sin_phi * t) - cos * self.axis
    }
}

/// Barycentric coordinates, uniform over the triangle: (√u₀·(1−u₁), √u₀·u₁) (Turk 1990).
fn triangle(u: [f32; 2]) -> Vec2 {
    let root = u[0].sqrt();
    Vec2::new(root * (1.0 - u[1]), root * u[1])
}
