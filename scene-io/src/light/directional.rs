//! Light of one direction, from infinity. Its colour is the irradiance on a plane that faces it,
//! W·m⁻².

use super::World;
use glam::Vec3;
use tyndall_core::{EmissionPdf, EmissionSample, LightKind, MediumId};

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
    ) -> EmissionSample<f32> {
        EmissionSample {
            ray: world.ray_from_outside(self.direction, u),
            flux: self.power(world),
            pdf: EmissionPdf {
                pdf_a: 1.0 / world.disc_area(),
                pdf_w: 1.0,
            },
            cos_theta: 1.0,
            kind: LightKind::Parallel,
            medium,
        }
    }
}
