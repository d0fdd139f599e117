//! A laser in a medium, seen from the side.

use super::{AnalyticHost, Boundary, Light, View};
use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{Medium, Ray, Spectrum};

/// A collimated beam along +x from a disc at the origin, seen by an orthographic row of pixels
/// across it (along y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// W in every channel.
    pub flux: f32,
    /// Of the beam, scene units.
    pub radius: f32,
    /// Cosine between the directions of the beam and of the sensor's rays.
    pub cos_theta: f32,
    /// From the origin of the middle ray to the axis of the beam (t₀).
    pub distance: f32,
    /// From the start of the beam to where the middle ray meets its axis (v₀).
    pub along: f32,
    /// Half the length of the row, at least `radius`.
    pub half_width: f32,
    /// Pixels of the row.
    pub pixels: u32,
}

impl Laser {
    /// Length of the row that a pixel covers.
    pub fn pixel_width(&self) -> f32 {
        2.0 * self.half_width / self.pixels as f32
    }
}

impl<M: Medium> AnalyticHost<M> {
    /// A laser in an infinite medium.
    ///
    /// What is known, for a homogeneous medium and single scattering alone: the sum of the pixels
    /// times [`Laser::pixel_width`] is
    /// [`laser_row_sum`](crate::closed_form::laser_row_sum), for any radius, and for any blur of an
    /// estimator that stays within the row.
    ///
    /// # Panics
    /// If a length is not positive, the cosine not in (−1, 1), the row narrower than the beam, or
    /// if the sensor looks past the start of the beam.
    pub fn laser(medium: M, laser: Laser) -> Self {
        let Laser {
            radius,
            cos_theta,
            distance,
            along,
            half_width,
            ..
        } = laser;
        let lengths = [radius, distance, along, half_width];
        assert!(
            lengths.iter().all(|l| *l > 0.0 && l.is_finite()),
            "{laser:?}: lengths must be positive and finite"
        );
        assert!(
            cos_theta.abs() < 1.0,
            "cos_theta {cos_theta}: give one in (−1, 1)"
        );
        assert!(half_width >= radius, "{laser:?}: the row misses the beam");
        let sin_theta = (1.0 - cos_theta * cos_theta).sqrt();
        assert!(
            along * sin_theta > radius * cos_theta.abs() && distance * sin_theta > radius,
            "{laser:?}: the row sees the start of the beam, or starts in it; move it away"
        );
        let direction = Vec3::new(cos_theta, 0.0, sin_theta);
        let middle = Vec3::new(along, 0.0, 0.0) - distance * direction;
        Self {
            boundary: Boundary::Nowhere,
            medium,
            light: Light::Beam {
                center: Vec3::ZERO,
                direction: Vec3::X,
                radius,
                irradiance: M::Spectrum::splat(laser.flux / (PI * radius * radius)),
            },
            view: View::Row {
                first: Ray::new(middle - half_width * Vec3::Y, direction),
                edge: 2.0 * half_width * Vec3::Y,
                pixels: laser.pixels,
            },
        }
    }
}
