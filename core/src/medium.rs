//! Participating media.

use crate::{Ray, Sampler, Spectrum};
use glam::Vec3;
use std::convert::Infallible;
use std::marker::PhantomData;
use std::ops::ControlFlow;

/// Names what fills a region of space: a medium, vacuum, or whatever stack of overlapping
/// boundaries the host has interned. Photons and beams carry it; only the host reads it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MediumId(pub u32);

impl MediumId {
    /// Nothing: light travels unchanged.
    pub const VACUUM: Self = Self(0);
}

/// The coefficients of a medium at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients<S> {
    /// Absorption, 1/scene unit.
    pub sigma_a: S,
    /// Scattering, 1/scene unit.
    pub sigma_s: S,
    /// Emitted radiance per scene unit, W·sr⁻¹·m⁻² per unit (σa times the source function).
    pub emission: S,
}

impl<S: Spectrum> Coefficients<S> {
    /// Extinction σt = σa + σs.
    #[inline]
    pub fn sigma_t(&self) -> S {
        self.sigma_a + self.sigma_s
    }

    /// Single-scattering albedo σs/σt; 0 where nothing interacts.
    #[inline]
    pub fn albedo(&self) -> S {
        self.sigma_s.ratio(self.sigma_t())
    }
}

/// A directional distribution of scattering, normalised to 1 over the sphere.
///
/// `wo` and `wi` both point away from the vertex: light travelling straight on has `wi = −wo`.
pub trait PhaseFunction {
    /// The value per steradian.
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32;

    /// A direction, for `u` in \[0, 1)².
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample;

    /// Density per steradian of [`PhaseFunction::sample`].
    fn pdf_w(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval(wo, wi)
    }

    /// Mean of the cosine between the directions of travel before and after, in \[−1, 1\];
    /// positive is forward.
    fn mean_cosine(&self) -> f32;

    /// Whether the value is known to be 1/(4π) in all directions, so that it need not be asked for
    /// each.
    #[inline]
    fn is_isotropic(&self) -> bool {
        false
    }
}

impl<P: PhaseFunction> PhaseFunction for &P {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        (**self).eval(wo, wi)
    }
    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        (**self).sample(wo, u)
    }
    #[inline]
    fn pdf_w(&self, wo: Vec3, wi: Vec3) -> f32 {
        (**self).pdf_w(wo, wi)
    }
    fn mean_cosine(&self) -> f32 {
        (**self).mean_cosine()
    }
    #[inline]
    fn is_isotropic(&self) -> bool {
        (**self).is_isotropic()
    }
}

/// A sampled direction of scattering.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// Unit vector away from the vertex.
    pub wi: Vec3,
    /// Phase function over density; 1 if it is sampled exactly.
    pub weight: f32,
    /// Density per steradian.
    pub pdf_w: f32,
}

/// What happened along a ray through a medium.
#[derive(Clone, Copy, Debug)]
pub struct FreeFlight<S> {
    /// With a collision: σt·Tr over the density of its distance. Without: Tr over the probability
    /// of passing.
    pub weight: S,
    /// Where light met the medium; `None` if it passed to the end of the ray.
    pub collision: Option<Collision<S>>,
}

/// A real collision. Its coefficients are those at the point.
#[derive(Clone, Copy, Debug)]
pub struct Collision<S> {
    /// Distance along the ray.
    pub t: f32,
    /// Coefficients there; multiply [`FreeFlight::weight`] by their albedo for a scattering.
    pub coefficients: Coefficients<S>,
}

/// A stretch of a ray whose extinction is bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Majorant {
    /// Start, distance along the ray.
    pub t_min: f32,
    /// End.
    pub t_max: f32,
    /// No channel of σt exceeds this between them.
    pub sigma_bar: f32,
}

/// What fills the space between surfaces.
///
/// A ray passed to these methods has a unit direction and runs inside the region that the medium
/// fills; where the medium has no substance its coefficients are zero. All estimates are unbiased
/// and finite for `t_max` up to infinity.
///
/// `importance` says how much each channel matters to the caller (its throughput): distances are
/// sampled for the mixture of channels in this proportion, so that the mean of
/// `importance · weight` never exceeds that of `importance`. If it is black, all channels count
/// alike.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a participating medium",
    note = "implement `tyndall_core::Medium`, or name `Vacuum<Spectrum>` if the host has no media"
)]
pub trait Medium: Send + Sync {
    /// Channels of the coefficients.
    type Spectrum: Spectrum;
    /// The phase function at a point.
    type Phase<'a>: PhaseFunction
    where
        Self: 'a;

    /// Coefficients at `p`.
    fn coefficients(&self, p: Vec3) -> Coefficients<Self::Spectrum>;

    /// Phase function at `p`.
    fn phase(&self, p: Vec3) -> Self::Phase<'_>;

    /// An estimate of the transmittance of the ray, exp(−∫σt dt).
    fn transmittance(&self, ray: &Ray, sampler: &mut impl Sampler) -> Self::Spectrum;

    /// An estimate of the radiance that the medium itself emits along the ray towards its origin,
    /// ∫₀^t_max Tr(t)·emission(t) dt. Zero at no cost for a medium that does not emit.
    fn emitted(&self, ray: &Ray, sampler: &mut impl Sampler) -> Self::Spectrum;

    /// A distance to the next collision.
    fn sample_free_flight(
        &self,
        ray: &Ray,
        importance: Self::Spectrum,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<Self::Spectrum>;

    /// Density per scene unit of a collision at `t` by [`Medium::sample_free_flight`]. Exact if
    /// the medium is homogeneous; elsewhere any function of its arguments that resembles the
    /// density, good for weights of multiple importance sampling and for nothing else.
    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: Self::Spectrum) -> f32;

    /// Probability that [`Medium::sample_free_flight`] passes to the end of the ray, by the same
    /// rule as [`Medium::pdf_free_flight`].
    fn pmf_passing(&self, ray: &Ray, importance: Self::Spectrum) -> f32;

    /// Visits stretches that cover the ray in order of distance, with bounds of the extinction;
    /// gaps are empty. Stops when `visit` breaks.
    fn majorants(&self, ray: &Ray, visit: impl FnMut(Majorant) -> ControlFlow<()>);

    /// The coefficients if they and the phase function are the same everywhere, for closed forms.
    fn homogeneous(&self) -> Option<Coefficients<Self::Spectrum>>;
}

/// The medium of a host without media: it has no values, so that the compiler removes every line
/// that would handle one.
#[derive(Clone, Copy, Debug)]
pub struct Vacuum<S>(Infallible, PhantomData<fn() -> S>);

impl PhaseFunction for Infallible {
    fn eval(&self, _: Vec3, _: Vec3) -> f32 {
        match *self {}
    }
    fn sample(&self, _: Vec3, _: [f32; 2]) -> PhaseSample {
        match *self {}
    }
    fn mean_cosine(&self) -> f32 {
        match *self {}
    }
}

impl<S: Spectrum> Medium for Vacuum<S> {
    type Spectrum = S;
    type Phase<'a> = Infallible;

    fn coefficients(&self, _: Vec3) -> Coefficients<S> {
        match self.0 {}
    }
    fn phase(&self, _: Vec3) -> Infallible {
        self.0
    }
    fn transmittance(&self, _: &Ray, _: &mut impl Sampler) -> S {
        match self.0 {}
    }
    fn emitted(&self, _: &Ray, _: &mut impl Sampler) -> S {
        match self.0 {}
    }
    fn sample_free_flight(&self, _: &Ray, _: S, _: &mut impl Sampler) -> FreeFlight<S> {
        match self.0 {}
    }
    fn pdf_free_flight(&self, _: &Ray, _: f32, _: S) -> f32 {
        match self.0 {}
    }
    fn pmf_passing(&self, _: &Ray, _: S) -> f32 {
        match self.0 {}
    }
    fn majorants(&self, _: &Ray, _: impl FnMut(Majorant) -> ControlFlow<()>) {
        match self.0 {}
    }
    fn homogeneous(&self) -> Option<Coefficients<S>> {
        match self.0 {}
    }
}
