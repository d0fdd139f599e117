//! Textures that vary a material over its surface.

use crate::texture::Texture;
use glam::{Affine2, Mat2, Vec2, Vec4};
use std::sync::Arc;
use tyndall_core::Rgb;

/// Turns texture coordinates of surfaces, whose v runs up the image from its lower left corner,
/// into those of textures, whose v runs down from the upper left; and back.
pub(crate) const FLIP: Affine2 = Affine2 {
    matrix2: Mat2::from_cols(Vec2::X, Vec2::NEG_Y),
    translation: Vec2::Y,
};

/// A texture, and how the texture coordinates of a surface become its own.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    pub(crate) texture: Arc<Texture>,
    pub(crate) transform: Affine2,
}

impl Map {
    /// The texel at the texture coordinates of a surface.
    pub(crate) fn lookup(&self, uv: Vec2) -> Vec4 {
        self.texture.lookup(self.transform.transform_point2(uv))
    }
}

/// One channel of a texture.
#[derive(Clone, Debug)]
pub(crate) struct ScalarMap {
    pub(crate) map: Map,
    /// 0 to 3: red, green, blue, alpha.
    pub(crate) channel: usize,
}

impl ScalarMap {
    /// The number at the texture coordinates of a surface.
    pub(crate) fn lookup(&self, uv: Vec2) -> f32 {
        self.map.lookup(uv)[self.channel]
    }
}

/// A normal map as glTF has them: red to the right, green up, blue out.
#[derive(Clone, Debug)]
pub(crate) struct NormalMap {
    pub(crate) map: Map,
    /// Factor of what is across the surface.
    pub(crate) scale: f32,
}

/// What alpha means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// The surface is not there where alpha is below the cutoff.
    Mask {
        /// The cutoff.
        cutoff: f32,
    },
    /// Of any small piece of the surface, the share alpha is there: a hash of the point decides.
    Blend,
}

/// Everything about a material that is not the same all over it. What maps hold multiplies the
/// constants of the material.
#[derive(Clone, Debug)]
pub(crate) struct Maps {
    /// Base colour or reflectance; red, green and blue count.
    pub(crate) base_color: Option<Map>,
    /// In glTF the green of a texture.
    pub(crate) roughness: Option<ScalarMap>,
    /// In glTF the blue of the same.
    pub(crate) metallic: Option<ScalarMap>,
    /// In glTF the red of a texture.
    pub(crate) transmission: Option<ScalarMap>,
    pub(crate) normal: Option<NormalMap>,
    pub(crate) emission: Option<Map>,
    /// In glTF the alpha of the texture of the base colour.
    pub(crate) alpha_map: Option<ScalarMap>,
    /// Factor of alpha.
    pub(crate) alpha: f32,
    pub(crate) alpha_mode: AlphaMode,
}

impl Maps {
    /// All textures, some perhaps more than once.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &Arc<Texture>> {
        let scalars = [
            &self.roughness,
            &self.metallic,
            &self.transmission,
            &self.alpha_map,
        ];
        let scalars = scalars.into_iter().flatten().map(|s| &s.map);
        let colours = [&self.base_color, &self.emission].into_iter().flatten();
        let maps = colours.chain(scalars);
        maps.chain(self.normal.iter().map(|n| &n.map))
            .map(|map| &map.texture)
    }
}

impl Default for Maps {
    fn default() -> Self {
        Self {
            base_color: None,
            roughness: None,
            metallic: None,
            transmission: None,
            normal: None,
            emission: None,
            alpha_map: None,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
        }
    }
}

impl Maps {
    /// Whether scattering differs from point to point.
    pub(crate) fn vary_bsdf(&self) -> bool {
        let scalars = [&self.roughness, &self.metallic, &self.transmission];
        self.base_color.is_some() || scalars.into_iter().any(Option::is_some)
    }

    /// Whether the surface may have holes.
    pub(crate) fn cut(&self) -> bool {
        self.alpha_mode != AlphaMode::Opaque && (self.alpha < 1.0 || self.alpha_map.is_some())
    }

    /// Whether nothing is said.
    pub(crate) fn is_empty(&self) -> bool {
        let bare = self.normal.is_none() && self.emission.is_none();
        bare && !self.vary_bsdf() && !self.cut()
    }

    /// The mean of the texture of the emission.
    pub(crate) fn mean_glow(&self) -> Rgb {
        let map = self.emission.as_ref();
        map.map_or(Rgb::new(1.0, 1.0, 1.0), |map| {
            Rgb(map.texture.mean().truncate())
        })
    }

    /// The mean of alpha over its texture; 1 if it means nothing.
    pub(crate) fn mean_alpha(&self) -> f32 {
        if !self.cut() {
            return 1.0;
        }
        let map = self.alpha_map.as_ref();
        self.alpha * map.map_or(1.0, |s| s.map.texture.mean()[s.channel])
    }

    /// What is left of them where there are no texture coordinates: the constants.
    pub(crate) fn without_textures(&self) -> Self {
        Self {
            alpha: self.alpha,
            alpha_mode: self.alpha_mode,
            ..Self::default()
        }
    }

    /// Whether texture coordinates are needed.
    pub(crate) fn have_textures(&self) -> bool {
        let others = [
            self.normal.is_some(),
            self.emission.is_some(),
            self.alpha_map.is_some(),
        ];
        self.vary_bsdf() || others.contains(&true)
    }

    /// Whether all colours have equal channels.
    pub(crate) fn are_grey(&self) -> bool {
        let colours = [&self.base_color, &self.emission];
        (colours.into_iter().flatten()).all(|map| map.texture.is_grey())
    }
}
