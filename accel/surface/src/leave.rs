//! Rays that leave surfaces, and rays between them.

use crate::instance;
use crate::shape::Shape;
use crate::surfaces::{ShapeHit, Surfaces};
use glam::Vec3;
use tyndall_core::{Anchor, Ray};

/// Rounding of a position: half a unit in the last place for the hit and half for the origin of
/// the ray, relative to the coordinate; and the same again in reserve.
const POSITION_SLACK: f32 = 4.0 / (1 << 24) as f32;

/// Rounding of the intersection tests, relative to the size of the primitive, or to the length of
/// a connection that ends on it.
const TEST_SLACK: f32 = 16.0 / (1 << 24) as f32;

impl Surfaces {
    /// The infinite ray leaving `from` in the unit direction `direction`, started where it cannot
    /// meet the surface it leaves again.
    ///
    /// A ray from a surface starts at `p ± h·n` on the side to which it goes, n the geometric
    /// normal and h = 2⁻²² Σ|pᵢnᵢ| + 2⁻²⁰ s, s the size of the primitive. The first term bounds the
    /// rounding of the position (after Pharr, Jakob & Humphreys 2023, §6.8.6), the second that of
    /// the intersection tests.
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
        let across = self.place(to) - self.place(from);
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
        let position = self.place(from);
        let Anchor::Surface(hit) = from else {
            return position;
        };
        let normal = self.normal(hit);
        let away = POSITION_SLACK * position.abs().dot(normal.abs())
            + TEST_SLACK * self.shape(hit.shape).size(hit.primitive).max(distance);
        let side = 1_f32.copysign(direction.dot(normal));
        position + side * away * normal
    }

    fn place(&self, anchor: &Anchor<ShapeHit>) -> Vec3 {
        match anchor {
            Anchor::Point(p) => *p,
            Anchor::Surface(hit) => self.shape(hit.shape).position(hit),
            Anchor::Direction(_) => panic!("a ray cannot start infinitely far away"),
        }
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
