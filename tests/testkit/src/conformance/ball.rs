//! What is around the ball that integrators are tested on.

use crate::hosts::{Light, View};
use glam::Vec3;
use tyndall_core::Spectrum;

/// A picture of a ball of radius `scale` around the origin, for hosts of
/// [`integrator_conformance!`](crate::integrator_conformance).
pub fn view(scale: f32) -> View {
    View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -3.0 * scale),
        forward: Vec3::Z,
        half_width: 0.5,
        pixels: 20,
    }
}

/// A lamp beside that ball, whose radiance does not depend on the scale: its flux grows with the
/// area. It is only seen once it is scattered.
pub fn lamp<S: Spectrum>(scale: f32) -> Light<S> {
    Light::Point {
        position: Vec3::new(0.5, 2.0, 0.3) * scale,
        power: S::splat(30.0 * scale * scale),
    }
}
