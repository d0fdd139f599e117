//! Equiangular sampling: points on a segment with a density proportional to the inverse squared
//! distance from a pivot, so that a light at the pivot contributes evenly.
//!
//! Christopher Kulla and Marcos Fajardo (2012), "Importance Sampling Techniques for Path Tracing in
//! Participating Media", §4. Deviations: computed in `f64`, since the angles of a pivot far away
//! (or of a long segment) cancel in `f32`; the distance of the pivot from the line is floored at
//! 1e-6 of the larger of its distance and the length of the segment, where the density would
//! otherwise degenerate to a spike.

use glam::Vec3;
use tyndall_core::Ray;

/// Lengths below this are taken for it, so that densities stay finite in `f32`.
const SHORTEST: f64 = 1e-30;

/// The distribution of distances along one segment, for one pivot.
///
/// ```
/// use glam::Vec3;
/// use tyndall_core::Ray;
/// use tyndall_walk::equiangular::Equiangular;
/// // A pivot one unit beside the middle of a segment of length 2: angles from −45° to 45°.
/// let ray = Ray::new(Vec3::ZERO, Vec3::X).up_to(2.0);
/// let d = Equiangular::new(&ray, Vec3::new(1.0, 1.0, 0.0));
/// assert!((d.sample(0.5) - 1.0).abs() < 1e-6);
/// assert!((d.pdf_t(1.0) - 2.0 / std::f32::consts::PI).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Equiangular {
    /// Distance along the ray of the point nearest to the pivot.
    foot: f64,
    /// Distance of the pivot from the line, floored.
    height: f64,
    /// Angle of the start of the segment seen from the pivot, and the angle that it spans.
    start: f64,
    span: f64,
    length: f64,
}

impl Equiangular {
    /// For the points `t` in `[0, ray.t_max]`; `t_max` may be infinite.
    pub fn new(ray: &Ray, pivot: Vec3) -> Self {
        let to_pivot = (pivot - ray.origin).as_dvec3();
        let direction = ray.direction.as_dvec3();
        let foot = to_pivot.dot(direction);
        let length = f64::from(ray.t_max);
        let scale = if length.is_finite() { length } else { 0.0 };
        let floor = (1e-6 * scale.max(to_pivot.length())).max(SHORTEST);
        let height = (to_pivot - foot * direction).length().max(floor);
        let start = (-foot).atan2(height);
        // The angle between two directions from their cross and dot products: no cancellation.
        let span = if length.is_finite() {
            (length * height).atan2(height * height - foot * (length - foot))
        } else {
            std::f64::consts::FRAC_PI_2 - start
        };
        Self {
            foot,
            height,
            start,
            span,
            length,
        }
    }

    /// The distance for `u` in \[0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        let t = self.foot + self.height * (self.start + f64::from(u) * self.span).tan();
        t.clamp(0.0, self.length) as f32
    }

    /// Density per scene unit at `t`: h / (span·(h² + (t − foot)²)); zero for an empty segment.
    #[inline]
    pub fn pdf_t(&self, t: f32) -> f32 {
        if self.span <= 0.0 {
            return 0.0;
        }
        let along = f64::from(t) - self.foot;
        (self.height / (self.span * (self.height * self.height + along * along))) as f32
    }
}
