//! Smooth interfaces between transparent media.

use super::fresnel::{fresnel_dielectric, refracted_cosine};
use super::{discrete, reflect};
use glam::Vec3;
use tyndall_core::{BsdfSample, PathFrom, Spectrum};

/// Reflects with the Fresnel probability, refracts otherwise.
///
/// A path from the sensor gathers radiance, which refraction scales by (n_o/n_i)²; flux of a path
/// from a light is not scaled (Veach 1997, §5.2).
pub(super) fn sample<S: Spectrum>(wo: Vec3, u: f32, eta: f32, from: PathFrom) -> BsdfSample<S> {
    let eta = if wo.z > 0.0 { eta } else { 1.0 / eta };
    let reflectance = fresnel_dielectric(wo.z.abs(), eta);
    match refracted_cosine(wo.z.abs(), eta) {
        Some(cos_t) if u >= reflectance => {
            let wi = Vec3::new(-wo.x / eta, -wo.y / eta, -cos_t.copysign(wo.z));
            let weight = S::splat(radiance_scale(eta, from));
            BsdfSample {
                eta,
                ..discrete(wi.normalize(), weight)
            }
        }
        _ => discrete(reflect(wo), S::splat(1.0)),
    }
}

/// What refraction into index `eta` times the present one does to the carried quantity.
pub(super) fn radiance_scale(eta: f32, from: PathFrom) -> f32 {
    match from {
        PathFrom::Sensor => 1.0 / (eta * eta),
        PathFrom::Light => 1.0,
    }
}
