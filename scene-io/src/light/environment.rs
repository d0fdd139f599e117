//! The background: light from infinity, of the same radiance from everywhere or painted by an
//! image. Its colour is that radiance, or what the image's is multiplied by.

mod sky;

pub(crate) use sky::Sky;

use super::World;
use crate::host::Hit;
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;
use tyndall_core::{
    Anchor, DirectSample, EmissionPdf, EmissionSample, LightKind, MediumId, Rgb, warp,
};

#[derive(Clone, Debug)]
pub(crate) enum Environment {
    Constant,
    Image(Arc<Sky>),
}

/// Density per steradian of a uniform direction.
const UNIFORM_PDF_W: f32 = 0.25 / PI;

impl Environment {
    /// Power that falls on the world, per unit of the colour.
    pub(super) fn power(&self, world: World) -> Rgb {
        let fluence = match self {
            Self::Constant => Rgb::new(1.0, 1.0, 1.0) * (4.0 * PI),
            Self::Image(sky) => sky.fluence(),
        };
        fluence * world.disc_area()
    }

    /// A direction towards the light, and its density per steradian; `u[2]` refines the others.
    fn sample(&self, u: [f32; 3]) -> Option<(Vec3, f32)> {
        match self {
            Self::Constant => Some((warp::uniform_sphere([u[0], u[1]]), UNIFORM_PDF_W)),
            Self::Image(sky) => sky.sample(u),
        }
    }

    /// Density per steradian with which the direction `w` towards the light is sampled.
    pub(super) fn pdf_w(&self, w: Vec3) -> f32 {
        match self {
            Self::Constant => UNIFORM_PDF_W,
            Self::Image(sky) => sky.pdf_w(w),
        }
    }

    pub(super) fn sample_emission(
        &self,
        [u0, u1, u2, u3, u4]: [f32; 5],
        world: World,
        medium: MediumId,
    ) -> Option<EmissionSample<f32, Hit>> {
        let (w, pdf_w) = self.sample([u2, u3, u4])?;
        let pdf = emission(pdf_w, world);
        Some(EmissionSample {
            source: Anchor::Direction(w),
            ray: world.ray_from_outside(-w, [u0, u1]),
            flux: 1.0 / (pdf.pdf_a * pdf.pdf_w),
            pdf,
            cos_theta: 1.0,
            kind: LightKind::Background,
            medium,
        })
    }

    pub(super) fn sample_direct(
        &self,
        u: [f32; 3],
        world: World,
    ) -> Option<DirectSample<f32, Hit>> {
        let (wi, pdf_w) = self.sample(u)?;
        Some(DirectSample {
            target: Anchor::Direction(wi),
            wi,
            weight: 1.0 / pdf_w,
            pdf_w,
            emission: emission(pdf_w, world),
            cos_theta: 1.0,
            kind: LightKind::Background,
        })
    }

    /// Densities of light that arrives from the direction `w`.
    pub(super) fn pdf_emission(&self, w: Vec3, world: World) -> EmissionPdf {
        emission(self.pdf_w(w), world)
    }
}

fn emission(pdf_w: f32, world: World) -> EmissionPdf {
    EmissionPdf {
        pdf_a: 1.0 / world.disc_area(),
        pdf_w,
    }
}
