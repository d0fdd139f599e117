//! Light from a point, alike in all directions. Its colour is intensity, W/sr.

use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{EmissionPdf, EmissionSample, LightKind, MediumId, Ray, warp};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) position: Vec3,
    pub(crate) medium: MediumId,
}

impl Point {
    pub(super) fn power(&self) -> f32 {
        4.0 * PI
    }

    pub(super) fn sample_emission(&self, u: [f32; 2]) -> EmissionSample<f32> {
        EmissionSample {
            ray: Ray::new(self.position, warp::uniform_sphere(u)),
            flux: self.power(),
            pdf: EmissionPdf {
                pdf_a: 1.0,
                pdf_w: 0.25 / PI,
            },
            cos_theta: 1.0,
            kind: LightKind::Point,
            medium: self.medium,
        }
    }

    /// Direction towards the light, and irradiance on a plane that faces it.
    pub(super) fn arriving(&self, from: Vec3) -> (Vec3, f32) {
        let (wi, distance) = (self.position - from).normalize_and_length();
        (wi, 1.0 / (distance * distance))
    }
}
