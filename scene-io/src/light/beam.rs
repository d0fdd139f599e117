//! A collimated beam: parallel light from a disc. Its colour is power, W.

use super::unhittable;
use crate::host::Hit;
use glam::{DVec3, Vec3};
use std::f32::consts::PI;
use tyndall_core::{
    Anchor, DirectSample, EmissionPdf, EmissionSample, Frame, LightKind, MediumId, Ray, warp,
};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// Centre of the disc.
    pub(crate) position: Vec3,
    /// Unit direction of travel, normal of the disc.
    pub(crate) direction: Vec3,
    pub(crate) radius: f32,
    pub(crate) medium: MediumId,
}

impl Beam {
    fn area(&self) -> f32 {
        PI * self.radius * self.radius
    }

    pub(super) fn sample_emission(&self, u: [f32; 2]) -> EmissionSample<f32, Hit> {
        let on_disc = self.radius * warp::disk(u);
        let origin = self.position + Frame::around(self.direction).to_world(on_disc.extend(0.0));
        EmissionSample {
            source: Anchor::Direction(-self.direction),
            ray: Ray::new(origin, self.direction),
            flux: 1.0,
            pdf: self.pdf_emission(),
            cos_theta: 1.0,
            kind: LightKind::Parallel,
            medium: self.medium,
        }
    }

    /// `None` outside of the beam.
    pub(super) fn sample_direct(&self, from: Vec3) -> Option<DirectSample<f32, Hit>> {
        let v = from - self.position;
        let ahead = v.dot(self.direction);
        let across = v - ahead * self.direction;
        let inside = ahead > 0.0 && across.length_squared() <= self.radius * self.radius;
        inside.then(|| {
            unhittable(
                LightKind::Parallel,
                Anchor::Point(self.position + across),
                -self.direction,
                1.0 / self.area(),
                self.pdf_emission(),
            )
        })
    }

    fn pdf_emission(&self) -> EmissionPdf {
        EmissionPdf {
            pdf_a: 1.0 / self.area(),
            pdf_w: 1.0,
        }
    }

    /// A point at the beam's radius from where its axis comes nearest to the line of `ray`, on the
    /// side away from it. Nearest points of lines in `f64`, with the difference of origins first.
    pub(super) fn pivot(&self, ray: &Ray) -> Vec3 {
        let (axis, line) = (self.direction.as_dvec3(), ray.direction.as_dvec3());
        let start = self.position.as_dvec3();
        let w = ray.origin.as_dvec3() - start;
        let normal = axis.cross(line);
        let sin2 = normal.length_squared();
        let t = if sin2 > 1e-12 {
            (w.dot(axis) - axis.dot(line) * w.dot(line)) / sin2
        } else {
            w.dot(axis)
        };
        let nearest = start + t.max(0.0) * axis;
        let away = normal.normalize_or(axis.any_orthonormal_vector());
        let side = if away.dot(w) > 0.0 { -1.0 } else { 1.0 };
        let pivot: DVec3 = nearest + side * f64::from(self.radius) * away;
        pivot.as_vec3()
    }
}
