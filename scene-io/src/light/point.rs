//! Light from a point, alike in all directions. Its colour is intensity, W/sr.

use super::unhittable;
use crate::host::Hit;
use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{
    Anchor, DirectSample, EmissionPdf, EmissionSample, LightKind, MediumId, Ray, warp,
};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) position: Vec3,
    pub(crate) medium: MediumId,
}

impl Point {
    pub(super) fn power(&self) -> f32 {
        4.0 * PI
    }

    pub(super) fn sample_emission(&self, u: [f32; 2]) -> EmissionSample<f32, Hit> {
        EmissionSample {
            source: Anchor::Point(self.position),
            ray: Ray::new(self.position, warp::uniform_sphere(u)),
            flux: self.power(),
            pdf: pdf_emission(),
            cos_theta: 1.0,
            kind: LightKind::Point,
            medium: self.medium,
        }
    }

    pub(super) fn sample_direct(&self, from: Vec3) -> DirectSample<f32, Hit> {
        let (wi, distance) = (self.position - from).normalize_and_length();
        unhittable(
            LightKind::Point,
            Anchor::Point(self.position),
            wi,
            1.0 / (distance * distance),
            pdf_emission(),
        )
    }
}

fn pdf_emission() -> EmissionPdf {
    EmissionPdf {
        pdf_a: 1.0,
        pdf_w: 0.25 / PI,
    }
}
