//! Rough and smooth surfaces: facets, and smooth lobes of light that took a longer way.
//!
//! Single bounces after Walter et al. (2007); all functions have `wo` above the surface.

use super::dielectric::radiance_scale;
use super::fresnel::{fresnel_dielectric, refracted_cosine};
use super::{discrete, flip, ggx, reflect};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;
use tyndall_core::{BsdfSample, PathFrom, Spectrum, warp};

/// Where transmitted light goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Behind {
    /// Nowhere, or straight through all facets.
    Nothing,
    /// The mirror image of where reflected light goes.
    Sheet,
    /// Where a facet of this relative index, behind over before, refracts it to.
    Body(f32),
}

/// Probabilities of the ways that a direction is sampled; their sum is 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pmf {
    /// A visible facet.
    pub(super) facets: f32,
    /// The cosine lobes above and below.
    pub(super) above: f32,
    pub(super) below: f32,
    /// Straight through.
    pub(super) straight: f32,
}

/// What is made of facets, seen from a direction `wo`.
pub(super) trait Facets<S: Spectrum> {
    /// Roughness of GGX; 0 is smooth.
    fn alpha(&self) -> f32;

    fn behind(&self) -> Behind;

    /// Index of refraction of the facets over that before them.
    fn eta(&self) -> f32;

    /// What a facet reflects and transmits that `wo` meets at this cosine, its dielectric
    /// reflectance and transmittance being these.
    fn colours(&self, cosine: f32, dielectric: [f32; 2]) -> [S; 2];

    /// π times the value of the lobe above, at this cosine to the normal.
    fn above(&self, cosine: f32) -> S;

    /// The same below, for flux.
    fn below(&self, cosine: f32) -> S;

    /// The share that passes straight.
    fn straight(&self) -> S;

    fn pmf(&self) -> Pmf;
}

/// The facet that sends `wo` to `wi`, found in `f64`: where it is seen edge-on, its cosines are
/// small differences, and both directions of a path must agree on them.
struct Facet {
    /// Unit normal, up.
    h: Vec3,
    /// Cosine to `wo`, positive.
    cos_o: f32,
    /// Dielectric reflectance and transmittance.
    dielectric: [f32; 2],
    /// dω_h/dω_i.
    jacobian: f32,
}

impl Facet {
    /// `None` if no facet does (Walter et al., eq. 13 and 16).
    fn between(wo: Vec3, wi: Vec3, eta: f32, behind: Behind) -> Option<Self> {
        match behind {
            _ if wi.z > 0.0 => Self::reflecting(wo, wi, eta),
            Behind::Nothing => None,
            Behind::Sheet => Self::reflecting(wo, flip(wi), eta),
            Behind::Body(eta) => Self::refracting(wo, wi, eta),
        }
    }

    fn reflecting(wo: Vec3, wi: Vec3, eta: f32) -> Option<Self> {
        let o = wo.as_dvec3();
        let h = (o + wi.as_dvec3()).try_normalize()?;
        let cos_o = o.dot(h) as f32;
        let reflectance = fresnel_dielectric(cos_o, eta);
        (cos_o > 0.0).then(|| Self {
            h: h.as_vec3(),
            cos_o,
            dielectric: [reflectance, 1.0 - reflectance],
            jacobian: 0.25 / cos_o,
        })
    }

    fn refracting(wo: Vec3, wi: Vec3, eta: f32) -> Option<Self> {
        let (o, i) = (wo.as_dvec3(), wi.as_dvec3());
        let h = (o + f64::from(eta) * i).try_normalize()?;
        let h = if h.z < 0.0 { -h } else { h };
        let (cos_o, cos_i) = (o.dot(h) as f32, -i.dot(h) as f32);
        if cos_o <= 0.0 || cos_i <= 0.0 {
            return None;
        }
        let d = cos_o - eta * cos_i;
        // 1 − reflectance without its cancellation, and symmetric in both cosines, which Snell's
        // law ties to each other.
        let (p, s) = (eta * cos_o + cos_i, cos_o + eta * cos_i);
        let transmittance = 2.0 * eta * cos_o * cos_i * (1.0 / (p * p) + 1.0 / (s * s));
        Some(Self {
            h: h.as_vec3(),
            cos_o,
            dielectric: [1.0 - transmittance, transmittance],
            // Walter et al., eq. 17.
            jacobian: eta * eta * cos_i / (d * d),
        })
    }
}

/// How often the facet reflects, for what it reflects and transmits.
fn reflects<S: Spectrum>([reflected, transmitted]: [S; 2]) -> f32 {
    let (r, t) = (reflected.mean(), transmitted.mean());
    if t > 0.0 { r / (r + t) } else { 1.0 }
}

/// The value per steradian, without the cosine, and the density per steradian of [`sample`];
/// discrete directions left out. Walter et al., eq. 20 and 21.
pub(super) fn evaluate<S: Spectrum>(
    surface: &impl Facets<S>,
    wo: Vec3,
    wi: Vec3,
    from: PathFrom,
) -> (S, f32) {
    let (alpha, pmf) = (surface.alpha(), surface.pmf());
    if wi.z == 0.0 {
        return (S::default(), 0.0);
    }
    let above = wi.z > 0.0;
    let cosine = wi.z.abs();
    let (lobe, lobe_pmf) = if above {
        (surface.above(cosine), pmf.above)
    } else {
        (surface.below(cosine), pmf.below)
    };
    let mut value = lobe * FRAC_1_PI;
    let mut pdf_w = lobe_pmf * warp::cosine_hemisphere_pdf_w(cosine);
    let facet = (alpha > 0.0 && pmf.facets > 0.0)
        .then(|| Facet::between(wo, wi, surface.eta(), surface.behind()))
        .flatten();
    if let Some(facet) = facet {
        let colours = surface.colours(facet.cos_o, facet.dielectric);
        let reflects = reflects(colours);
        let (colour, choice, mirrored) = match surface.behind() {
            _ if above => (colours[0], reflects, wi),
            Behind::Sheet => (colours[1], 1.0 - reflects, flip(wi)),
            _ => (colours[1], 1.0 - reflects, wi),
        };
        let dg = ggx::distribution(facet.h, alpha) * ggx::g2(wo, mirrored, alpha);
        value += colour * (dg * facet.jacobian * facet.cos_o / (wo.z * cosine));
        let visible = ggx::visible_pdf_w(wo, facet.h, alpha);
        pdf_w += pmf.facets * choice * visible * facet.jacobian;
    }
    match surface.behind() {
        Behind::Body(eta) if !above => (value * radiance_scale(eta, from), pdf_w),
        _ => (value, pdf_w),
    }
}

/// A direction.
pub(super) fn sample<S: Spectrum>(
    surface: &impl Facets<S>,
    wo: Vec3,
    u: [f32; 3],
    from: PathFrom,
) -> Option<BsdfSample<S>> {
    let pmf = surface.pmf();
    let cosine_lobe = || warp::cosine_hemisphere([u[0], u[1]]);
    let mut choice = u[2];
    let mut chosen = |share: f32| {
        let chosen = choice < share;
        choice = if chosen {
            choice / share
        } else {
            choice - share
        };
        chosen
    };
    let wi = if chosen(pmf.straight) {
        return Some(discrete(-wo, surface.straight() / pmf.straight));
    } else if chosen(pmf.above) {
        cosine_lobe()
    } else if chosen(pmf.below) {
        flip(cosine_lobe())
    } else if pmf.facets > 0.0 {
        let choice = (choice / pmf.facets).min(1.0);
        if surface.alpha() == 0.0 {
            return smooth(surface, wo, choice, from);
        }
        let h = ggx::sample_visible(wo, surface.alpha(), [u[0], u[1]]);
        let (wi, reflected) = leave(surface, wo, h, choice)?;
        if (wi.z > 0.0) != reflected {
            return None;
        }
        wi
    } else {
        return None;
    };
    let (value, pdf_w) = evaluate(surface, wo, wi, from);
    (pdf_w > 0.0).then(|| BsdfSample {
        wi,
        weight: value * (wi.z.abs() / pdf_w),
        pdf_w,
        delta: false,
        eta: index_ratio(surface.behind(), wi),
    })
}

fn index_ratio(behind: Behind, wi: Vec3) -> f32 {
    match behind {
        Behind::Body(eta) if wi.z < 0.0 => eta,
        _ => 1.0,
    }
}

/// Where facet `h` sends `wo`, and whether by reflection; `None` if it shows its back.
fn leave<S: Spectrum>(
    surface: &impl Facets<S>,
    wo: Vec3,
    h: Vec3,
    choice: f32,
) -> Option<(Vec3, bool)> {
    let cos = wo.dot(h);
    if cos <= 0.0 {
        return None;
    }
    let reflectance = fresnel_dielectric(cos, surface.eta());
    let reflects = reflects(surface.colours(cos, [reflectance, 1.0 - reflectance]));
    let mirrored = 2.0 * cos * h - wo;
    let wi = match surface.behind() {
        Behind::Sheet if choice >= reflects => flip(mirrored),
        Behind::Body(eta) if choice >= reflects => {
            let cos_t = refracted_cosine(cos, eta)?;
            (cos / eta - cos_t) * h - wo / eta
        }
        _ => return Some((mirrored.normalize(), true)),
    };
    Some((wi.normalize(), false))
}

/// Reflection or transmission at the surface itself.
fn smooth<S: Spectrum>(
    surface: &impl Facets<S>,
    wo: Vec3,
    choice: f32,
    from: PathFrom,
) -> Option<BsdfSample<S>> {
    let pmf = surface.pmf().facets;
    let reflectance = fresnel_dielectric(wo.z, surface.eta());
    let colours = surface.colours(wo.z, [reflectance, 1.0 - reflectance]);
    let reflects = reflects(colours);
    if choice < reflects || reflects == 1.0 {
        return Some(discrete(reflect(wo), colours[0] / (pmf * reflects)));
    }
    let behind = surface.behind();
    let (wi, scale) = match behind {
        Behind::Body(eta) => {
            let cos_t = refracted_cosine(wo.z, eta)?;
            let wi = Vec3::new(-wo.x / eta, -wo.y / eta, -cos_t);
            (wi.normalize(), radiance_scale(eta, from))
        }
        _ => (-wo, 1.0),
    };
    Some(BsdfSample {
        eta: index_ratio(behind, wi),
        ..discrete(wi, colours[1] * (scale / (pmf * (1.0 - reflects))))
    })
}
