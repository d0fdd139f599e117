//! Spheres filled with a medium.

use super::{AnalyticHost, Boundary, Interface, Light, View};
use tyndall_core::{Medium, Spectrum};

impl<M: Medium> AnalyticHost<M> {
    /// A sphere around the origin, filled with `medium`: with [`Interface::Dielectric`] a glass
    /// ball.
    ///
    /// What is known: with a matched boundary and a medium that absorbs and emits alone, a chord of
    /// length d shows [`emission_only`](crate::closed_form::emission_only) of σa d, over a
    /// background seen through exp(−σa d). In vacuum a glass ball of index n focuses an axial ray
    /// at n/(2(n − 1)) radii from its middle (the thick lens; Born & Wolf
    /// 1999, §4.4).
    ///
    /// # Panics
    /// If the radius is not positive and finite, or the index not above 0.
    pub fn sphere(
        medium: M,
        radius: f32,
        interface: Interface,
        light: Light<M::Spectrum>,
        view: View,
    ) -> Self {
        assert!(
            radius > 0.0 && radius.is_finite(),
            "radius {radius}: give a finite length"
        );
        if let Interface::Dielectric(index) = interface {
            assert!(
                index > 0.0 && index.is_finite(),
                "index of refraction {index}: give a positive number"
            );
        }
        Self {
            boundary: Boundary::Sphere { radius, interface },
            medium,
            light,
            view,
        }
    }

    /// [`AnalyticHost::sphere`] in a background of radiance 1.
    ///
    /// What is known: if the medium absorbs nothing, radiance is 1 everywhere outside and n²
    /// inside, whatever σs, phase function and heterogeneity, because L/n² is preserved along every
    /// ray (the white furnace). Each sample has this value too, up to the estimator's own noise.
    ///
    /// # Panics
    /// As [`AnalyticHost::sphere`].
    pub fn furnace(medium: M, radius: f32, interface: Interface, view: View) -> Self {
        let light = Light::Background {
            radiance: M::Spectrum::splat(1.0),
            reach: 1.01 * radius,
        };
        Self::sphere(medium, radius, interface, light, view)
    }
}
