//! The phase function of Henyey and Greenstein.

use super::exact;
use crate::MediumError;
use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{Frame, PhaseFunction, PhaseSample, warp};

/// p(θ) = (1 − g²) / (4π (1 + g² − 2g cos θ)^{3/2}), Henyey & Greenstein (1941).
///
/// # Precision
/// With a = 1 − |g| and h the height 1 ∓ cos θ of the direction below the pole of the lobe, the
/// parenthesis is a² + 2|g|h. Neither form subtracts, and h comes from the sum of the directions
/// (|wo + wi|²/2), so the peak is right to a few 1e-4 even at |g| = 0.999, where it is a
/// thousandth of a radian wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// The lobe whose mean cosine is `g`; positive is forward.
    ///
    /// # Errors
    /// [`MediumError::Asymmetry`] unless |`g`| ≤ 0.999: beyond that, directions in `f32` no longer
    /// resolve the peak.
    pub fn new(g: f32) -> Result<Self, MediumError> {
        if g.abs() <= 0.999 {
            Ok(Self { g })
        } else {
            Err(MediumError::Asymmetry { g })
        }
    }

    /// The pole of the lobe.
    #[inline]
    fn pole(&self, wo: Vec3) -> Vec3 {
        if self.g < 0.0 { wo } else { -wo }
    }

    /// The density in terms of r = √(a² + 2|g|h).
    #[inline]
    fn density(&self, r: f32) -> f32 {
        let g = self.g.abs();
        (1.0 - g) * (1.0 + g) / (4.0 * PI * r * r * r)
    }
}

impl PhaseFunction for HenyeyGreenstein {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        let g = self.g.abs();
        let a = 1.0 - g;
        let height = 0.5 * (wi - self.pole(wo)).length_squared();
        self.density((a * a + 2.0 * g * height).sqrt())
    }

    /// Inverts the cumulative distribution for the height instead of the cosine: with
    /// q = a + 2|g|(1 − u), h = 2a²u (1 + |g|(1 − u)) / q² and r = a (1 + |g|) / q; no 0/0 at g = 0.
    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        let g = self.g.abs();
        let a = 1.0 - g;
        let rest = 1.0 - u[0];
        let q = a + 2.0 * g * rest;
        let b = a / q;
        let height = (2.0 * b * b * u[0] * (1.0 + g * rest)).min(2.0);
        let local = warp::uniform_cone(height, [1.0, u[1]]);
        let wi = Frame::around(self.pole(wo)).to_world(local);
        exact(wi, self.density(b * (1.0 + g)))
    }

    fn mean_cosine(&self) -> f32 {
        self.g
    }
}
