//! Light from a point into a cone. Its colour is the intensity in the inner cone, W/sr.

use super::unhittable;
use crate::host::Hit;
use glam::Vec3;
use std::f32::consts::TAU;
use tyndall_core::{
    Anchor, DirectSample, EmissionPdf, EmissionSample, Frame, LightKind, MediumId, Ray, warp,
};

/// Its intensity is constant within the inner cone and falls to zero at the outer one, linearly in
/// the cosine. Cones are given by their *height* 1 − cos θ, which is exact for narrow ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) position: Vec3,
    pub(crate) axis: Vec3,
    pub(crate) inner: f32,
    pub(crate) outer: f32,
    pub(crate) medium: MediumId,
}

/// 1 − cos θ.
pub(crate) fn cone_height(theta: f32) -> f32 {
    let s = (0.5 * theta).sin();
    2.0 * s * s
}

/// Power of a spot of unit intensity: 2π times the mean of both heights, in sr.
pub(crate) fn cone_power(inner: f32, outer: f32) -> f32 {
    TAU * 0.5 * (inner + outer)
}

impl Spot {
    pub(super) fn power(&self) -> f32 {
        cone_power(self.inner, self.outer)
    }

    /// Share of the full intensity in unit direction `w`.
    fn falloff(&self, w: Vec3) -> f32 {
        let height = 0.5 * (w - self.axis).length_squared();
        if height <= self.inner {
            1.0
        } else {
            ((self.outer - height) / (self.outer - self.inner)).max(0.0)
        }
    }

    pub(super) fn sample_emission(&self, u: [f32; 2]) -> EmissionSample<f32, Hit> {
        let ramp = 0.5 * (self.outer - self.inner);
        let mass = u[0] * (self.inner + ramp);
        let height = if mass < self.inner {
            mass
        } else {
            let rest = ((mass - self.inner) / ramp).clamp(0.0, 1.0);
            self.inner + (self.outer - self.inner) * (1.0 - (1.0 - rest).sqrt())
        };
        // The rim of the cone of this height.
        let local = warp::uniform_cone(height, [1.0, u[1]]);
        let w = Frame::around(self.axis).to_world(local);
        EmissionSample {
            source: Anchor::Point(self.position),
            ray: Ray::new(self.position, w),
            flux: self.power(),
            pdf: self.pdf_emission(self.falloff(w)),
            cos_theta: 1.0,
            kind: LightKind::Point,
            medium: self.medium,
        }
    }

    pub(super) fn sample_direct(&self, from: Vec3) -> DirectSample<f32, Hit> {
        let (wi, distance) = (self.position - from).normalize_and_length();
        let falloff = self.falloff(-wi);
        unhittable(
            LightKind::Point,
            Anchor::Point(self.position),
            wi,
            falloff / (distance * distance),
            self.pdf_emission(falloff),
        )
    }

    fn pdf_emission(&self, falloff: f32) -> EmissionPdf {
        EmissionPdf {
            pdf_a: 1.0,
            pdf_w: falloff / self.power(),
        }
    }
}
