//! Rays, and what they connect.

use crate::{MediumId, Spectrum};
use glam::Vec3;

/// A ray segment: the points `origin + t·direction` for `t` in `[0, t_max]`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts; the host has already moved it off the surface it leaves.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Its length in scene units; may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// An infinite ray.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            t_max: f32::INFINITY,
        }
    }

    /// The same ray, ending at `t_max`.
    #[inline]
    #[must_use]
    pub fn up_to(self, t_max: f32) -> Self {
        Self { t_max, ..self }
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }
}

/// One end of a connection, or the vertex that a ray leaves.
#[derive(Clone, Copy, Debug)]
pub enum Anchor<Hit> {
    /// A point in a medium or in vacuum (a collision, the sensor, a point light).
    Point(Vec3),
    /// A point on a surface: the host knows how far to stay away.
    Surface(Hit),
    /// Infinitely far in this unit direction (a directional light, the background).
    Direction(Vec3),
}

/// A ray of the sensor.
#[derive(Clone, Copy, Debug)]
pub struct SensorRay<S> {
    /// From the sensor into the scene; infinite.
    pub ray: Ray,
    /// The pixel value is the mean of `weight` times the radiance arriving along the ray (lens,
    /// vignetting, reconstruction filter; negative in the lobes of a filter that has them).
    pub weight: S,
    /// The medium in which the ray starts.
    pub medium: MediumId,
    /// Density per steradian of the ray's direction over the whole film, in the unit of
    /// [`SensorConnection::pdf_w`]; 0 for a sensor that cannot be connected to.
    pub pdf_w: f32,
}

/// A connection from a point of the scene to the sensor, before visibility and transmittance.
#[derive(Clone, Copy, Debug)]
pub struct SensorConnection<S> {
    /// Where on the film, in pixels.
    pub raster: [f32; 2],
    /// Importance over density: `weight` times the radiance sent along `wi` (per unit throughput)
    /// is what the splat adds to the image. It holds every geometric factor at the sensor.
    pub weight: S,
    /// Unit vector from the point to the sensor.
    pub wi: Vec3,
    /// Distance to the point on the lens.
    pub distance: f32,
    /// Density per steradian, at the sensor, of the sensor's own ray through the point, over the
    /// whole film.
    pub pdf_w: f32,
}

impl<S: Spectrum> SensorRay<S> {
    /// A ray of weight one, of a sensor that cannot be connected to.
    pub fn new(ray: Ray, medium: MediumId) -> Self {
        Self {
            ray,
            weight: S::splat(1.0),
            medium,
            pdf_w: 0.0,
        }
    }
}
