//! Maps from the unit square to directions and discs, with their densities.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// Uniform on the unit sphere; density 1/(4π) per steradian.
#[inline]
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    polar(1.0 - 2.0 * u[0], u[1])
}

/// Uniform in the cone around +z whose half angle has cosine `1 − height`; density 1/(2π·height)
/// per steradian. Taking the height instead of the cosine keeps narrow cones exact.
#[inline]
pub fn uniform_cone(height: f32, u: [f32; 2]) -> Vec3 {
    let h = height * u[0];
    let sin = (h * (2.0 - h)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    Vec3::new(sin * cos_phi, sin * sin_phi, 1.0 - h)
}

/// Proportional to the cosine on the hemisphere of +z; density [`cosine_hemisphere_pdf_w`].
#[inline]
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let d = disk(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// cos θ / π, zero below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf_w(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Uniform in the unit disc, density 1/π: the concentric map of Shirley & Chiu (1997).
#[inline]
pub fn disk(u: [f32; 2]) -> Vec2 {
    let p = Vec2::new(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if p == Vec2::ZERO {
        return p;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (p.x / p.y))
    };
    let (sin, cos) = phi.sin_cos();
    r * Vec2::new(cos, sin)
}

/// The unit vector with cosine `cos_theta` to +z at azimuth 2π`u`.
#[inline]
pub fn polar(cos_theta: f32, u: f32) -> Vec3 {
    let sin = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * u).sin_cos();
    Vec3::new(sin * cos_phi, sin * sin_phi, cos_theta)
}
