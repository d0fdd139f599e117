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
//! chosen uniformly by `u`. That place is a sample: it makes the estimate right in media where
//! transmittance has no closed form, and in expectation equal to the integral everywhere.

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

/// A place of a stretch, and its length.
#[inline]
fn place([start, end]: [f64; 2], u: f32) -> [f64; 2] {
    let length = end - start;
    [start + f64::from(u) * length, length]
}
