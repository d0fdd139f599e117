//! The phase functions of media in the same place.

use super::{Phase, blend};
use glam::Vec3;
use smallvec::SmallVec;
use tyndall_core::{PhaseFunction, PhaseSample};

/// The phase function of one medium, or those of several mixed: what
/// [`AnyMedium`](crate::AnyMedium) has at a point.
#[derive(Clone, Debug)]
pub enum AnyPhase<'a> {
    /// Of one medium.
    One(&'a Phase),
    /// Of several.
    Mixture(Mixture<'a>),
}

/// p = Σ wᵢ pᵢ with Σ wᵢ = 1, of phase functions that live elsewhere. Up to 4 take no memory from
/// the heap.
#[derive(Clone, Debug)]
pub struct Mixture<'a> {
    components: SmallVec<[(f32, &'a Phase); 4]>,
}

impl<'a> AnyPhase<'a> {
    /// Mixes phase functions in proportion to what each medium scatters. Those that scatter nothing
    /// are left out; where none scatters, the mixture is isotropic.
    pub(crate) fn mix(media: impl Iterator<Item = (f32, AnyPhase<'a>)>) -> Self {
        let mut components = SmallVec::new();
        for (sigma_s, phase) in media.filter(|&(sigma_s, _)| sigma_s > 0.0) {
            match phase {
                Self::One(phase) => components.push((sigma_s, phase)),
                Self::Mixture(inner) => {
                    components.extend(inner.components.iter().map(|&(w, p)| (sigma_s * w, p)));
                }
            }
        }
        match components[..] {
            [] => Self::One(&Phase::Isotropic),
            [(_, phase)] => Self::One(phase),
            _ => {
                let total: f32 = components.iter().map(|&(w, _)| w).sum();
                components.iter_mut().for_each(|(w, _)| *w /= total);
                Self::Mixture(Mixture { components })
            }
        }
    }
}

impl PhaseFunction for Mixture<'_> {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        blend::eval(&self.components, wo, wi)
    }

    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        blend::sample(&self.components, wo, u)
    }

    fn mean_cosine(&self) -> f32 {
        blend::mean_cosine(&self.components)
    }
}

impl PhaseFunction for AnyPhase<'_> {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::One(phase) => phase.eval(wo, wi),
            Self::Mixture(mixture) => mixture.eval(wo, wi),
        }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        match self {
            Self::One(phase) => phase.sample(wo, u),
            Self::Mixture(mixture) => mixture.sample(wo, u),
        }
    }

    fn mean_cosine(&self) -> f32 {
        match self {
            Self::One(phase) => phase.mean_cosine(),
            Self::Mixture(mixture) => mixture.mean_cosine(),
        }
    }

    #[inline]
    fn is_isotropic(&self) -> bool {
        matches!(self, Self::One(Phase::Isotropic))
    }
}
