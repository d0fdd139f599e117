//! Any medium of this crate.

use crate::{AnyPhase, Atmosphere, Field, GridMedium, Homogeneous, Overlap, SparseGrid};
use glam::Vec3;
use std::ops::ControlFlow;
use std::sync::Arc;
use tyndall_core::{Coefficients, FreeFlight, Majorant, Medium, Ray, Sampler, Spectrum};

/// One of the media of this crate, for scenes that mix them. Clones share their fields.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum AnyMedium<S> {
    /// The same everywhere.
    Homogeneous(Homogeneous<S>),
    /// Thinner with height.
    Atmosphere(Atmosphere<S>),
    /// A density grid.
    Grid(Arc<GridMedium<S>>),
    /// A sparse density grid.
    Sparse(Arc<GridMedium<S, SparseGrid>>),
    /// Any other density: one that the host computes, or a [`Mapped`](crate::Mapped) one.
    Field(Arc<GridMedium<S, Arc<dyn Field<f32>>>>),
    /// Several in the same place.
    Overlap(Overlap<S>),
}

/// Calls the same method of whichever medium it is.
macro_rules! forward {
    ($self:ident, $medium:ident => $call:expr) => {
        match $self {
            AnyMedium::Homogeneous($medium) => $call,
            AnyMedium::Atmosphere($medium) => $call,
            AnyMedium::Grid($medium) => $call,
            AnyMedium::Sparse($medium) => $call,
            AnyMedium::Field($medium) => $call,
            AnyMedium::Overlap($medium) => $call,
        }
    };
}

impl<S: Spectrum> AnyMedium<S> {
    /// Whether free flights are tracked step by step, not by a closed form.
    pub(crate) fn is_tracked(&self) -> bool {
        !matches!(self, Self::Homogeneous(_) | Self::Atmosphere(_))
    }

    /// Whether it emits.
    pub(crate) fn emits(&self) -> bool {
        forward!(self, medium => medium.emits())
    }

    /// The transmittance of a ray, exact where there is a closed form, else near it.
    pub(crate) fn mean_transmittance(&self, ray: &Ray) -> S {
        forward!(self, medium => medium.mean_transmittance(ray))
    }

    /// All stretches of [`Medium::majorants`].
    pub(crate) fn stretches(&self, ray: &Ray) -> Vec<Majorant> {
        let mut stretches = Vec::new();
        self.majorants(ray, |stretch| {
            stretches.push(stretch);
            ControlFlow::Continue(())
        });
        stretches
    }
}

impl<S: Spectrum> Medium for AnyMedium<S> {
    type Spectrum = S;
    type Phase<'a> = AnyPhase<'a>;

    #[inline]
    fn coefficients(&self, p: Vec3) -> Coefficients<S> {
        forward!(self, medium => medium.coefficients(p))
    }

    #[inline]
    fn phase(&self, p: Vec3) -> AnyPhase<'_> {
        AnyPhase::One(match self {
            Self::Homogeneous(medium) => medium.phase(p),
            Self::Atmosphere(medium) => medium.phase(p),
            Self::Grid(medium) => medium.phase(p),
            Self::Sparse(medium) => medium.phase(p),
            Self::Field(medium) => medium.phase(p),
            Self::Overlap(medium) => return medium.phase(p),
        })
    }

    #[inline]
    fn transmittance(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        forward!(self, medium => medium.transmittance(ray, sampler))
    }

    #[inline]
    fn emitted(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        forward!(self, medium => medium.emitted(ray, sampler))
    }

    #[inline]
    fn sample_free_flight(
        &self,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<S> {
        forward!(self, medium => medium.sample_free_flight(ray, importance, sampler))
    }

    #[inline]
    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: S) -> f32 {
        forward!(self, medium => medium.pdf_free_flight(ray, t, importance))
    }

    #[inline]
    fn pmf_passing(&self, ray: &Ray, importance: S) -> f32 {
        forward!(self, medium => medium.pmf_passing(ray, importance))
    }

    #[inline]
    fn majorants(&self, ray: &Ray, visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        forward!(self, medium => medium.majorants(ray, visit));
    }

    #[inline]
    fn homogeneous(&self) -> Option<Coefficients<S>> {
        forward!(self, medium => medium.homogeneous())
    }
}
