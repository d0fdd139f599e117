//! The scene as a host: all capability traits of `tyndall_core`.

use crate::look::Look;
use crate::material::Bsdf;
use crate::{Scene, mapping};
use glam::Vec3;
use tyndall_core::{
    Aabb, Anchor, BsdfSample, DirectSample, EmissionPdf, EmissionSample, Frame, Geometry,
    HostTypes, LightDirect, LightEmission, LightPdf, Media, MediumId, PathFrom, Ray, Sensor,
    SensorConnection, SensorImportance, SensorRay, Shading, ShadingPdf, Spectrum, Surface,
    SurfaceKind,
};
use tyndall_media::AnyMedium;
use tyndall_surface::ShapeHit;

/// A point on a surface, and what lies on both its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Where.
    pub shape: ShapeHit,
    /// Index of refraction behind the surface (against its normal) over that before it; 1 if
    /// light passes straight.
    pub eta: f32,
    /// Whether it is there at all.
    pub presence: Presence,
}

/// Whether a surface is there for a path that meets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// It is.
    There,
    /// It is not, for a boundary of higher priority is around it. Crossing it still counts.
    Outranked,
    /// It is not: alpha cuts a hole there, and crossing it means nothing.
    Cut,
}

impl Hit {
    /// A point on a light, which nothing is scattered at.
    pub(crate) fn on_light(shape: ShapeHit) -> Self {
        Self {
            shape,
            eta: 1.0,
            presence: Presence::There,
        }
    }
}

fn anchor(anchor: &Anchor<Hit>) -> Anchor<ShapeHit> {
    match anchor {
        Anchor::Point(p) => Anchor::Point(*p),
        Anchor::Surface(hit) => Anchor::Surface(hit.shape),
        Anchor::Direction(w) => Anchor::Direction(*w),
    }
}

impl<S: Spectrum> HostTypes for Scene<S> {
    type Spectrum = S;
    type Hit = Hit;
    type Medium = AnyMedium<S>;
}

impl<S: Spectrum> Geometry for Scene<S> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn intersect(&self, ray: &Ray, here: MediumId) -> Option<(f32, Hit)> {
        let (t, shape) = self.surfaces.intersect(ray)?;
        let boundary = self.boundaries.of_shape(shape.shape);
        let eta = boundary.map_or(Some(1.0), |b| self.boundaries.relative_ior(b, here));
        let presence = match eta {
            _ if self.look(shape.shape).is_cut(&self.surfaces, &shape) => Presence::Cut,
            None => Presence::Outranked,
            Some(_) => Presence::There,
        };
        let hit = Hit {
            shape,
            eta: eta.unwrap_or(1.0),
            presence,
        };
        Some((t, hit))
    }

    fn surface(&self, hit: &Hit) -> Surface {
        let surface = self.surfaces.surface(&hit.shape);
        match self.look(hit.shape.shape).normal_map() {
            Some(map) => mapping::bend(surface, map, &self.surfaces, &hit.shape),
            None => surface,
        }
    }

    fn spawn(&self, from: &Anchor<Hit>, direction: Vec3) -> Ray {
        self.surfaces.spawn(&anchor(from), direction)
    }

    fn connect(&self, from: &Anchor<Hit>, to: &Anchor<Hit>) -> Ray {
        self.surfaces.connect(&anchor(from), &anchor(to))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.surfaces.occluded(ray)
    }
}

/// A surface point, to change between the world and the frame of its shading normal.
struct Point {
    surface: Surface,
    frame: Frame,
}

impl Point {
    #[inline]
    fn new(surface: Surface) -> Self {
        let frame = Frame::around(surface.shading_normal);
        Self { surface, frame }
    }

    /// `w` in the frame; `None` if the two normals disagree about its side, where light would leak
    /// through: such directions carry nothing.
    #[inline]
    fn to_local(&self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        (local.z * w.dot(self.surface.geometric_normal) > 0.0).then_some(local)
    }

    /// What makes a function symmetric that is meant for the cosine to the geometric normal, where
    /// the integrator multiplies by that to the shading normal (Veach 1997, eq. 5.19).
    #[inline]
    fn correction(&self, wo: Vec3, wi: Vec3, from: PathFrom) -> f32 {
        let Surface {
            geometric_normal: ng,
            shading_normal: ns,
            ..
        } = self.surface;
        if from == PathFrom::Sensor || ng == ns {
            return 1.0;
        }
        (wo.dot(ns) * wi.dot(ng) / (wo.dot(ng) * wi.dot(ns))).abs()
    }
}

impl<S: Spectrum> Scene<S> {
    fn look(&self, shape: u32) -> &Look<S> {
        &self.looks[shape as usize]
    }

    /// `None` if the surface is not there.
    pub(crate) fn bsdf(&self, hit: &Hit) -> Option<Bsdf<S>> {
        let look = self.look(hit.shape.shape);
        (hit.presence == Presence::There).then(|| look.bsdf(&self.surfaces, &hit.shape))
    }

    /// Whether a texture or a hole keeps a point of a light from emitting: it is never sampled.
    fn is_dark(&self, at: &Anchor<Hit>) -> bool {
        let Anchor::Surface(hit) = at else {
            return false;
        };
        self.look(hit.shape.shape).maps.is_some() && self.radiance(&hit.shape).is_black()
    }

    /// Radiance on the side of the normal.
    fn radiance(&self, hit: &ShapeHit) -> S {
        self.look(hit.shape).radiance(&self.surfaces, hit)
    }
}

impl<S: Spectrum> Shading for Scene<S> {
    fn surface_kind(&self, hit: &Hit) -> SurfaceKind {
        (self.bsdf(hit)).map_or(SurfaceKind::Null, |bsdf| bsdf.kind(hit.eta))
    }

    fn bsdf_eval(&self, hit: &Hit, wo: Vec3, wi: Vec3, from: PathFrom) -> S {
        let point = Point::new(self.surface(hit));
        let (Some(bsdf), Some(o), Some(i)) =
            (self.bsdf(hit), point.to_local(wo), point.to_local(wi))
        else {
            return S::default();
        };
        bsdf.eval(o, i, hit.eta, from) * point.correction(wo, wi, from)
    }

    fn bsdf_sample(
        &self,
        hit: &Hit,
        wo: Vec3,
        u: [f32; 3],
        from: PathFrom,
    ) -> Option<BsdfSample<S>> {
        let bsdf = self.bsdf(hit);
        let Some(bsdf) = bsdf.filter(|b| b.kind(hit.eta) != SurfaceKind::Null) else {
            return Some(BsdfSample {
                wi: -wo,
                weight: S::splat(1.0),
                pdf_w: 0.0,
                delta: true,
                eta: 1.0,
            });
        };
        let point = Point::new(self.surface(hit));
        let sample = bsdf.sample(point.to_local(wo)?, u, hit.eta, from)?;
        let wi = point.frame.to_world(sample.wi);
        point.to_local(wi)?;
        Some(BsdfSample {
            wi,
            weight: sample.weight * point.correction(wo, wi, from),
            ..sample
        })
    }

    fn emitted(&self, hit: &Hit, wo: Vec3) -> S {
        let glows = !self.look(hit.shape.shape).emission.is_black();
        if glows && self.surfaces.surface(&hit.shape).geometric_normal.dot(wo) > 0.0 {
            self.radiance(&hit.shape)
        } else {
            S::default()
        }
    }

    fn background(&self, direction: Vec3) -> S {
        self.lights.background(direction)
    }
}

impl<S: Spectrum> ShadingPdf for Scene<S> {
    fn bsdf_pdf_w(&self, hit: &Hit, wo: Vec3, wi: Vec3, _: PathFrom) -> f32 {
        let point = Point::new(self.surface(hit));
        match (self.bsdf(hit), point.to_local(wo), point.to_local(wi)) {
            (Some(bsdf), Some(wo), Some(wi)) => bsdf.pdf_w(wo, wi, hit.eta),
            _ => 0.0,
        }
    }
}

impl<S: Spectrum> Media for Scene<S> {
    fn medium(&self, id: MediumId) -> Option<&AnyMedium<S>> {
        self.boundaries.medium(id).map(|m| &self.media[m])
    }

    fn medium_across(&self, hit: &Hit, direction: Vec3, here: MediumId) -> MediumId {
        let boundary = self.boundaries.of_shape(hit.shape.shape);
        let Some(boundary) = boundary.filter(|_| hit.presence != Presence::Cut) else {
            return here;
        };
        let entering = self
            .surfaces
            .surface(&hit.shape)
            .geometric_normal
            .dot(direction)
            < 0.0;
        self.boundaries.across(boundary, entering, here)
    }

    fn has_null_surfaces(&self) -> bool {
        self.has_null_surfaces
    }
}

impl<S: Spectrum> LightEmission for Scene<S> {
    fn sample_emission(&self, u: [f32; 6]) -> Option<EmissionSample<S, Hit>> {
        let radiance = |hit: &ShapeHit| self.radiance(hit);
        (self.lights).sample_emission(u, &self.surfaces, radiance, |p| self.locate(p))
    }
}

impl<S: Spectrum> LightDirect for Scene<S> {
    fn sample_direct(&self, from: Vec3, u: [f32; 4]) -> Option<DirectSample<S, Hit>> {
        let radiance = |hit: &ShapeHit| self.radiance(hit);
        self.lights.sample_direct(from, u, &self.surfaces, radiance)
    }

    fn pivot(&self, ray: &Ray, u: [f32; 4]) -> Option<Vec3> {
        self.lights.pivot(ray, u, &self.surfaces)
    }
}

impl<S: Spectrum> LightPdf for Scene<S> {
    fn pdf_direct_w(&self, from: Vec3, to: &Anchor<Hit>) -> f32 {
        if self.is_dark(to) {
            return 0.0;
        }
        self.lights.pdf_direct_w(from, to, &self.surfaces)
    }

    fn pdf_emission(&self, at: &Anchor<Hit>, direction: Vec3) -> EmissionPdf {
        if self.is_dark(at) {
            return EmissionPdf::default();
        }
        self.lights.pdf_emission(at, direction, &self.surfaces)
    }
}

impl<S: Spectrum> Sensor for Scene<S> {
    fn resolution(&self) -> [u32; 2] {
        self.camera.resolution()
    }

    fn sensor_ray(&self, px: [u32; 2], u: [f32; 4]) -> SensorRay<S> {
        let (ray, weight) = self.camera.ray(px, u);
        SensorRay {
            weight: S::splat(weight),
            pdf_w: self.camera.pdf_w(ray.direction),
            ..SensorRay::new(ray, self.camera_medium)
        }
    }
}

impl<S: Spectrum> SensorImportance for Scene<S> {
    fn connect_sensor(&self, from: Vec3, u: [f32; 2]) -> Option<SensorConnection<S>> {
        self.camera.connect(from, u)
    }
}
