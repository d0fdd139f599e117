//! Hosts whose light is known in closed form.
//!
//! One [`AnalyticHost`] holds a [`Boundary`], a medium, a [`Light`] and a [`View`]; its
//! constructors are the scenes of the literature, and state what the sensor then measures.
//!
//! | host | known |
//! |---|---|
//! | [`AnalyticHost::infinite_medium`] | fluence and airlight of a point light |
//! | [`AnalyticHost::slab`] | reflectance, transmittance, angular radiance; half space |
//! | [`AnalyticHost::furnace`] | 1 everywhere |
//! | [`AnalyticHost::sphere`] | emission only; transmittance; caustics of a glass ball |
//! | [`AnalyticHost::laser`] | row sum of single scattering |
//!
//! They carry no meshes and any [`Medium`], so they test a medium or an integrator alone. Fields
//! are public: replace a part to get another scene.

mod boundary;
mod capabilities;
mod fresnel;
mod infinite_medium;
mod laser;
mod light;
mod slab;
mod sphere;
mod view;

pub use boundary::{Boundary, BoundaryHit, Interface};
pub use fresnel::fresnel;
pub use laser::Laser;
pub use light::Light;
pub use slab::Exitant;
pub use view::View;

use tyndall_core::{Medium, MediumId};

/// A medium with analytic boundaries, one light and one sensor.
#[derive(Clone, Debug)]
pub struct AnalyticHost<M: Medium> {
    /// What separates the medium from the vacuum outside.
    pub boundary: Boundary,
    /// What fills the inside.
    pub medium: M,
    /// What lights it.
    pub light: Light<M::Spectrum>,
    /// What is measured.
    pub view: View,
}

/// The id of the one medium.
const INSIDE: MediumId = MediumId(1);
