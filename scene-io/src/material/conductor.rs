//! Rough metals: GGX facets with the complex Fresnel reflectance, on both sides.

use super::fresnel::fresnel_conductor;
use super::{flip, ggx, same_side};
use glam::Vec3;
use tyndall_core::{BsdfSample, Spectrum};

/// Fresnel reflectance per channel.
pub(super) fn reflectance<S: Spectrum>(cos_theta: f32, eta: S, k: S) -> S {
    eta.zip(k, |eta, k| fresnel_conductor(cos_theta, eta, k))
}

fn upwards(wo: Vec3, wi: Vec3) -> (Vec3, Vec3) {
    if wo.z > 0.0 {
        (wo, wi)
    } else {
        (flip(wo), flip(wi))
    }
}

/// F D G / (4 cos θo cos θi), Walter et al. (2007), eq. 20.
pub(super) fn eval<S: Spectrum>(wo: Vec3, wi: Vec3, eta: S, k: S, alpha: f32) -> S {
    if !same_side(wo, wi) {
        return S::default();
    }
    let (wo, wi) = upwards(wo, wi);
    let h = (wo + wi).normalize();
    let dg = ggx::distribution(h, alpha) * ggx::g2(wo, wi, alpha);
    reflectance(wo.dot(h), eta, k) * (dg / (4.0 * wo.z * wi.z))
}

pub(super) fn pdf_w(wo: Vec3, wi: Vec3, alpha: f32) -> f32 {
    if !same_side(wo, wi) {
        return 0.0;
    }
    let (wo, wi) = upwards(wo, wi);
    let h = (wo + wi).normalize();
    ggx::visible_pdf_w(wo, h, alpha) / (4.0 * wo.dot(h))
}

pub(super) fn sample<S: Spectrum>(
    wo: Vec3,
    u: [f32; 3],
    eta: S,
    k: S,
    alpha: f32,
) -> Option<BsdfSample<S>> {
    let below = wo.z < 0.0;
    let (wo, _) = upwards(wo, wo);
    if wo.z == 0.0 {
        return None;
    }
    let h = ggx::sample_visible(wo, alpha, [u[0], u[1]]);
    let cos = wo.dot(h);
    let wi = (2.0 * cos * h - wo).normalize();
    (cos > 0.0 && wi.z > 0.0).then(|| BsdfSample {
        wi: if below { flip(wi) } else { wi },
        weight: reflectance(cos, eta, k) * (ggx::g2(wo, wi, alpha) / ggx::g1(wo, alpha)),
        pdf_w: ggx::visible_pdf_w(wo, h, alpha) / (4.0 * cos),
        delta: false,
        eta: 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_core::{Sampler, warp};
    use tyndall_testkit::rng;

    /// The reflectance that the documentation states of facets that reflect all: the mean over
    /// all directions, whose error is 0.001 at six standard deviations.
    #[test]
    fn the_loss_between_facets_is_as_documented() {
        for (alpha, documented) in [(0.1, 0.972), (0.3, 0.847), (0.5, 0.700), (1.0, 0.411)] {
            let mut sampler = rng(1);
            let count = 1 << 20;
            let total: f64 = (0..count)
                .map(|_| {
                    let wo = warp::cosine_hemisphere(sampler.next());
                    let sample = sample(wo, sampler.next(), 0.0_f32, 1.0, alpha);
                    f64::from(sample.map_or(0.0, |s| s.weight))
                })
                .sum();
            let mean = total / f64::from(count);
            assert!((mean - documented).abs() < 0.003, "{alpha}: {mean}");
        }
    }
}
