//! The GGX distribution of microfacets, isotropic, seen from above (z > 0).
//!
//! Walter, Marschner, Li & Torrance (2007), "Microfacet Models for Refraction through Rough
//! Surfaces"; visible normals after Heitz (2018), "Sampling the GGX Distribution of Visible
//! Normals". Light that bounces between facets is not part of it: see [`super::albedo`].

use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// Distribution of normals D per steradian (Walter et al., eq. 33).
pub(super) fn distribution(h: Vec3, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let e = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
    FRAC_1_PI / (a2 * e * e)
}

/// Smith's Λ (Heitz 2014, eq. 72).
fn lambda(v: Vec3, alpha: f32) -> f32 {
    let tan2 = (v.x * v.x + v.y * v.y) / (v.z * v.z);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Share of the facets that `v` sees.
pub(super) fn g1(v: Vec3, alpha: f32) -> f32 {
    1.0 / (1.0 + lambda(v, alpha))
}

/// Share of the facets that both see, correlated by height (Heitz 2014, eq. 99); used for
/// refraction too.
pub(super) fn g2(wo: Vec3, wi: Vec3, alpha: f32) -> f32 {
    1.0 / (1.0 + lambda(wo, alpha) + lambda(wi, alpha))
}

/// Density per steradian of [`sample_visible`].
pub(super) fn visible_pdf_w(wo: Vec3, h: Vec3, alpha: f32) -> f32 {
    g1(wo, alpha) * wo.dot(h).max(0.0) * distribution(h, alpha) / wo.z
}

/// A normal among those that `wo` sees (Heitz 2018, listing 1).
pub(super) fn sample_visible(wo: Vec3, alpha: f32, u: [f32; 2]) -> Vec3 {
    let v = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let length2 = v.x * v.x + v.y * v.y;
    let t1 = if length2 > 0.0 {
        Vec3::new(-v.y, v.x, 0.0) / length2.sqrt()
    } else {
        Vec3::X
    };
    let t2 = v.cross(t1);
    let r = u[0].sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let p1 = r * cos;
    let s = 0.5 * (1.0 + v.z);
    let p2 = (1.0 - s) * (1.0 - p1 * p1).max(0.0).sqrt() + s * r * sin;
    let p3 = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
    let n = p1 * t1 + p2 * t2 + p3 * v;
    Vec3::new(alpha * n.x, alpha * n.y, n.z.max(1e-6)).normalize()
}
