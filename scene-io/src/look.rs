//! How shapes scatter and emit, point by point.

use crate::mapping;
use crate::material::{AlphaMode, Bsdf, Maps, MetallicRoughness, NormalMap};
use crate::spectrum::convert;
use glam::{Vec2, Vec4};
use std::sync::Arc;
use tyndall_core::{Rgb, Spectrum};
use tyndall_surface::{ShapeHit, Surfaces};

/// How a shape scatters and emits.
#[derive(Clone, Debug)]
pub(crate) struct Look<S> {
    pub(crate) bsdf: Bsdf<S>,
    /// Radiance on the side of the normal.
    pub(crate) emission: S,
    /// What varies them; `None` if they are the same all over the shape.
    pub(crate) maps: Option<Arc<Maps>>,
}

impl<S: Spectrum> Look<S> {
    /// The scattering function at a point.
    pub(crate) fn bsdf(&self, surfaces: &Surfaces, hit: &ShapeHit) -> Bsdf<S> {
        match &self.maps {
            Some(maps) if maps.vary_bsdf() => vary(self.bsdf, maps, mapping::uv(surfaces, hit)),
            _ => self.bsdf,
        }
    }

    /// The radiance emitted at a point on the side of its normal.
    pub(crate) fn radiance(&self, surfaces: &Surfaces, hit: &ShapeHit) -> S {
        let Some(maps) = &self.maps else {
            return self.emission;
        };
        if self.is_cut(surfaces, hit) {
            return S::default();
        }
        match &maps.emission {
            Some(map) => self.emission * colour::<S>(map.lookup(mapping::uv(surfaces, hit))),
            None => self.emission,
        }
    }

    /// The mean of [`Look::radiance`] over a primitive, about: it is 0 only where there is no light,
    /// however small the texels that glow.
    pub(crate) fn mean_radiance(&self, surfaces: &Surfaces, shape: u32, primitive: u32) -> S {
        let varied = |maps: &&Arc<Maps>| maps.emission.is_some() || maps.cut();
        let Some(maps) = self.maps.as_ref().filter(varied) else {
            return self.emission;
        };
        let at = |u| surfaces.sample(shape, primitive, u);
        let textures = maps
            .emission
            .iter()
            .chain(maps.alpha_map.iter().filter(|_| maps.cut()).map(|a| &a.map));
        let texels =
            textures.map(|map| mapping::covered_texels(map, |u| mapping::uv(surfaces, &at(u))));
        // Twice as many points as texels on an edge, as far as the time for a shape allows.
        let limit = MAX_POINTS / surfaces.primitive_count(shape) as f64;
        let points = texels.fold(16.0, f64::max).min(limit.max(16.0));
        let n = (4.0 * points).sqrt() as u32;
        let center = |i: u32| (i as f32 + 0.5) / n as f32;
        let grid = (0..n * n).map(|i| at([center(i / n), center(i % n)]));
        let mut sum = S::default();
        grid.for_each(|hit| sum += self.radiance(surfaces, &hit));
        let mean = sum / (n * n) as f32;
        let least: S = self.emission * (LEAST * maps.mean_alpha()) * convert::<S>(maps.mean_glow());
        if mean.mean() < least.mean() {
            least
        } else {
            mean
        }
    }

    /// Whether alpha says that the surface is not there.
    pub(crate) fn is_cut(&self, surfaces: &Surfaces, hit: &ShapeHit) -> bool {
        let Some(maps) = self.maps.as_ref().filter(|maps| maps.cut()) else {
            return false;
        };
        let texel = (maps.alpha_map.as_ref()).map_or(1.0, |m| m.lookup(mapping::uv(surfaces, hit)));
        let alpha = maps.alpha * texel;
        match maps.alpha_mode {
            AlphaMode::Opaque => false,
            AlphaMode::Mask { cutoff } => alpha < cutoff,
            AlphaMode::Blend => mapping::hash(hit) >= alpha,
        }
    }

    pub(crate) fn may_be_cut(&self) -> bool {
        self.maps.as_ref().is_some_and(|maps| maps.cut())
    }

    pub(crate) fn normal_map(&self) -> Option<&NormalMap> {
        self.maps.as_ref()?.normal.as_ref()
    }
}

/// Points at which the emission of all primitives of a shape is measured, at most.
const MAX_POINTS: f64 = 4e6;

/// Between those points there may be light: a primitive counts for no less than this share of what
/// its whole texture would make it.
const LEAST: f32 = 0.01;

fn vary<S: Spectrum>(bsdf: Bsdf<S>, maps: &Maps, uv: Vec2) -> Bsdf<S> {
    let tint = || (maps.base_color.as_ref()).map_or(S::splat(1.0), |map| colour(map.lookup(uv)));
    let factor = |map: &Option<_>| {
        map.as_ref()
            .map_or(1.0, |map: &crate::material::ScalarMap| map.lookup(uv))
    };
    match bsdf {
        Bsdf::Diffuse(reflectance) => Bsdf::Diffuse(reflectance * tint()),
        Bsdf::MetallicRoughness(m) => Bsdf::MetallicRoughness(MetallicRoughness {
            base_color: m.base_color * tint(),
            metallic: m.metallic * factor(&maps.metallic),
            roughness: m.roughness * factor(&maps.roughness),
            transmission: m.transmission * factor(&maps.transmission),
            ..m
        }),
        other => other,
    }
}

fn colour<S: Spectrum>(texel: Vec4) -> S {
    convert(Rgb(texel.truncate()))
}
