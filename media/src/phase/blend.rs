//! A mixture of phase functions.

use super::{Phase, exact};
use crate::MediumError;
use glam::Vec3;
use tyndall_core::{PhaseFunction, PhaseSample};

/// p = Σ wᵢ pᵢ with Σ wᵢ = 1.
#[derive(Clone, Debug)]
pub struct Blend {
    components: Vec<(f32, Phase)>,
}

impl Blend {
    /// Mixes `components`; their weights are relative and scaled to sum to 1.
    ///
    /// # Errors
    /// [`MediumError::BlendWeight`] if a weight is negative or not finite, or if none is positive.
    pub fn new(components: Vec<(f32, Phase)>) -> Result<Self, MediumError> {
        let bad = |w: f32| !(w.is_finite() && w >= 0.0);
        let total: f64 = components.iter().map(|&(w, _)| f64::from(w)).sum();
        let first_bad = components.iter().position(|&(w, _)| bad(w));
        if let Some(index) = first_bad.or((total == 0.0).then_some(0)) {
            let weight = components.get(index).map_or(0.0, |&(w, _)| w);
            return Err(MediumError::BlendWeight { index, weight });
        }
        let components = components
            .into_iter()
            .map(|(w, phase)| ((f64::from(w) / total) as f32, phase))
            .filter(|&(w, _)| w > 0.0)
            .collect();
        Ok(Self { components })
    }
}

impl PhaseFunction for Blend {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        eval(&self.components, wo, wi)
    }

    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        sample(&self.components, wo, u)
    }

    fn mean_cosine(&self) -> f32 {
        mean_cosine(&self.components)
    }
}

/// Σ wᵢ pᵢ.
pub(super) fn eval<P: PhaseFunction>(components: &[(f32, P)], wo: Vec3, wi: Vec3) -> f32 {
    let each = components.iter().map(|(w, phase)| w * phase.eval(wo, wi));
    each.sum()
}

/// `u[0]` chooses the component and, stretched to \[0, 1) again, serves it.
pub(super) fn sample<P: PhaseFunction>(
    components: &[(f32, P)],
    wo: Vec3,
    u: [f32; 2],
) -> PhaseSample {
    const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
    let last = components.len() - 1;
    let mut rest = u[0];
    let mut chosen = 0;
    while chosen < last && rest >= components[chosen].0 {
        rest -= components[chosen].0;
        chosen += 1;
    }
    let (w, phase) = &components[chosen];
    let wi = phase.sample(wo, [(rest / w).min(BELOW_ONE), u[1]]).wi;
    exact(wi, eval(components, wo, wi))
}

/// Σ wᵢ gᵢ.
pub(super) fn mean_cosine<P: PhaseFunction>(components: &[(f32, P)]) -> f32 {
    let each = components.iter().map(|(w, phase)| w * phase.mean_cosine());
    each.sum()
}
