//! Reflectance of plane interfaces for unpolarised light.

/// Reflectance of a dielectric interface.
///
/// `cos_theta` ≥ 0 is the cosine on the side the light comes from; `eta` the index of refraction
/// behind the interface over that before it. 1 beyond the critical angle. Exact (Fresnel 1823).
///
/// ```
/// use tyndall_scene_io::fresnel_dielectric;
/// assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-6); // ((η − 1)/(η + 1))²
/// assert_eq!(fresnel_dielectric(0.5, 1.0 / 1.5), 1.0); // 60° is beyond 41.8°
/// ```
pub fn fresnel_dielectric(cos_theta: f32, eta: f32) -> f32 {
    let Some(cos_t) = refracted_cosine(cos_theta, eta) else {
        return 1.0;
    };
    let parallel = (eta * cos_theta - cos_t) / (eta * cos_theta + cos_t);
    let perpendicular = (cos_theta - eta * cos_t) / (cos_theta + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Cosine of the refracted direction by Snell's law; `None` beyond the critical angle.
pub(super) fn refracted_cosine(cos_theta: f32, eta: f32) -> Option<f32> {
    let sin2_t = (1.0 - cos_theta * cos_theta).max(0.0) / (eta * eta);
    (sin2_t < 1.0).then(|| (1.0 - sin2_t).sqrt())
}

/// Reflectance of a metal whose index of refraction is `eta` + i `k` over that before it.
///
/// `cos_theta` ≥ 0 is the cosine of incidence. Exact, after Born & Wolf (1999), §14.2.
///
/// ```
/// use tyndall_scene_io::fresnel_conductor;
/// // ((η − 1)² + k²)/((η + 1)² + k²) at normal incidence
/// assert!((fresnel_conductor(1.0, 0.2, 3.9) - 15.85 / 16.65).abs() < 1e-5);
/// ```
pub fn fresnel_conductor(cos_theta: f32, eta: f32, k: f32) -> f32 {
    let cos2 = cos_theta * cos_theta;
    let sin2 = (1.0 - cos2).max(0.0);
    let t0 = eta * eta - k * k - sin2;
    let a2_plus_b2 = t0.hypot(2.0 * eta * k);
    let a = (0.5 * (a2_plus_b2 + t0)).max(0.0).sqrt();
    let t1 = a2_plus_b2 + cos2;
    let t2 = 2.0 * a * cos_theta;
    let perpendicular = (t1 - t2) / (t1 + t2);
    let t3 = cos2 * a2_plus_b2 + sin2 * sin2;
    let t4 = t2 * sin2;
    let parallel = perpendicular * (t3 - t4) / (t3 + t4);
    0.5 * (perpendicular + parallel)
}
