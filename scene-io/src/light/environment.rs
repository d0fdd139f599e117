//! The background: the same radiance, its colour, from everywhere.

use super::World;
use crate::host::Hit;
use std::f32::consts::PI;
use tyndall_core::{Anchor, DirectSample, EmissionPdf, EmissionSample, LightKind, MediumId, warp};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Environment;

/// Density per steradian of a uniform direction.
pub(super) const PDF_W: f32 = 0.25 / PI;

impl Environment {
    /// Power that falls on the world.
    pub(super) fn power(&self, world: World) -> f32 {
        4.0 * PI * world.disc_area()
    }

    pub(super) fn sample_emission(
        &self,
        [u0, u1, u2, u3]: [f32; 4],
        world: World,
        medium: MediumId,
    ) -> EmissionSample<f32, Hit> {
        let direction = warp::uniform_sphere([u2, u3]);
        EmissionSample {
            source: Anchor::Direction(-direction),
            ray: world.ray_from_outside(direction, [u0, u1]),
            flux: self.power(world),
            pdf: pdf_emission(world),
            cos_theta: 1.0,
            kind: LightKind::Background,
            medium,
        }
    }

    pub(super) fn sample_direct(&self, u: [f32; 2], world: World) -> DirectSample<f32, Hit> {
        let wi = warp::uniform_sphere(u);
        DirectSample {
            target: Anchor::Direction(wi),
            wi,
            weight: 1.0 / PDF_W,
            pdf_w: PDF_W,
            emission: pdf_emission(world),
            cos_theta: 1.0,
            kind: LightKind::Background,
        }
    }
}

pub(super) fn pdf_emission(world: World) -> EmissionPdf {
    EmissionPdf {
        pdf_a: 1.0 / world.disc_area(),
        pdf_w: PDF_W,
    }
}
