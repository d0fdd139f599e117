//! Light of one direction, from infinity. Its colour is the irradiance on a plane that faces it,
//! W·m⁻².

use super::{World, unhittable};
use crate::host::Hit;
use glam::Vec3;
use tyndall_core::{Anchor, DirectSample, EmissionPdf, EmissionSample, LightKind, MediumId};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Directional {
    /// Unit direction of travel.
    pub(crate) direction: Vec3,
}

impl Directional {
    /// Power that falls on the world.
    pub(super) fn power(&self, world: World) -> f32 {
        world.disc_area()
    }

    pub(super) fn sample_emission(
        &self,
        u: [f32; 2],
        world: World,
        medium: MediumId,
    ) -> EmissionSample<f32, Hit> {
        EmissionSample {
            source: Anchor::Direction(-self.direction),
            ray: world.ray_from_outside(self.direction, u),
            flux: self.power(world),
            pdf: pdf_emission(world),
            cos_theta: 1.0,
            kind: LightKind::Parallel,
            medium,
        }
    }

    pub(super) fn sample_direct(&self, world: World) -> DirectSample<f32, Hit> {
        let wi = -self.direction;
        unhittable(
            LightKind::Parallel,
            Anchor::Direction(wi),
            wi,
            1.0,
            pdf_emission(world),
        )
    }
}

fn pdf_emission(world: World) -> EmissionPdf {
    EmissionPdf {
        pdf_a: 1.0 / world.disc_area(),
        pdf_w: 1.0,
    }
}
