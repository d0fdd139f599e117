//! A medium everywhere, and a point light in it.

use super::{AnalyticHost, Boundary, Light, View};
use glam::Vec3;
use tyndall_core::Medium;

impl<M: Medium> AnalyticHost<M> {
    /// One medium everywhere and an isotropic point light of `power` W at `position`.
    ///
    /// What is known, for a homogeneous isotropic medium and 1 W:
    /// - [`View::Rays`], single scattering alone:
    ///   [`airlight`](crate::closed_form::airlight);
    /// - [`View::Fluence`] at distance r, all orders:
    ///   [`point_source_fluence`](crate::closed_form::point_source_fluence), from which a sensor
    ///   misses the uncollided part exp(−σt r)/(4π r²), since no ray hits a point.
    pub fn infinite_medium(medium: M, position: Vec3, power: M::Spectrum, view: View) -> Self {
        Self {
            boundary: Boundary::Nowhere,
            medium,
            light: Light::Point { position, power },
            view,
        }
    }
}
