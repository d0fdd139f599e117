//! Rays that leave surfaces, and rays between them.

use crate::instance;
use crate::shape::Shape;
use crate::surfaces::{Backend, ShapeHit, Surfaces};
use glam::{DAffine3, Vec3};
use tyndall_core::{Anchor, Ray};

/// Rounding of a position: half a unit in the last place for the hit and half for the origin of
/// the ray, relative to the coordinate; and the same again in reserve.
const POSITION_SLACK: f32 = 4.0 / (1 << 24) as f32;

/// Rounding of the intersection tests, relative to the size of the primitive, or to the length of
/// a connection that ends on it.
const TEST_SLACK: f32 = 16.0 / (1 << 24) as f32;

/// Rounding of Embree's inverse of an instance's transformation and of what it does to a point,
/// relative to the distances of the point and of the mesh's origin from the world's: some 30
/// roundings.
#[cfg(feature = "embree")]
const INVERSE_SLACK: f32 = 32.0 / (1 << 24) as f32;

impl Surfaces {
    /// The infinite ray leaving `from` in the unit direction `direction`, started where it cannot
    /// meet the surface it leaves again.
    ///
    /// A ray from a surface starts at `p ± h·n` on the side to which it goes, n the geometric
    /// normal and h = 2⁻²² Σ|pᵢnᵢ| + 2⁻²⁰ s, s the size of the primitive. The first term bounds the
    /// rounding of the position (after Pharr, Jakob & Humphreys 2023, §6.8.6), the second that of
    /// the intersection tests. To these an instance adds the rounding of the ray's way into the
    /// coordinates of its mesh, which does not grow with scale but with shear: for the embedded
    /// backend some 2⁻²⁰ s + 2⁻²² |p − q|, for Embree, which inverts in `f32`, 2⁻¹⁹ (|p| + |q|), q
    /// the point to which the mesh's own origin is taken.
    ///
    /// # Panics
    /// If `from` is [`Anchor::Direction`], which is nowhere.
    pub fn spawn(&self, from: &Anchor<ShapeHit>, direction: Vec3) -> Ray {
        Ray::new(self.start(from, direction, 0.0), direction)
    }

    /// The ray from `from` that ends just before `to`, so that neither end is met: both are moved
    /// as by [`Surfaces::spawn`], with 2⁻²⁰ of the distance added at `to`. Ends closer than that
    /// give a ray of length zero.
    ///
    /// # Panics
    /// As [`Surfaces::spawn`].
    pub fn connect(&self, from: &Anchor<ShapeHit>, to: &Anchor<ShapeHit>) -> Ray {
        if let Anchor::Direction(direction) = *to {
            return self.spawn(from, direction);
        }
        let across = place(to) - place(from);
        let distance = across.length();
        let start = self.start(from, across, 0.0);
        let end = self.start(to, -across, distance);
        let between = end - start;
        let crossed = between.dot(across) <= 0.0;
        Ray {
            origin: start,
            direction: if crossed { across } else { between }.normalize_or(Vec3::Z),
            t_max: if crossed { 0.0 } else { between.length() },
        }
    }

    /// Where a ray towards `direction` starts, for tests whose rounding grows with `distance`.
    fn start(&self, from: &Anchor<ShapeHit>, direction: Vec3, distance: f32) -> Vec3 {
        let position = place(from);
        let Anchor::Surface(hit) = from else {
            return position;
        };
        let normal = hit.geometric_normal;
        let shape = self.shape(hit.shape);
        let size = shape.size(hit.primitive).max(distance);
        let mut away = POSITION_SLACK * position.abs().dot(normal.abs()) + TEST_SLACK * size;
        if let Shape::Instance { to_world, .. } = shape {
            away += self.transform_slack(to_world, position, size);
        }
        let side = 1_f32.copysign(direction.dot(normal));
        position + side * away * normal
    }

    /// What a ray moves by that is taken into the coordinates of an instance's mesh, and tested
    /// there against a primitive of this `size` in the world.
    fn transform_slack(&self, to_world: &DAffine3, position: Vec3, size: f32) -> f32 {
        if !instance::is_shared(to_world) {
            return 0.0;
        }
        let (position, origin) = (position.as_dvec3(), to_world.translation);
        let slack = f64::from(TEST_SLACK * size)
            + match self.backend() {
                Backend::Embedded => f64::from(POSITION_SLACK) * position.distance(origin),
                #[cfg(feature = "embree")]
                Backend::Embree => f64::from(INVERSE_SLACK) * (position.length() + origin.length()),
            };
        (instance::shear(to_world) * slack) as f32
    }
}

impl Shape {
    /// The largest extent of a primitive along an axis.
    fn size(&self, primitive: u32) -> f32 {
        match *self {
            Self::Mesh(ref mesh) => {
                let [p0, p1, p2] = mesh.corners(primitive);
                let (low, high) = (p0.min(p1).min(p2), p0.max(p1).max(p2));
                (high - low).max_element()
            }
            Self::Instance {
                ref mesh,
                ref to_world,
            } => {
                let [p0, p1, p2] = instance::corners(mesh, to_world, primitive);
                let (low, high) = (p0.min(p1).min(p2), p0.max(p1).max(p2));
                (high - low).max_element() as f32
            }
            Self::Quad { edge_u, edge_v, .. } => (edge_u.abs() + edge_v.abs()).max_element(),
            Self::Sphere { radius, .. } | Self::Disk { radius, .. } => 2.0 * radius,
        }
    }
}

fn place(anchor: &Anchor<ShapeHit>) -> Vec3 {
    match anchor {
        Anchor::Point(p) => *p,
        Anchor::Surface(hit) => hit.position,
        Anchor::Direction(_) => panic!("a ray cannot start infinitely far away"),
    }
}
