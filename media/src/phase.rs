//! Phase functions.

mod blend;
mod henyey_greenstein;
mod mixture;
mod rayleigh;
mod tabulated;

pub use blend::Blend;
pub use henyey_greenstein::HenyeyGreenstein;
pub use mixture::{AnyPhase, Mixture};
pub use rayleigh::Rayleigh;
pub use tabulated::Tabulated;

use crate::MediumError;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;
use tyndall_core::{PhaseFunction, PhaseSample, warp};

/// A phase function: normalised to 1 over the sphere, sampled exactly, so that weights are 1.
///
/// θ is the angle between the directions of travel before and after: cos θ = −wo·wi, 1 is straight
/// on.
///
/// ```
/// use glam::Vec3;
/// use tyndall_core::PhaseFunction;
/// use tyndall_media::Phase;
/// let phase = Phase::henyey_greenstein(0.5)?;
/// let on = phase.eval(Vec3::Z, -Vec3::Z);
/// assert!((on - 0.75 / (4.0 * std::f32::consts::PI * 0.125)).abs() < 1e-6);
/// # Ok::<(), tyndall_media::MediumError>(())
/// ```
#[derive(Clone, Debug)]
pub enum Phase {
    /// 1/(4π) in every direction.
    Isotropic,
    /// One lobe, forward or backward.
    HenyeyGreenstein(HenyeyGreenstein),
    /// Particles much smaller than the wavelength.
    Rayleigh(Rayleigh),
    /// Any function of the angle, from a table.
    Tabulated(Arc<Tabulated>),
    /// A mixture of others.
    Blend(Arc<Blend>),
}

impl Phase {
    /// [`HenyeyGreenstein::new`].
    ///
    /// # Errors
    /// As there.
    pub fn henyey_greenstein(g: f32) -> Result<Self, MediumError> {
        HenyeyGreenstein::new(g).map(Self::HenyeyGreenstein)
    }

    /// [`Tabulated::new`].
    ///
    /// # Errors
    /// As there.
    pub fn tabulated(cosines: &[f32], values: &[f32]) -> Result<Self, MediumError> {
        Tabulated::new(cosines, values).map(|table| Self::Tabulated(Arc::new(table)))
    }

    /// [`Blend::new`].
    ///
    /// # Errors
    /// As there.
    pub fn blend(components: Vec<(f32, Self)>) -> Result<Self, MediumError> {
        Blend::new(components).map(|blend| Self::Blend(Arc::new(blend)))
    }
}

impl PhaseFunction for Phase {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Isotropic => 0.25 * FRAC_1_PI,
            Self::HenyeyGreenstein(phase) => phase.eval(wo, wi),
            Self::Rayleigh(phase) => phase.eval(wo, wi),
            Self::Tabulated(phase) => phase.eval(wo, wi),
            Self::Blend(phase) => phase.eval(wo, wi),
        }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        match self {
            Self::Isotropic => exact(warp::uniform_sphere(u), 0.25 * FRAC_1_PI),
            Self::HenyeyGreenstein(phase) => phase.sample(wo, u),
            Self::Rayleigh(phase) => phase.sample(wo, u),
            Self::Tabulated(phase) => phase.sample(wo, u),
            Self::Blend(phase) => phase.sample(wo, u),
        }
    }

    fn mean_cosine(&self) -> f32 {
        match self {
            Self::Isotropic => 0.0,
            Self::HenyeyGreenstein(phase) => phase.mean_cosine(),
            Self::Rayleigh(phase) => phase.mean_cosine(),
            Self::Tabulated(phase) => phase.mean_cosine(),
            Self::Blend(phase) => phase.mean_cosine(),
        }
    }

    #[inline]
    fn is_isotropic(&self) -> bool {
        matches!(self, Self::Isotropic)
    }
}

/// A direction sampled with the density of the phase function itself.
#[inline]
fn exact(wi: Vec3, pdf_w: f32) -> PhaseSample {
    PhaseSample {
        wi,
        weight: 1.0,
        pdf_w,
    }
}
