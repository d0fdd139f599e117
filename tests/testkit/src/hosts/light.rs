//! Lights without surfaces.

use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{
    Anchor, DirectSample, EmissionPdf, EmissionSample, Frame, LightKind, MediumId, Ray, Spectrum,
    warp,
};

/// What lights the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light<S> {
    /// Nothing: the medium may emit.
    None,
    /// An isotropic point.
    Point {
        /// Where it is.
        position: Vec3,
        /// Total, W.
        power: S,
    },
    /// Parallel light from a disc: a laser, or the sun where the disc is wide.
    Beam {
        /// Middle of the disc, which faces along `direction`.
        center: Vec3,
        /// Unit direction of travel.
        direction: Vec3,
        /// Of the disc, scene units.
        radius: f32,
        /// On a plane facing the beam, W·m⁻².
        irradiance: S,
    },
    /// Constant radiance from everywhere.
    Background {
        /// W·sr⁻¹·m⁻².
        radiance: S,
        /// Of the sphere around the origin that emitted rays cross; it holds the scene.
        reach: f32,
    },
}

const UNIFORM_PDF_W: f32 = 0.25 / PI;

impl<S: Spectrum> Light<S> {
    /// Total power that emitted rays represent, W: π r² E of a beam, 4π² reach² L of
    /// the background.
    pub fn power(&self) -> S {
        match *self {
            Self::None => S::default(),
            Self::Point { power, .. } => power,
            Self::Beam {
                radius, irradiance, ..
            } => irradiance * (PI * radius * radius),
            Self::Background { radiance, reach } => radiance * (4.0 * PI * PI * reach * reach),
        }
    }

    /// Radiance of the background.
    pub(super) fn background(&self) -> S {
        match *self {
            Self::Background { radiance, .. } => radiance,
            _ => S::default(),
        }
    }

    /// `medium` is where a point of space lies.
    pub(super) fn sample_emission<Hit>(
        &self,
        u: [f32; 6],
        medium: impl Fn(Vec3) -> MediumId,
    ) -> Option<EmissionSample<S, Hit>> {
        let on_disc = |center: Vec3, direction, radius| {
            let offset = warp::disk([u[1], u[2]]).extend(0.0) * radius;
            Ray::new(
                center + Frame::around(direction).to_world(offset),
                direction,
            )
        };
        let uniform = warp::uniform_sphere([u[3], u[4]]);
        let (source, ray, kind) = match *self {
            Self::None => return None,
            Self::Point { position, .. } => (
                Anchor::Point(position),
                Ray::new(position, uniform),
                LightKind::Point,
            ),
            Self::Beam {
                center,
                direction,
                radius,
                ..
            } => (
                Anchor::Direction(-direction),
                on_disc(center, direction, radius),
                LightKind::Parallel,
            ),
            Self::Background { reach, .. } => {
                let start = -2.0 * reach * uniform;
                (
                    Anchor::Direction(-uniform),
                    on_disc(start, uniform, reach),
                    LightKind::Background,
                )
            }
        };
        Some(EmissionSample {
            source,
            ray,
            flux: self.power(),
            pdf: self.pdf_emission(),
            cos_theta: 1.0,
            kind,
            medium: medium(ray.origin),
        })
    }

    /// Every light samples its rays uniformly, so the densities are the same everywhere.
    pub(super) fn pdf_emission(&self) -> EmissionPdf {
        let disc = |radius: f32| 1.0 / (PI * radius * radius);
        let (pdf_a, pdf_w) = match *self {
            Self::None => (0.0, 0.0),
            Self::Point { .. } => (1.0, UNIFORM_PDF_W),
            Self::Beam { radius, .. } => (disc(radius), 1.0),
            Self::Background { reach, .. } => (disc(reach), UNIFORM_PDF_W),
        };
        EmissionPdf { pdf_a, pdf_w }
    }

    pub(super) fn sample_direct<Hit>(
        &self,
        from: Vec3,
        u: [f32; 4],
    ) -> Option<DirectSample<S, Hit>> {
        let (kind, target, wi, weight, pdf_w) = match *self {
            Self::None => return None,
            Self::Point { position, power } => {
                let (wi, distance) = (position - from).normalize_and_length();
                let weight = power * (UNIFORM_PDF_W / (distance * distance));
                let lit = distance > 0.0 && weight.is_finite();
                let target = Anchor::Point(position);
                lit.then_some((LightKind::Point, target, wi, weight, 0.0))?
            }
            Self::Beam {
                center,
                direction,
                radius,
                irradiance,
            } => {
                let offset = from - center;
                let along = offset.dot(direction);
                let across = offset - along * direction;
                let lit = along > 0.0 && across.length_squared() <= radius * radius;
                let target = Anchor::Point(center + across);
                lit.then_some((LightKind::Parallel, target, -direction, irradiance, 0.0))?
            }
            Self::Background { radiance, .. } => {
                let wi = warp::uniform_sphere([u[1], u[2]]);
                let weight = radiance / UNIFORM_PDF_W;
                let target = Anchor::Direction(wi);
                (LightKind::Background, target, wi, weight, UNIFORM_PDF_W)
            }
        };
        Some(DirectSample {
            target,
            wi,
            weight,
            pdf_w,
            emission: self.pdf_emission(),
            cos_theta: 1.0,
            kind,
        })
    }

    /// Density of [`Light::sample_direct`] towards the background.
    pub(super) fn background_pdf_w(&self) -> f32 {
        match self {
            Self::Background { .. } => UNIFORM_PDF_W,
            _ => 0.0,
        }
    }

    /// Beside the axis of a beam, on the side that the ray does not pass, at its radius; `None` for
    /// a ray that starts in the beam, or is parallel to it, and for the background.
    pub(super) fn pivot(&self, ray: &Ray) -> Option<Vec3> {
        match *self {
            Self::Point { position, .. } => Some(position),
            Self::Beam {
                center,
                direction,
                radius,
                ..
            } => {
                let offset = ray.origin - center;
                let normal = direction.cross(ray.direction);
                let from_axis = offset.reject_from_normalized(direction).length();
                if from_axis <= radius || normal.length_squared() < 1e-12 {
                    return None;
                }
                let away = -normal.normalize() * offset.dot(normal).signum();
                let cross = offset.cross(direction).dot(normal);
                let t = (cross / normal.length_squared()).max(0.0);
                let along = (offset + t * ray.direction).dot(direction).max(0.0);
                Some(center + along * direction + radius * away)
            }
            Self::None | Self::Background { .. } => None,
        }
    }
}
