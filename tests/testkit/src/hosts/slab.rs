//! Plane-parallel media.

use super::{AnalyticHost, Boundary, Light, View};
use glam::Vec3;
use tyndall_core::{Medium, Ray, Spectrum};

/// What leaves the slab. The beam brings a flux of 1 W·m⁻² to every area of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exitant {
    /// Flux per area through the lit side: the plane albedo.
    Reflectance,
    /// Flux per area through the other side, scattered light only: the total transmittance is
    /// larger by the uncollided exp(−τ/μ₀), which is one direction and met by no ray.
    Transmittance,
    /// Radiance leaving the lit side at this cosine to its normal.
    Radiance(f32),
}

/// Distance of the sensor from the slab, in extents.
const DISTANCE: f32 = 1e-3;

impl<M: Medium> AnalyticHost<M> {
    /// A slab from z = 0 to z = `thickness` with matched boundaries in vacuum, infinite in x and y,
    /// lit from below by parallel light of cosine `mu_0` to the normal that brings a flux of
    /// 1 W·m⁻² to the slab (irradiance 1/μ₀ facing the beam). An infinite `thickness` is the half
    /// space.
    ///
    /// The beam is not infinite but a disc of radius `extent`: with 50 mean free paths (100 where
    /// the albedo exceeds 0.99) what it misses is beyond any measurement.
    ///
    /// What is known: [`SLABS`](crate::closed_form::SLABS) for normal incidence; for the isotropic
    /// half space [`HFunction`](crate::closed_form::HFunction) has reflectance and radiance.
    ///
    /// # Panics
    /// If a length is not positive, `extent` not finite, or a cosine not in (0, 1].
    pub fn slab(medium: M, thickness: f32, extent: f32, mu_0: f32, exitant: Exitant) -> Self {
        assert!(thickness > 0.0, "thickness {thickness}: give a length");
        assert!(
            extent > 0.0 && extent.is_finite(),
            "extent {extent}: give a finite length"
        );
        let direction = at_cosine(mu_0);
        // Upstream far enough that the whole disc lies below the slab.
        let distance = extent * (direction.x / direction.z + 0.1);
        let below = Vec3::new(0.0, 0.0, -DISTANCE * extent);
        let view = match exitant {
            Exitant::Reflectance => View::Flux {
                position: below,
                towards: Vec3::Z,
            },
            Exitant::Transmittance => View::Flux {
                position: Vec3::new(0.0, 0.0, thickness + DISTANCE * extent),
                towards: Vec3::NEG_Z,
            },
            Exitant::Radiance(mu) => View::Rays(vec![Ray::new(below, at_cosine(mu))]),
        };
        Self {
            boundary: Boundary::Slab { thickness, extent },
            medium,
            light: Light::Beam {
                center: -distance * direction,
                direction,
                radius: extent,
                irradiance: M::Spectrum::splat(1.0 / mu_0),
            },
            view,
        }
    }
}

fn at_cosine(mu: f32) -> Vec3 {
    assert!(mu > 0.0 && mu <= 1.0, "cosine {mu}: give one in (0, 1]");
    Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu)
}
