//! What [`AnalyticHost`] offers to integrators: every capability; only a pinhole is a sensor
//! that can be connected to.

use super::{AnalyticHost, Boundary, BoundaryHit, INSIDE, Interface, fresnel};
use glam::Vec3;
use tyndall_core::{
    Aabb, Anchor, BsdfSample, DirectSample, EmissionPdf, EmissionSample, Geometry, HostTypes,
    LightDirect, LightEmission, LightPdf, Media, Medium, MediumId, PathFrom, Ray, Sensor,
    SensorConnection, SensorImportance, SensorRay, Shading, ShadingPdf, Spectrum, Surface,
    SurfaceKind,
};

impl<M: Medium> AnalyticHost<M> {
    fn medium_at(&self, p: Vec3) -> MediumId {
        if self.boundary.contains(p) {
            INSIDE
        } else {
            MediumId::VACUUM
        }
    }

    fn origin(&self, from: &Anchor<BoundaryHit>, direction: Vec3) -> Vec3 {
        match from {
            Anchor::Surface(hit) => self.boundary.offset(hit, direction),
            Anchor::Point(_) | Anchor::Direction(_) => position(from),
        }
    }
}

fn position(anchor: &Anchor<BoundaryHit>) -> Vec3 {
    match anchor {
        Anchor::Point(p) => *p,
        Anchor::Surface(hit) => hit.position,
        Anchor::Direction(w) => panic!("no ray starts at infinity, towards {w}"),
    }
}

impl<M: Medium> HostTypes for AnalyticHost<M> {
    type Spectrum = M::Spectrum;
    type Hit = BoundaryHit;
    type Medium = M;
}

impl<M: Medium> Geometry for AnalyticHost<M> {
    fn bounds(&self) -> Aabb {
        self.boundary.bounds()
    }

    fn intersect(&self, ray: &Ray, _: MediumId) -> Option<(f32, BoundaryHit)> {
        self.boundary.intersect(ray)
    }

    fn surface(&self, hit: &BoundaryHit) -> Surface {
        Surface {
            position: hit.position,
            geometric_normal: hit.normal,
            shading_normal: hit.normal,
        }
    }

    fn spawn(&self, from: &Anchor<BoundaryHit>, direction: Vec3) -> Ray {
        Ray::new(self.origin(from, direction), direction)
    }

    fn connect(&self, from: &Anchor<BoundaryHit>, to: &Anchor<BoundaryHit>) -> Ray {
        if let Anchor::Direction(direction) = to {
            return self.spawn(from, *direction);
        }
        let across = position(to) - position(from);
        let origin = self.origin(from, across);
        let end = self.origin(to, -across);
        let (direction, distance) = (end - origin).normalize_and_length();
        // A plane is met at its very distance, rounded: stop short of it.
        let t_max = match to {
            Anchor::Surface(_) => distance * (1.0 - 1e-5),
            _ => distance,
        };
        Ray::new(origin, direction).up_to(t_max)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.boundary.intersect(ray).is_some()
    }
}

impl<M: Medium> Shading for AnalyticHost<M> {
    fn surface_kind(&self, _: &BoundaryHit) -> SurfaceKind {
        match self.boundary.interface() {
            Interface::Matched => SurfaceKind::Null,
            Interface::Dielectric(_) => SurfaceKind::Delta,
        }
    }

    fn bsdf_eval(&self, _: &BoundaryHit, _: Vec3, _: Vec3, _: PathFrom) -> M::Spectrum {
        M::Spectrum::default()
    }

    fn bsdf_sample(
        &self,
        hit: &BoundaryHit,
        wo: Vec3,
        u: [f32; 3],
        from: PathFrom,
    ) -> Option<BsdfSample<M::Spectrum>> {
        let index = match self.boundary.interface() {
            Interface::Matched => return None, // no bounce: integrators pass through
            Interface::Dielectric(index) => index,
        };
        Some(fresnel::sample(hit.normal, index, wo, u[0], from))
    }

    fn emitted(&self, _: &BoundaryHit, _: Vec3) -> M::Spectrum {
        M::Spectrum::default()
    }

    fn background(&self, _: Vec3) -> M::Spectrum {
        self.light.background()
    }
}

impl<M: Medium> ShadingPdf for AnalyticHost<M> {
    fn bsdf_pdf_w(&self, _: &BoundaryHit, _: Vec3, _: Vec3, _: PathFrom) -> f32 {
        0.0
    }
}

impl<M: Medium> Media for AnalyticHost<M> {
    fn medium(&self, id: MediumId) -> Option<&M> {
        (id == INSIDE).then_some(&self.medium)
    }

    fn medium_across(&self, hit: &BoundaryHit, direction: Vec3, _: MediumId) -> MediumId {
        if direction.dot(hit.normal) < 0.0 {
            INSIDE
        } else {
            MediumId::VACUUM
        }
    }

    fn has_null_surfaces(&self) -> bool {
        self.boundary.interface() == Interface::Matched && self.boundary != Boundary::Nowhere
    }
}

impl<M: Medium> LightEmission for AnalyticHost<M> {
    fn sample_emission(&self, u: [f32; 6]) -> Option<EmissionSample<M::Spectrum, BoundaryHit>> {
        self.light.sample_emission(u, |p| self.medium_at(p))
    }
}

impl<M: Medium> LightDirect for AnalyticHost<M> {
    fn sample_direct(
        &self,
        from: Vec3,
        u: [f32; 4],
    ) -> Option<DirectSample<M::Spectrum, BoundaryHit>> {
        self.light.sample_direct(from, u)
    }

    fn pivot(&self, ray: &Ray, _: [f32; 4]) -> Option<Vec3> {
        self.light.pivot(ray)
    }
}

impl<M: Medium> LightPdf for AnalyticHost<M> {
    fn pdf_direct_w(&self, _: Vec3, to: &Anchor<BoundaryHit>) -> f32 {
        match to {
            Anchor::Direction(_) => self.light.background_pdf_w(),
            Anchor::Point(_) | Anchor::Surface(_) => 0.0,
        }
    }

    fn pdf_emission(&self, at: &Anchor<BoundaryHit>, _: Vec3) -> EmissionPdf {
        match at {
            Anchor::Direction(_) if self.light.background_pdf_w() > 0.0 => {
                self.light.pdf_emission()
            }
            _ => EmissionPdf::default(),
        }
    }
}

impl<M: Medium> Sensor for AnalyticHost<M> {
    fn resolution(&self) -> [u32; 2] {
        self.view.resolution()
    }

    fn sensor_ray(&self, px: [u32; 2], u: [f32; 4]) -> SensorRay<M::Spectrum> {
        let (ray, weight) = self.view.ray(px, u);
        SensorRay {
            ray,
            weight: M::Spectrum::splat(weight),
            medium: self.medium_at(ray.origin),
            pdf_w: self.view.pdf_w(ray.direction),
        }
    }
}

impl<M: Medium> SensorImportance for AnalyticHost<M> {
    fn connect_sensor(&self, from: Vec3, _: [f32; 2]) -> Option<SensorConnection<M::Spectrum>> {
        self.view.connect(from)
    }
}
