//! One emissive primitive of a shape; it shines on the side of its geometric normal. Its colour is
//! radiance.

use crate::host::Hit;
use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{
    Anchor, DirectSample, EmissionPdf, EmissionSample, Frame, LightKind, MediumId, warp,
};
use tyndall_surface::{Shape, Surfaces};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Area {
    pub(crate) shape: u32,
    pub(crate) primitive: u32,
    pub(crate) area: f32,
    /// `None` if the light crosses from one medium to another.
    pub(crate) medium: Option<MediumId>,
}

impl Area {
    pub(super) fn power(&self) -> f32 {
        PI * self.area
    }

    pub(super) fn sample_emission(
        &self,
        [u0, u1, u2, u3]: [f32; 4],
        surfaces: &Surfaces,
        locate: impl Fn(Vec3) -> MediumId,
    ) -> EmissionSample<f32, Hit> {
        let hit = surfaces.sample(self.shape, self.primitive, [u0, u1]);
        let local = warp::cosine_hemisphere([u2, u3]);
        let normal = surfaces.surface(&hit).geometric_normal;
        let direction = Frame::around(normal).to_world(local);
        let ray = surfaces.spawn(&Anchor::Surface(hit), direction);
        EmissionSample {
            source: Anchor::Surface(Hit::on_light(hit)),
            ray,
            flux: self.power(),
            pdf: self.pdf_emission(local.z),
            cos_theta: local.z,
            kind: LightKind::Area,
            medium: self.medium.unwrap_or_else(|| locate(ray.origin)),
        }
    }

    /// A point of the light seen from `from`; `None` if it shows its back.
    pub(super) fn sample_direct(
        &self,
        from: Vec3,
        u: [f32; 2],
        surfaces: &Surfaces,
    ) -> Option<DirectSample<f32, Hit>> {
        let (hit, pdf_w) = surfaces.sample_from(self.shape, self.primitive, from, u)?;
        let surface = surfaces.surface(&hit);
        let wi = (surface.position - from).normalize();
        let cos_theta = -wi.dot(surface.geometric_normal);
        (cos_theta > 0.0).then(|| DirectSample {
            target: Anchor::Surface(Hit::on_light(hit)),
            wi,
            weight: 1.0 / pdf_w,
            pdf_w,
            emission: self.pdf_emission(cos_theta),
            cos_theta,
            kind: LightKind::Area,
        })
    }

    /// Where light from it comes from, to points of a segment: the middle of a sphere, of which
    /// each sees another part, and elsewhere the point that they all see.
    pub(super) fn pivot(&self, u: [f32; 2], surfaces: &Surfaces) -> Vec3 {
        match *surfaces.shape(self.shape) {
            Shape::Sphere { center, .. } => center,
            _ => {
                let hit = surfaces.sample(self.shape, self.primitive, u);
                surfaces.surface(&hit).position
            }
        }
    }

    pub(super) fn pdf_emission(&self, cos_theta: f32) -> EmissionPdf {
        EmissionPdf {
            pdf_a: 1.0 / self.area,
            pdf_w: warp::cosine_hemisphere_pdf_w(cos_theta),
        }
    }
}
