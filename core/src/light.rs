//! Light leaving sources and arriving at points.

use crate::{Anchor, MediumId, Ray};
use glam::Vec3;

/// What kind of connection a light allows. Light that media emit has no kind yet: it is found by
/// [`Medium::emitted`](crate::Medium::emitted) alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LightKind {
    /// A surface that rays can hit.
    Area,
    /// A point (point, spot): cannot be hit, can be connected to.
    Point,
    /// One direction or a beam of parallel light: cannot be hit.
    Parallel,
    /// The background, hit by rays that leave the scene.
    Background,
}

/// A ray of light leaving a source.
#[derive(Clone, Debug)]
pub struct EmissionSample<S, Hit> {
    /// The point that the light leaves: a surface, a point, or (for [`LightKind::Parallel`] and
    /// [`LightKind::Background`]) the direction towards the source.
    pub source: Anchor<Hit>,
    /// From the source into the scene; infinite.
    pub ray: Ray,
    /// Power that the sample stands for, in W: its mean over all samples is the total power of the
    /// lights. Emitted radiance × cosine over both densities; where `kind` makes one of them a
    /// probability, intensity or irradiance takes the place of radiance.
    pub flux: S,
    /// Densities of this sample, the choice of the light included.
    pub pdf: EmissionPdf,
    /// |cos θ| between the ray and the normal of the source; 1 where there is no surface.
    pub cos_theta: f32,
    /// What was chosen.
    pub kind: LightKind,
    /// The medium in which the ray starts.
    pub medium: MediumId,
}

/// Densities of an emitted ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EmissionPdf {
    /// Per area on the source (for [`LightKind::Parallel`] and [`LightKind::Background`]: per area
    /// perpendicular to the ray); a probability for a point.
    pub pdf_a: f32,
    /// Per steradian; a probability for one direction.
    pub pdf_w: f32,
}

/// Light arriving at a point, before visibility and transmittance.
#[derive(Clone, Debug)]
pub struct DirectSample<S, Hit> {
    /// Where the light comes from; [`Geometry::connect`](crate::Geometry::connect) makes the ray.
    pub target: Anchor<Hit>,
    /// Unit vector from the point to the light.
    pub wi: Vec3,
    /// Arriving radiance over `pdf_w`; for a light that cannot be hit, its irradiance on a plane
    /// facing it over the probability of its choice.
    pub weight: S,
    /// Density per steradian of this technique at `wi`, the choice of the light included. Zero if
    /// no ray can find the light by chance (a point, a beam, an invisible shape): then the sample
    /// stands alone in multiple importance sampling.
    pub pdf_w: f32,
    /// Densities of [`LightEmission::sample_emission`](crate::LightEmission::sample_emission) for
    /// the same light, travelling along −`wi`; zero for a host without it.
    pub emission: EmissionPdf,
    /// |cos θ| between `wi` and the normal of the source; 1 where there is no surface.
    pub cos_theta: f32,
    /// What was chosen.
    pub kind: LightKind,
}
