//! What surfaces are made of: scattering functions in the frame of the shading normal.
//!
//! Directions are unit, in a frame whose z axis is the normal, and point away from the surface.
//! `eta` is the index of refraction behind the surface (z < 0) over that before it.

mod albedo;
mod conductor;
mod dielectric;
mod facets;
mod fresnel;
#[cfg(test)]
mod furnace;
mod ggx;
mod maps;
mod metallic_roughness;

pub(crate) use conductor::RoughConductor;
pub use fresnel::{fresnel_conductor, fresnel_dielectric};
pub(crate) use maps::{AlphaMode, FLIP, Map, Maps, NormalMap, ScalarMap};
pub(crate) use metallic_roughness::MetallicRoughness;

use glam::Vec3;
use std::f32::consts::FRAC_1_PI;
use tyndall_core::{BsdfSample, PathFrom, Spectrum, SurfaceKind, warp};

/// A scattering function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bsdf<S> {
    /// The boundary of a medium of equal index: light passes straight.
    Null,
    /// Lambert's law on both sides, with this reflectance.
    Diffuse(S),
    /// A perfect mirror on both sides, with this reflectance.
    Mirror(S),
    /// Smooth clear glass, water, …
    Dielectric {
        /// Index of refraction inside.
        ior: f32,
    },
    /// Polished metal, on both sides.
    Conductor {
        /// Real part of the index of refraction.
        eta: S,
        /// Imaginary part.
        k: S,
    },
    /// Brushed or sandblasted metal, on both sides.
    RoughConductor(RoughConductor<S>),
    /// The material of glTF; frosted glass.
    MetallicRoughness(MetallicRoughness<S>),
}

impl<S: Spectrum> Bsdf<S> {
    /// Index of refraction behind the surface; `None` if it has none of its own.
    pub(crate) fn ior(&self) -> Option<f32> {
        match self {
            Self::Dielectric { ior } => Some(*ior),
            Self::MetallicRoughness(m) if m.is_body() => Some(m.ior),
            _ => None,
        }
    }

    /// Whether light can enter what is behind it.
    pub(crate) fn transmits(&self) -> bool {
        matches!(self, Self::Null) || self.ior().is_some()
    }

    /// The same function with other channels.
    pub(crate) fn map<T: Spectrum>(self, mut f: impl FnMut(S) -> T) -> Bsdf<T> {
        match self {
            Self::Null => Bsdf::Null,
            Self::Diffuse(reflectance) => Bsdf::Diffuse(f(reflectance)),
            Self::Mirror(reflectance) => Bsdf::Mirror(f(reflectance)),
            Self::Dielectric { ior } => Bsdf::Dielectric { ior },
            Self::Conductor { eta, k } => Bsdf::Conductor {
                eta: f(eta),
                k: f(k),
            },
            Self::RoughConductor(m) => {
                Bsdf::RoughConductor(RoughConductor::new(f(m.eta), f(m.k), m.alpha))
            }
            Self::MetallicRoughness(m) => Bsdf::MetallicRoughness(m.map(f)),
        }
    }

    /// What it is between media of relative index `eta`: of equal index, glass is not there.
    pub(crate) fn kind(&self, eta: f32) -> SurfaceKind {
        match self {
            Self::Null => SurfaceKind::Null,
            Self::Dielectric { .. } if eta == 1.0 => SurfaceKind::Null,
            Self::Mirror(_) | Self::Dielectric { .. } | Self::Conductor { .. } => {
                SurfaceKind::Delta
            }
            Self::MetallicRoughness(m) => m.kind(eta),
            Self::Diffuse(_) | Self::RoughConductor(_) => SurfaceKind::Finite,
        }
    }

    /// Its value per steradian, without the cosine.
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3, eta: f32, from: PathFrom) -> S {
        match *self {
            Self::Diffuse(reflectance) if same_side(wo, wi) => reflectance * FRAC_1_PI,
            _ => self.rough(wo, wi, eta, from).0,
        }
    }

    /// The colour that a denoiser takes to be the surface's own, 0 to 1: what is reflected of light
    /// of normal incidence, and 1 where directions are discrete and where light passes.
    pub(crate) fn albedo(&self) -> S {
        match *self {
            Self::Diffuse(reflectance) => reflectance,
            Self::RoughConductor(m) => conductor::reflectance(1.0, m.eta, m.k),
            Self::MetallicRoughness(m) if !m.is_body() => m.base_color,
            _ => S::splat(1.0),
        }
    }

    /// Density per steradian of [`Bsdf::sample`], discrete directions left out.
    pub(crate) fn pdf_w(&self, wo: Vec3, wi: Vec3, eta: f32) -> f32 {
        match *self {
            Self::Diffuse(_) if same_side(wo, wi) => warp::cosine_hemisphere_pdf_w(wi.z.abs()),
            _ => self.rough(wo, wi, eta, PathFrom::Sensor).1,
        }
    }

    /// Value and density of what has facets.
    fn rough(&self, wo: Vec3, wi: Vec3, eta: f32, from: PathFrom) -> (S, f32) {
        let (o, i, eta) = upwards(wo, wi, eta);
        match self {
            _ if wo.z == 0.0 => (S::default(), 0.0),
            Self::RoughConductor(m) => facets::evaluate(&m.seen(o.z), o, i, from),
            Self::MetallicRoughness(m) => facets::evaluate(&m.seen(o.z, eta), o, i, from),
            _ => (S::default(), 0.0),
        }
    }

    /// A direction.
    pub(crate) fn sample(
        &self,
        wo: Vec3,
        u: [f32; 3],
        eta: f32,
        from: PathFrom,
    ) -> Option<BsdfSample<S>> {
        match *self {
            _ if wo.z == 0.0 => None,
            _ if self.kind(eta) == SurfaceKind::Null => Some(discrete(-wo, S::splat(1.0))),
            Self::Null => None,
            Self::Diffuse(reflectance) => {
                let mut wi = warp::cosine_hemisphere([u[0], u[1]]);
                wi.z = wi.z.copysign(wo.z);
                (wi.z != 0.0).then(|| BsdfSample {
                    wi,
                    weight: reflectance,
                    pdf_w: warp::cosine_hemisphere_pdf_w(wi.z.abs()),
                    delta: false,
                    eta: 1.0,
                })
            }
            Self::Mirror(reflectance) => Some(discrete(reflect(wo), reflectance)),
            Self::Dielectric { .. } => Some(dielectric::sample(wo, u[2], eta, from)),
            Self::Conductor { eta, k } => Some(discrete(
                reflect(wo),
                conductor::reflectance(wo.z.abs(), eta, k),
            )),
            Self::RoughConductor(_) | Self::MetallicRoughness(_) => {
                self.sample_rough(wo, u, eta, from)
            }
        }
    }

    fn sample_rough(
        &self,
        wo: Vec3,
        u: [f32; 3],
        eta: f32,
        from: PathFrom,
    ) -> Option<BsdfSample<S>> {
        let (o, _, eta) = upwards(wo, wo, eta);
        let sample = match self {
            Self::RoughConductor(m) => facets::sample(&m.seen(o.z), o, u, from),
            Self::MetallicRoughness(m) => facets::sample(&m.seen(o.z, eta), o, u, from),
            _ => None,
        }?;
        let wi = if wo.z > 0.0 {
            sample.wi
        } else {
            flip(sample.wi)
        };
        Some(BsdfSample { wi, ..sample })
    }
}

/// The same directions and index with `wo` above.
fn upwards(wo: Vec3, wi: Vec3, eta: f32) -> (Vec3, Vec3, f32) {
    if wo.z > 0.0 {
        (wo, wi, eta)
    } else {
        (flip(wo), flip(wi), 1.0 / eta)
    }
}

/// Whether a relative index is so near to 1 that rough glass is not there: its facets would bend
/// light by less than `f32` tells from straight, and lose energy.
pub(crate) fn nearly_equal(eta: f32) -> bool {
    (eta - 1.0).abs() <= 1e-3
}

fn same_side(wo: Vec3, wi: Vec3) -> bool {
    wo.z * wi.z > 0.0
}

/// The mirror image of `wo` about the normal.
fn reflect(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// `v` seen from the other side of the surface.
fn flip(v: Vec3) -> Vec3 {
    v.with_z(-v.z)
}

fn discrete<S>(wi: Vec3, weight: S) -> BsdfSample<S> {
    BsdfSample {
        wi,
        weight,
        pdf_w: 0.0,
        delta: true,
        eta: 1.0,
    }
}
