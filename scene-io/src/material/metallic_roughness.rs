//! The material of glTF 2.0 with `KHR_materials_ior` and `KHR_materials_transmission`.
//!
//! Khronos (2021), "glTF 2.0 Specification", appendix B, with two changes: reflectance of
//! dielectrics is exact rather than Schlick's, and no energy is lost. Light that bounces between
//! facets comes back as in [`super::albedo`]; the diffuse base gets what its coat does not reflect,
//! as such a lobe, so that all is the same both ways (Kelemen & Szirmay-Kalos 2001).

use super::albedo::{Albedo, Rest};
use super::facets::{Behind, Facets, Pmf};
use super::nearly_equal;
use tyndall_core::{Spectrum, SurfaceKind};

/// Metal, plastic, paint, frosted and thin glass, and what is between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MetallicRoughness<S> {
    /// Reflectance of the metal at normal incidence, of the diffuse base, and tint of what is
    /// transmitted; 0 to 1.
    pub(crate) base_color: S,
    /// Share of metal, 0 to 1.
    pub(crate) metallic: f32,
    /// Root of the α of GGX, 0 to 1.
    pub(crate) roughness: f32,
    /// Index of refraction of what is not metal.
    pub(crate) ior: f32,
    /// Share of light that passes the coat and is transmitted, 0 to 1; the rest meets the diffuse
    /// base.
    pub(crate) transmission: f32,
    /// Whether the surface is a sheet that light passes without bending, rather than the boundary
    /// of a body.
    pub(crate) thin: bool,
}

/// Roughness below which a surface is smooth; α of the tables starts at its square.
const MIN_ROUGHNESS: f32 = 0.03;

impl<S: Spectrum> MetallicRoughness<S> {
    /// The boundary of a clear dielectric.
    pub(crate) fn glass(ior: f32, roughness: f32) -> Self {
        Self {
            base_color: S::splat(1.0),
            metallic: 0.0,
            roughness,
            ior,
            transmission: 1.0,
            thin: false,
        }
    }

    /// The same in other channels.
    pub(super) fn map<T>(self, f: impl FnOnce(S) -> T) -> MetallicRoughness<T> {
        MetallicRoughness {
            base_color: f(self.base_color),
            metallic: self.metallic,
            roughness: self.roughness,
            ior: self.ior,
            transmission: self.transmission,
            thin: self.thin,
        }
    }

    /// Whether it is the boundary of a body that light enters.
    pub(crate) fn is_body(&self) -> bool {
        self.transmission > 0.0 && !self.thin
    }

    /// Whether it is the smooth boundary of a clear dielectric.
    pub(crate) fn is_clear(&self) -> bool {
        let white = self.base_color == S::splat(1.0);
        self.is_body() && self.transmitted() == 1.0 && white && self.alpha() == 0.0
    }

    /// Roughness of GGX, 0 if smooth.
    fn alpha(&self) -> f32 {
        if self.roughness < MIN_ROUGHNESS {
            0.0
        } else {
            self.roughness * self.roughness
        }
    }

    /// Share of light past the coat that meets the diffuse base.
    fn diffuse(&self) -> f32 {
        (1.0 - self.metallic) * (1.0 - self.transmission)
    }

    /// Share of light past the coat that is transmitted.
    fn transmitted(&self) -> f32 {
        (1.0 - self.metallic) * self.transmission
    }

    /// What it is as a boundary of relative index `eta`.
    pub(super) fn kind(&self, eta: f32) -> SurfaceKind {
        let passes_straight = self.is_body() && nearly_equal(eta);
        if passes_straight && self.transmitted() == 1.0 && self.base_color == S::splat(1.0) {
            SurfaceKind::Null
        } else if self.diffuse() > 0.0 && !self.base_color.is_black() {
            SurfaceKind::Finite
        } else if self.alpha() == 0.0 || (passes_straight && self.metallic == 0.0) {
            SurfaceKind::Delta
        } else {
            SurfaceKind::Finite
        }
    }

    /// Seen at this cosine to the normal, `eta` being the relative index behind if light enters.
    pub(super) fn seen(&self, cosine: f32, eta: f32) -> Seen<S> {
        let passes_straight = self.is_body() && nearly_equal(eta);
        let eta = match self.is_body() {
            true if passes_straight => 1.0,
            true => eta,
            false => self.ior,
        };
        let transmitted = self.transmitted();
        let behind = match self.thin {
            _ if transmitted == 0.0 || passes_straight => Behind::Nothing,
            true => Behind::Sheet,
            false => Behind::Body(eta),
        };
        let mut seen = Seen {
            model: *self,
            alpha: self.alpha(),
            eta,
            behind,
            straight: match passes_straight {
                true => self.base_color * transmitted,
                false => S::default(),
            },
            lobes: [None; 3],
            below: None,
            pmf: Pmf::default(),
        };
        seen.add_lobes(cosine);
        seen.pmf = seen.probabilities(cosine);
        seen
    }
}

/// A smooth lobe and its colour.
type Lobe<S> = Option<(S, Rest)>;

/// The material seen from somewhere.
pub(super) struct Seen<S> {
    model: MetallicRoughness<S>,
    alpha: f32,
    /// Index of the coat over that before it.
    eta: f32,
    behind: Behind,
    straight: S,
    /// Above: of metal, of the diffuse base, of what transmitting facets trap.
    lobes: [Lobe<S>; 3],
    below: Lobe<S>,
    pmf: Pmf,
}

impl<S: Spectrum> Seen<S> {
    fn add_lobes(&mut self, cosine: f32) {
        let Self {
            model, alpha, eta, ..
        } = *self;
        let base = model.base_color;
        if model.diffuse() > 0.0 {
            let rest = Rest::unreflected(Albedo::dielectric(eta, alpha), cosine);
            self.lobes[1] = Some((base * model.diffuse(), rest));
        }
        if alpha == 0.0 {
            return;
        }
        if model.metallic > 0.0 {
            let rest = Rest::trapped(Albedo::mirrors(alpha), cosine);
            let mean = schlick(base, 1.0 / 21.0);
            self.lobes[0] = Some((rest.colour(mean) * model.metallic, rest));
        }
        let (rest, (below, share)) = match self.behind {
            Behind::Nothing => return,
            Behind::Sheet => {
                let rest = Rest::trapped(Albedo::mirrors(alpha), cosine);
                (
                    rest,
                    (rest, Albedo::dielectric(eta, alpha).smooth_transmittance()),
                )
            }
            Behind::Body(eta) => {
                let rest = Rest::trapped(Albedo::dielectric(eta, alpha), cosine);
                let behind = Rest::trapped(Albedo::dielectric(1.0 / eta, alpha), 1.0);
                (rest, rest.transmitted(behind, eta))
            }
        };
        let transmitted = model.transmitted();
        self.lobes[2] = Some((S::splat(transmitted * (1.0 - share)), rest));
        self.below = Some((base * (transmitted * share), below));
    }

    /// In proportion to what goes each way.
    fn probabilities(&self, cosine: f32) -> Pmf {
        let model = &self.model;
        let sent = |lobe: &Lobe<S>| lobe.map_or(0.0, |(colour, rest)| colour.mean() * rest.sent);
        let base = model.base_color.mean();
        let reflected = if model.metallic < 1.0 {
            Albedo::dielectric(self.eta, self.alpha).reflected(cosine)
        } else {
            0.0
        };
        let passed = match self.behind {
            Behind::Nothing => 0.0,
            _ => 1.0 - reflected,
        };
        // The first term is never 0 where facets reflect, lest they be forgotten.
        let metal = schlick(base, (1.0 - cosine).powi(5).max(1.0 / 21.0));
        let all = Pmf {
            facets: model.metallic * metal
                + (1.0 - model.metallic) * reflected
                + model.transmitted() * base * passed,
            above: self.lobes.iter().map(sent).sum(),
            below: sent(&self.below),
            straight: self.straight.mean(),
        };
        let total = all.facets + all.above + all.below + all.straight;
        if total == 0.0 {
            return Pmf::default();
        }
        Pmf {
            facets: all.facets / total,
            above: all.above / total,
            below: all.below / total,
            straight: all.straight / total,
        }
    }
}

impl<S: Spectrum> Facets<S> for Seen<S> {
    fn alpha(&self) -> f32 {
        self.alpha
    }

    fn behind(&self) -> Behind {
        self.behind
    }

    fn eta(&self) -> f32 {
        self.eta
    }

    fn colours(&self, cosine: f32, [reflectance, transmittance]: [f32; 2]) -> [S; 2] {
        let MetallicRoughness {
            base_color,
            metallic,
            ..
        } = self.model;
        let metal = schlick(base_color, (1.0 - cosine).max(0.0).powi(5)) * metallic;
        let transmitted = match self.behind {
            Behind::Nothing => S::default(),
            _ => base_color * (self.model.transmitted() * transmittance),
        };
        let reflected = metal + S::splat((1.0 - metallic) * reflectance);
        [reflected, transmitted]
    }

    fn above(&self, cosine: f32) -> S {
        let lobes = self.lobes.iter().flatten();
        lobes
            .map(|(colour, rest)| *colour * rest.lobe(cosine))
            .sum()
    }

    fn below(&self, cosine: f32) -> S {
        (self.below).map_or(S::default(), |(colour, rest)| colour * rest.lobe(cosine))
    }

    fn straight(&self) -> S {
        self.straight
    }

    fn pmf(&self) -> Pmf {
        self.pmf
    }
}

/// Reflectance of metal; `fifth` is (1 − cos θ)⁵, whose mean over all directions is 1/21.
fn schlick<S: Spectrum>(base_color: S, fifth: f32) -> S {
    base_color + (S::splat(1.0) - base_color) * fifth
}
