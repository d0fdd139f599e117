//! Media in which light scatters once: what single scattering looks like is known.

use glam::Vec3;
use std::ops::ControlFlow;
use tyndall_core::{
    Coefficients, FreeFlight, Majorant, Medium, PhaseFunction, PhaseSample, Ray, Sampler,
};

/// The medium, but walks of light that have scattered in it carry nothing any more.
#[derive(Clone, Debug)]
pub(crate) struct Once<M>(pub(crate) M);

pub(crate) struct OncePhase<P>(P);

impl<P: PhaseFunction> PhaseFunction for OncePhase<P> {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.0.eval(wo, wi)
    }

    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        PhaseSample {
            weight: 0.0,
            ..self.0.sample(wo, u)
        }
    }

    fn mean_cosine(&self) -> f32 {
        self.0.mean_cosine()
    }
}

impl<M: Medium> Medium for Once<M> {
    type Spectrum = M::Spectrum;
    type Phase<'a>
        = OncePhase<M::Phase<'a>>
    where
        M: 'a;

    fn coefficients(&self, p: Vec3) -> Coefficients<M::Spectrum> {
        self.0.coefficients(p)
    }
    fn phase(&self, p: Vec3) -> Self::Phase<'_> {
        OncePhase(self.0.phase(p))
    }
    fn transmittance(&self, ray: &Ray, sampler: &mut impl Sampler) -> M::Spectrum {
        self.0.transmittance(ray, sampler)
    }
    fn emitted(&self, ray: &Ray, sampler: &mut impl Sampler) -> M::Spectrum {
        self.0.emitted(ray, sampler)
    }
    fn sample_free_flight(
        &self,
        ray: &Ray,
        importance: M::Spectrum,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<M::Spectrum> {
        self.0.sample_free_flight(ray, importance, sampler)
    }
    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: M::Spectrum) -> f32 {
        self.0.pdf_free_flight(ray, t, importance)
    }
    fn pmf_passing(&self, ray: &Ray, importance: M::Spectrum) -> f32 {
        self.0.pmf_passing(ray, importance)
    }
    fn majorants(&self, ray: &Ray, visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        self.0.majorants(ray, visit);
    }
    fn homogeneous(&self) -> Option<Coefficients<M::Spectrum>> {
        self.0.homogeneous()
    }
}
