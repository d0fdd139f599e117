//! Rough interfaces between transparent media (Walter et al. 2007).
//!
//! All formulas have `wo` above the surface and `eta` = n_below/n_above; a direction from below is
//! flipped first.

use super::dielectric::radiance_scale;
use super::fresnel::{fresnel_dielectric, refracted_cosine};
use super::{flip, ggx};
use glam::Vec3;
use tyndall_core::{BsdfSample, PathFrom, Spectrum};

/// The facet that sends `wo` to `wi`, found in `f64`: where it is seen edge-on, its cosines are
/// small differences, and both directions of a path must agree on them.
struct Facet {
    /// Unit normal, up.
    h: Vec3,
    /// Cosine to `wo`, positive.
    cos_o: f32,
    /// Cosine to `wi`, positive above and negative below.
    cos_i: f32,
}

impl Facet {
    /// `None` if no facet does (Walter et al., eq. 13 and 16).
    fn between(wo: Vec3, wi: Vec3, eta: f64) -> Option<Self> {
        let (o, i) = (wo.as_dvec3(), wi.as_dvec3());
        let h = if wi.z > 0.0 { o + i } else { o + eta * i };
        let h = h.try_normalize()?;
        let h = if h.z < 0.0 { -h } else { h };
        let facet = Self {
            h: h.as_vec3(),
            cos_o: o.dot(h) as f32,
            cos_i: i.dot(h) as f32,
        };
        (facet.cos_o > 0.0 && facet.cos_i * wi.z > 0.0).then_some(facet)
    }

    /// Fresnel transmittance: 1 − reflectance without its cancellation, and symmetric in both
    /// cosines, which Snell's law ties to each other.
    fn transmittance(&self, eta: f32) -> f32 {
        let (o, i) = (self.cos_o, -self.cos_i);
        let (p, s) = (eta * o + i, o + eta * i);
        2.0 * eta * o * i * (1.0 / (p * p) + 1.0 / (s * s))
    }

    /// dω_h/dω_i of refraction (Walter et al., eq. 17).
    fn refraction_jacobian(&self, eta: f32) -> f32 {
        let d = self.cos_o + eta * self.cos_i;
        eta * eta * self.cos_i.abs() / (d * d)
    }
}

/// The same directions and index with `wo` above.
fn upwards(wo: Vec3, wi: Vec3, eta: f32) -> (Vec3, Vec3, f64) {
    let eta = f64::from(eta);
    if wo.z > 0.0 {
        (wo, wi, eta)
    } else {
        (flip(wo), flip(wi), 1.0 / eta)
    }
}

/// Walter et al., eq. 20 and 21; refracted radiance as in [`radiance_scale`].
pub(super) fn eval(wo: Vec3, wi: Vec3, eta: f32, alpha: f32, from: PathFrom) -> f32 {
    if wo.z * wi.z == 0.0 {
        return 0.0;
    }
    let (wo, wi, eta) = upwards(wo, wi, eta);
    let Some(facet) = Facet::between(wo, wi, eta) else {
        return 0.0;
    };
    let eta = eta as f32;
    let dg = ggx::distribution(facet.h, alpha) * ggx::g2(wo, wi, alpha);
    if wi.z > 0.0 {
        return fresnel_dielectric(facet.cos_o, eta) * dg / (4.0 * wo.z * wi.z);
    }
    let transmittance = facet.transmittance(eta) * radiance_scale(eta, from);
    let jacobian = facet.refraction_jacobian(eta);
    transmittance * dg * jacobian * facet.cos_o / (wo.z * wi.z.abs())
}

/// Density per steradian of [`sample`].
pub(super) fn pdf_w(wo: Vec3, wi: Vec3, eta: f32, alpha: f32) -> f32 {
    if wo.z * wi.z == 0.0 {
        return 0.0;
    }
    let (wo, wi, eta) = upwards(wo, wi, eta);
    let Some(facet) = Facet::between(wo, wi, eta) else {
        return 0.0;
    };
    let eta = eta as f32;
    let visible = ggx::visible_pdf_w(wo, facet.h, alpha);
    if wi.z > 0.0 {
        fresnel_dielectric(facet.cos_o, eta) * visible / (4.0 * facet.cos_o)
    } else {
        facet.transmittance(eta) * visible * facet.refraction_jacobian(eta)
    }
}

/// A visible facet, then reflection or refraction by its Fresnel reflectance.
pub(super) fn sample<S: Spectrum>(
    wo: Vec3,
    u: [f32; 3],
    eta: f32,
    alpha: f32,
    from: PathFrom,
) -> Option<BsdfSample<S>> {
    if wo.z == 0.0 {
        return None;
    }
    let below = wo.z < 0.0;
    let (up, _, ratio) = upwards(wo, wo, eta);
    let ratio = ratio as f32;
    let h = ggx::sample_visible(up, alpha, [u[0], u[1]]);
    let cos = up.dot(h);
    if cos <= 0.0 {
        return None;
    }
    let refracted = refracted_cosine(cos, ratio).filter(|_| u[2] >= fresnel_dielectric(cos, ratio));
    let (wi, scale, leaves) = match refracted {
        None => {
            let wi = (2.0 * cos * h - up).normalize();
            (wi, 1.0, wi.z > 0.0)
        }
        Some(cos_t) => {
            let wi = ((cos / ratio - cos_t) * h - up / ratio).normalize();
            (wi, radiance_scale(ratio, from), wi.z < 0.0)
        }
    };
    let weight = scale * ggx::g2(up, wi, alpha) / ggx::g1(up, alpha);
    let wi = if below { flip(wi) } else { wi };
    let pdf_w = pdf_w(wo, wi, eta, alpha);
    (leaves && pdf_w > 0.0).then(|| BsdfSample {
        wi,
        weight: S::splat(weight),
        pdf_w,
        delta: false,
        eta: if refracted.is_some() { ratio } else { 1.0 },
    })
}
