//! The estimators over photon beams: what a ray of sight, or a point of one, takes of a beam.
//!
//! Each is a choice of data, query and blur (Jarosz et al. 2011a, §5) and a file of its own. All
//! say where the two meet, and with what weight:
//!
//! ```text
//! L = Σ σs(x_t) p(wo, −w) Φ Tr_e(t) Tr_b(v) · weight
//! ```
//!
//! A weight is the kernel, 1/unitᵈ, times what is left to integrate over, of which one place is
//! chosen by `u`: evenly, or as light fades in a homogeneous medium. That place is a sample: it makes
//! the estimate right in media where transmittance has no closed form, and in expectation equal to
//! the integral everywhere.

mod beam_beam_1d;
mod beam_beam_2d_beam;
mod beam_beam_2d_ray;
mod beam_beam_3d;
mod beam_point_2d;
mod beam_point_3d;

pub use beam_beam_1d::BeamBeam1D;
pub use beam_beam_2d_beam::BeamBeam2DBeam;
pub use beam_beam_2d_ray::BeamBeam2DRay;
pub use beam_beam_3d::BeamBeam3D;
pub use beam_point_2d::BeamPoint2D;
pub use beam_point_3d::BeamPoint3D;

use tyndall_density::{Kernel, Lines};

/// Where a query and a beam meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Distance along the ray of sight; 0 if the query is a point.
    pub t: f64,
    /// Distance along the beam.
    pub v: f64,
    /// Kernel times measure, in 1/unit: see the module.
    pub weight: f64,
}

/// A ray of sight, or a point of it, and a piece of a beam.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Their lines. If the query is a point, the ray starts there.
    pub lines: &'a Lines,
    /// Where the ray ends; may be infinite.
    pub t_max: f64,
    /// The piece: distances along the beam, the second excluded.
    pub piece: [f64; 2],
    /// How wide the beam is.
    pub cone: Cone,
    /// How photons are weighted by their distance.
    pub kernel: Kernel,
    /// Extinction along ray and beam, 1/unit, by which places are chosen in what is integrated over: 0
    /// to choose evenly.
    pub sigma_t: [f64; 2],
}

/// The radius of a beam, linear in the distance along it, within limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// At the start, in scene units.
    pub start: f64,
    /// What it grows by per unit; may be negative. Behind a focus the radius is, but its size counts.
    pub growth: f64,
    /// The least and the most of it.
    pub limits: [f64; 2],
}

impl Cone {
    /// The radius at a distance.
    #[inline]
    pub fn radius(&self, v: f64) -> f64 {
        let [least, most] = self.limits;
        (self.start + self.growth * v).abs().clamp(least, most)
    }

    /// The largest radius over a piece.
    #[inline]
    pub fn largest(&self, [start, end]: [f64; 2]) -> f64 {
        self.radius(start).max(self.radius(end))
    }
}

/// One way to let a query meet a beam.
pub trait Estimator {
    /// Whether the query is a whole ray; if not it is a point, and `t` is 0.
    const BY_RAYS: bool;
    /// Over how many dimensions a beam is blurred.
    const BLUR: u8;

    /// A meeting, if there is one; `u` in \[0, 1)² chooses the place in what is integrated over.
    fn meet(pair: &Pair<'_>, u: [f32; 2]) -> Option<Meeting>;
}

/// What two stretches share, if it is more than a point.
#[inline]
fn overlap(a: [f64; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let both = [a[0].max(b[0]), a[1].min(b[1])];
    (both[0] < both[1]).then_some(both)
}

/// A place x of a stretch and the inverse of its density there, which is ∝ e^(−rate·x): over the
/// length, (1 − e^−κ)/κ · e^(κ y) for κ = rate × length and the place at y of the length. Even, for a
/// stretch without end.
#[inline]
fn place([start, end]: [f64; 2], rate: f64, u: f32) -> [f64; 2] {
    let (length, u) = (end - start, f64::from(u));
    let depth = rate * length;
    if depth < EVEN {
        return [start + u * length, length];
    }
    let through = -(-depth).exp_m1();
    let passed = -(-u * through).ln_1p();
    let inverse = through * passed.exp() / rate;
    [(start + passed / rate).min(end), inverse]
}

/// Optical depth of a stretch so short that all its places are as bright.
const EVEN: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    /// Means over u of weight times any function are its integrals.
    #[test]
    fn places_are_weighted_by_the_inverse_of_their_density() {
        for (rate, length) in [(0.0, 3.0), (1e-4, 3.0), (0.7, 3.0), (40.0, 3.0), (1e6, 1.0)] {
            let steps = 100_000;
            let mean = |f: fn(f64, f64) -> f64| {
                let at = |i: i32| {
                    let u = (i as f32 + 0.5) / steps as f32;
                    let [x, inverse] = place([2.0, 2.0 + length], rate, u);
                    assert!((2.0..=2.0 + length).contains(&x) && inverse.is_finite());
                    inverse * f(rate, x - 2.0)
                };
                (0..steps).map(at).sum::<f64>() / f64::from(steps)
            };
            let fading = mean(|rate, x| (-rate * x).exp());
            let depth: f64 = rate * length;
            let expected = if depth == 0.0 {
                length
            } else {
                -(-depth).exp_m1() / rate
            };
            // Uniform numbers of 24 bits are all that errs where the density is exact.
            assert!(
                (fading / expected - 1.0).abs() < 1e-4,
                "{rate}: {fading} {expected}"
            );
            if depth < 3.0 {
                let all = mean(|_, _| 1.0);
                assert!((all / length - 1.0).abs() < 1e-4, "{rate}: {all}");
            }
        }
    }
}
