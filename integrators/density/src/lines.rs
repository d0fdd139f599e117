//! A ray of sight and a photon beam: where their lines pass each other.

use glam::{DVec3, Vec3};
use tyndall_core::Ray;

/// The line of a ray of sight, O₁ + t d₁, and that of a photon beam, O₂ + v d₂, in `f64`.
///
/// All distances come from the difference w = O₂ − O₁, formed first, and from the cross product
/// n = d₁ × d₂, |n| = sin θ: nothing is lost where scenes are far from the origin or lines almost
/// parallel. Errors are those of the `f32` that places are given in, and 1e-16 |w| / sin θ.
///
/// ```
/// use glam::Vec3;
/// use tyndall_core::Ray;
/// use tyndall_density::Lines;
/// let ray = Ray::new(Vec3::new(1000.0, 0.0, 0.0), Vec3::Z);
/// let lines = Lines::new(&ray, Vec3::new(998.0, 0.25, 3.0), Vec3::X);
/// assert_eq!(lines.closest(), Some([3.0, 2.0]));
/// assert_eq!((lines.distance(), lines.sin_theta()), (0.25, 1.0));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Lines {
    w: DVec3,
    ray: DVec3,
    beam: DVec3,
    normal: DVec3,
    cos_theta: f64,
    sin_theta: f64,
    /// 1/sin² θ; infinite for parallel lines.
    inverse: f64,
}

impl Lines {
    /// Of a ray, and of a beam from `origin` along the unit vector `direction`.
    #[inline]
    pub fn new(ray: &Ray, origin: Vec3, direction: Vec3) -> Self {
        let [d1, d2] = [ray.direction, direction].map(|d| unit(d.as_dvec3()));
        let normal = d1.cross(d2);
        let sin2_theta = normal.length_squared();
        Self {
            w: origin.as_dvec3() - ray.origin.as_dvec3(),
            ray: d1,
            beam: d2,
            normal,
            cos_theta: d1.dot(d2),
            sin_theta: sin2_theta.sqrt(),
            inverse: 1.0 / sin2_theta,
        }
    }

    /// Sine of the angle between them.
    #[inline]
    pub fn sin_theta(&self) -> f64 {
        self.sin_theta
    }

    /// Its cosine.
    #[inline]
    pub fn cos_theta(&self) -> f64 {
        self.cos_theta
    }

    /// `[t, v]` of the two points that are closest to each other; `None` if the lines are parallel.
    ///
    /// t = (w × d₂)·n / sin² θ and v = (w × d₁)·n / sin² θ.
    #[inline]
    pub fn closest(&self) -> Option<[f64; 2]> {
        let across = |d| self.w.cross(d).dot(self.normal) * self.inverse;
        (self.sin_theta > 0.0).then(|| [across(self.beam), across(self.ray)])
    }

    /// How far they are from each other where they are closest.
    #[inline]
    pub fn distance(&self) -> f64 {
        if self.sin_theta > 0.0 {
            self.w.dot(self.normal).abs() * (self.sin_theta * self.inverse)
        } else {
            self.w.cross(self.beam).length()
        }
    }

    /// Squared distance of the point at `t` of the ray from that at `v` of the beam.
    #[inline]
    pub fn distance_squared(&self, t: f64, v: f64) -> f64 {
        (self.w + v * self.beam - t * self.ray).length_squared()
    }

    /// v of the point of the beam's line closest to that at `t` of the ray.
    #[inline]
    pub fn beam_foot(&self, t: f64) -> f64 {
        t * self.cos_theta - self.beam.dot(self.w)
    }

    /// t of the point of the ray's line closest to that at `v` of the beam.
    #[inline]
    pub fn ray_foot(&self, v: f64) -> f64 {
        v * self.cos_theta + self.ray.dot(self.w)
    }

    /// The stretch of the ray's line within `radius` of the beam's.
    pub fn ray_chord(&self, radius: f64) -> Option<[f64; 2]> {
        self.chord(radius, 0)
    }

    /// The stretch of the beam's line within `radius` of the ray's.
    pub fn beam_chord(&self, radius: f64) -> Option<[f64; 2]> {
        self.chord(radius, 1)
    }

    fn chord(&self, radius: f64, of: usize) -> Option<[f64; 2]> {
        let distance = self.distance();
        let across = (radius - distance) * (radius + distance);
        if across.is_nan() || across <= 0.0 {
            return None;
        }
        Some(match self.closest() {
            None => [f64::NEG_INFINITY, f64::INFINITY],
            Some(closest) => {
                let half = across.sqrt() / self.sin_theta;
                [closest[of] - half, closest[of] + half]
            }
        })
    }

    /// The stretch of the ray's line whose feet on the beam's lie in `[start, end]`.
    pub fn ray_between(&self, [start, end]: [f64; 2]) -> Option<[f64; 2]> {
        let foot = self.beam_foot(0.0);
        between([start - foot, end - foot], self.cos_theta)
    }

    /// The stretch of the beam's line whose feet on the ray's lie in `[start, end]`.
    pub fn beam_between(&self, [start, end]: [f64; 2]) -> Option<[f64; 2]> {
        let foot = self.ray_foot(0.0);
        between([start - foot, end - foot], self.cos_theta)
    }
}

/// All x for which x·slope is in a range.
fn between([low, high]: [f64; 2], slope: f64) -> Option<[f64; 2]> {
    if slope == 0.0 {
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        return (low <= 0.0 && 0.0 <= high).then_some(everywhere);
    }
    let ends = [low / slope, high / slope];
    Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
}

/// A vector scaled to length 1. Those that are so to the digits of `f32` need neither a root nor a
/// division: with |d|² = 1 + e, the first terms of 1/√(1 + e) leave 5/16 e³.
#[inline]
fn unit(d: DVec3) -> DVec3 {
    let e = d.length_squared() - 1.0;
    if e.abs() < 1e-6 {
        d * (1.0 - e * (0.5 - 0.375 * e))
    } else {
        d.normalize()
    }
}
