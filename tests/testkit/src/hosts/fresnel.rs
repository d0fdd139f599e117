//! Smooth dielectric boundaries.

use glam::Vec3;
use tyndall_core::{BsdfSample, PathFrom, Spectrum};

/// Fresnel reflectance of unpolarised light at a smooth dielectric, and the cosine of the refracted
/// direction; (1, 0) beyond the critical angle.
///
/// `cos_theta` ≥ 0 is the cosine of incidence, `eta` the index behind the boundary over the index
/// before it. Born & Wolf (1999), §1.5.2.
///
/// ```
/// use tyndall_testkit::hosts::fresnel;
/// let (reflectance, cosine) = fresnel(1.0, 1.5);
/// assert!((reflectance - 0.04).abs() < 1e-6 && cosine == 1.0);
/// assert_eq!(fresnel(0.5, 1.0 / 1.5), (1.0, 0.0)); // 60°, critical is 41.8°
/// ```
pub fn fresnel(cos_theta: f32, eta: f32) -> (f32, f32) {
    let squared = 1.0 - (1.0 - cos_theta * cos_theta) / (eta * eta);
    if squared <= 0.0 {
        return (1.0, 0.0);
    }
    let refracted = squared.sqrt();
    let parallel = (eta * cos_theta - refracted) / (eta * cos_theta + refracted);
    let perpendicular = (cos_theta - eta * refracted) / (cos_theta + eta * refracted);
    let reflectance = 0.5 * (parallel * parallel + perpendicular * perpendicular);
    (reflectance, refracted)
}

/// Reflects with the probability of the reflectance, refracts otherwise. L/n² is what a lossless
/// boundary preserves, so radiance gathered from behind it is scaled by 1/eta² (Veach 1997, §5.2).
pub(super) fn sample<S: Spectrum>(
    normal: Vec3,
    index: f32,
    wo: Vec3,
    u: f32,
    from: PathFrom,
) -> BsdfSample<S> {
    let outside = wo.dot(normal) > 0.0;
    let (normal, eta) = if outside {
        (normal, index)
    } else {
        (-normal, 1.0 / index)
    };
    let cos_theta = wo.dot(normal);
    let (reflectance, refracted) = fresnel(cos_theta, eta);
    let reflects = u < reflectance;
    let (wi, scale, eta) = if reflects {
        (2.0 * cos_theta * normal - wo, 1.0, 1.0)
    } else {
        let wi = (cos_theta * normal - wo) / eta - refracted * normal;
        let scale = match from {
            PathFrom::Sensor => 1.0 / (eta * eta),
            PathFrom::Light => 1.0,
        };
        (wi, scale, eta)
    };
    BsdfSample {
        wi: wi.normalize(),
        weight: S::splat(scale),
        pdf_w: 0.0,
        delta: true,
        eta,
    }
}
