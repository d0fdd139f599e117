//! What surfaces are made of: scattering functions in the frame of the shading normal.
//!
//! Directions are unit, in a frame whose z axis is the normal, and point away from the surface.
//! `eta` is the index of refraction behind the surface (z < 0) over that before it.

mod conductor;
mod dielectric;
mod fresnel;
mod ggx;
mod maps;
mod metallic_roughness;
mod rough_dielectric;

pub use fresnel::{fresnel_conductor, fresnel_dielectric};
pub(crate) use maps::{AlphaMode, Map, Maps, NormalMap, ScalarMap};
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
    /// Frosted glass.
    RoughDielectric {
        /// Index of refraction inside.
        ior: f32,
        /// Roughness α of the GGX distribution.
        alpha: f32,
    },
    /// Polished metal, on both sides.
    Conductor {
        /// Real part of the index of refraction.
        eta: S,
        /// Imaginary part.
        k: S,
    },
    /// Brushed or sandblasted metal, on both sides.
    RoughConductor {
        /// Real part of the index of refraction.
        eta: S,
        /// Imaginary part.
        k: S,
        /// Roughness α of the GGX distribution.
        alpha: f32,
    },
    /// The material of glTF.
    MetallicRoughness(MetallicRoughness<S>),
}

impl<S> Bsdf<S> {
    /// Index of refraction behind the surface; `None` if it has none of its own.
    pub(crate) fn ior(&self) -> Option<f32> {
        match self {
            Self::Dielectric { ior } | Self::RoughDielectric { ior, .. } => Some(*ior),
            Self::MetallicRoughness(m) if m.transmission > 0.0 && !m.thin => Some(m.ior),
            _ => None,
        }
    }

    /// Whether light can enter what is behind it.
    pub(crate) fn transmits(&self) -> bool {
        matches!(self, Self::Null) || self.ior().is_some()
    }

    /// The same function with other channels.
    pub(crate) fn map<T>(self, mut f: impl FnMut(S) -> T) -> Bsdf<T> {
        match self {
            Self::Null => Bsdf::Null,
            Self::Diffuse(reflectance) => Bsdf::Diffuse(f(reflectance)),
            Self::Mirror(reflectance) => Bsdf::Mirror(f(reflectance)),
            Self::Dielectric { ior } => Bsdf::Dielectric { ior },
            Self::RoughDielectric { ior, alpha } => Bsdf::RoughDielectric { ior, alpha },
            Self::Conductor { eta, k } => Bsdf::Conductor {
                eta: f(eta),
                k: f(k),
            },
            Self::RoughConductor { eta, k, alpha } => Bsdf::RoughConductor {
                eta: f(eta),
                k: f(k),
                alpha,
            },
            Self::MetallicRoughness(m) => Bsdf::MetallicRoughness(MetallicRoughness {
                base_color: f(m.base_color),
                metallic: m.metallic,
                roughness: m.roughness,
                ior: m.ior,
                transmission: m.transmission,
                thin: m.thin,
            }),
        }
    }
}

impl<S: Spectrum> Bsdf<S> {
    /// What it is between media of relative index `eta`: of equal index, glass is not there.
    pub(crate) fn kind(&self, eta: f32) -> SurfaceKind {
        match self {
            Self::Null => SurfaceKind::Null,
            Self::Dielectric { .. } if eta == 1.0 => SurfaceKind::Null,
            Self::RoughDielectric { .. } if nearly_equal(eta) => SurfaceKind::Null,
            Self::Mirror(_) | Self::Dielectric { .. } | Self::Conductor { .. } => {
                SurfaceKind::Delta
            }
            _ => SurfaceKind::Finite,
        }
    }

    /// Its value per steradian, without the cosine.
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3, eta: f32, from: PathFrom) -> S {
        match *self {
            Self::Diffuse(reflectance) if same_side(wo, wi) => reflectance * FRAC_1_PI,
            Self::RoughDielectric { alpha, .. } if !nearly_equal(eta) => {
                S::splat(rough_dielectric::eval(wo, wi, eta, alpha, from))
            }
            Self::RoughConductor { eta, k, alpha } => conductor::eval(wo, wi, eta, k, alpha),
            _ => S::default(),
        }
    }

    /// Density per steradian of [`Bsdf::sample`], discrete directions left out.
    pub(crate) fn pdf_w(&self, wo: Vec3, wi: Vec3, eta: f32) -> f32 {
        match *self {
            Self::Diffuse(_) if same_side(wo, wi) => warp::cosine_hemisphere_pdf_w(wi.z.abs()),
            Self::RoughDielectric { alpha, .. } if !nearly_equal(eta) => {
                rough_dielectric::pdf_w(wo, wi, eta, alpha)
            }
            Self::RoughConductor { alpha, .. } => conductor::pdf_w(wo, wi, alpha),
            _ => 0.0,
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
            Self::RoughDielectric { alpha, .. } => {
                rough_dielectric::sample(wo, u, eta, alpha, from)
            }
            Self::Conductor { eta, k } => Some(discrete(
                reflect(wo),
                conductor::reflectance(wo.z.abs(), eta, k),
            )),
            Self::RoughConductor { eta, k, alpha } => conductor::sample(wo, u, eta, k, alpha),
            Self::MetallicRoughness(_) => None,
        }
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
