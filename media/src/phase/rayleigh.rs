//! Scattering by particles much smaller than the wavelength.

use super::exact;
use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{Frame, PhaseFunction, PhaseSample, warp};

/// p(θ) = 3/(16π) (1 + cos² θ), unpolarised (Lord Rayleigh 1871).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rayleigh;

impl Rayleigh {
    #[inline]
    fn density(cos_theta: f32) -> f32 {
        3.0 / (16.0 * PI) * (1.0 + cos_theta * cos_theta)
    }
}

impl PhaseFunction for Rayleigh {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        Self::density(wo.dot(wi))
    }

    /// Solves c³ + 3c = 8u − 4 = 2z by Cardano: c = ±(A − 1/A) with A = ∛(|z| + √(z² + 1)),
    /// as Frisvad (2011), "Importance sampling the Rayleigh phase function".
    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        let z = 4.0 * u[0] - 2.0;
        let a = (z.abs() + (z * z + 1.0).sqrt()).cbrt();
        let cos_theta = (a - 1.0 / a).min(1.0).copysign(z);
        let wi = Frame::around(-wo).to_world(warp::polar(cos_theta, u[1]));
        exact(wi, Self::density(cos_theta))
    }

    fn mean_cosine(&self) -> f32 {
        0.0
    }
}
