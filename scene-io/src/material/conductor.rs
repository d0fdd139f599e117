//! Metals, on both sides.

use super::albedo::{Albedo, Rest};
use super::facets::{Behind, Facets, Pmf};
use super::fresnel::fresnel_conductor;
use tyndall_core::Spectrum;

/// Fresnel reflectance per channel.
pub(super) fn reflectance<S: Spectrum>(cos_theta: f32, eta: S, k: S) -> S {
    eta.zip(k, |eta, k| fresnel_conductor(cos_theta, eta, k))
}

/// Brushed or sandblasted metal: GGX facets with the complex Fresnel reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RoughConductor<S> {
    /// Real part of the index of refraction.
    pub(super) eta: S,
    /// Imaginary part.
    pub(super) k: S,
    /// Roughness α of the GGX distribution.
    pub(super) alpha: f32,
    /// 2∫F(μ)μdμ.
    mean_reflectance: S,
}

impl<S: Spectrum> RoughConductor<S> {
    pub(crate) fn new(eta: S, k: S, alpha: f32) -> Self {
        const POINTS: u16 = 256;
        // The midpoint rule in μ².
        let cosine = |i| ((f32::from(i) + 0.5) / f32::from(POINTS)).sqrt();
        let sum: S = (0..POINTS).map(|i| reflectance(cosine(i), eta, k)).sum();
        Self {
            eta,
            k,
            alpha,
            mean_reflectance: sum / f32::from(POINTS),
        }
    }

    /// Seen at this cosine to the normal.
    pub(super) fn seen(&self, cosine: f32) -> Seen<S> {
        let rest = Rest::trapped(Albedo::mirrors(self.alpha), cosine);
        Seen {
            metal: *self,
            rest,
            colour: rest.colour(self.mean_reflectance),
        }
    }
}

/// A rough metal seen from somewhere.
pub(super) struct Seen<S> {
    metal: RoughConductor<S>,
    rest: Rest,
    /// Of light that bounced between facets.
    colour: S,
}

impl<S: Spectrum> Facets<S> for Seen<S> {
    fn alpha(&self) -> f32 {
        self.metal.alpha
    }

    fn behind(&self) -> Behind {
        Behind::Nothing
    }

    fn eta(&self) -> f32 {
        1.0
    }

    fn colours(&self, cosine: f32, _: [f32; 2]) -> [S; 2] {
        [
            reflectance(cosine, self.metal.eta, self.metal.k),
            S::default(),
        ]
    }

    fn above(&self, cosine: f32) -> S {
        self.colour * self.rest.lobe(cosine)
    }

    fn below(&self, _: f32) -> S {
        S::default()
    }

    fn straight(&self) -> S {
        S::default()
    }

    fn pmf(&self) -> Pmf {
        Pmf {
            facets: 1.0 - self.rest.sent,
            above: self.rest.sent,
            ..Pmf::default()
        }
    }
}
