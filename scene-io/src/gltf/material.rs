//! Materials: metal and roughness, glass, cut-outs, glow.

use super::document::Document;
use super::image::Textures;
use super::medium::{self, Extras, Surface};
use crate::Error;
use crate::file::Material;
use crate::material::{AlphaMode, Bsdf, FLIP, Map, Maps, MetallicRoughness, NormalMap, ScalarMap};
use crate::media::MediumDescription;
use crate::texture::{Budget, ColourSpace};
use glam::{Affine2, Mat2, Vec2};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::AlphaMode as Alpha;
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use tyndall_core::{Rgb, Spectrum};

/// A material, and what fills the shapes that it closes.
pub(super) struct Read {
    pub(super) material: Material,
    pub(super) medium: Option<MediumDescription>,
    /// Which texture coordinates its textures have.
    pub(super) uv_set: u32,
}

/// The scale of lengths, and whether drafts of extensions are read.
pub(super) type Conventions = (f64, bool);

/// Reads materials of one file.
pub(super) struct Reader<'a> {
    document: &'a Document,
    textures: Textures<'a>,
    conventions: Conventions,
    notices: &'a mut Vec<String>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(
        document: &'a Document,
        conventions: Conventions,
        budget: &'a Budget,
        notices: &'a mut Vec<String>,
    ) -> Self {
        Self {
            document,
            textures: Textures::of(document, budget),
            conventions,
            notices,
        }
    }

    /// The material of this index, or that of primitives without one.
    pub(super) fn read(&mut self, index: Option<usize>) -> Result<Read, Error> {
        let Some(index) = index else {
            let fallback = json::Material::default();
            return self.convert(&fallback, "materials");
        };
        let document = self.document;
        self.convert(
            &document.root.materials[index],
            &format!("materials[{index}]"),
        )
    }

    fn convert(&mut self, source: &json::Material, field: &str) -> Result<Read, Error> {
        let extras = medium::extras(self.document, source, field)?;
        if extras.is_some_and(|e| e.surface == Some(Surface::None)) {
            return self.filled(
                Material::opaque(Bsdf::Null, Rgb::default()),
                source,
                extras,
                field,
            );
        }
        let mut uvs = UvSet::default();
        let is_body = medium::is_body(source, extras.as_ref(), self.conventions.1);
        let constants = self.constants(source, is_body, field)?;
        let emission = self.emission(source, field)?;
        let maps = self.maps(source, &mut uvs, field)?;
        if uvs.differ {
            let why = "its textures use several sets of texture coordinates: all take the first";
            self.notice(field, source, why);
        }
        if source.double_sided && !emission.is_black() {
            let why = "glows on the side of its normals alone, though it is double-sided";
            self.notice(field, source, why);
        }
        let bsdf = simplest(constants, &maps);
        let material = Material {
            maps,
            ..Material::opaque(bsdf, emission)
        };
        let mut read = self.filled(material, source, extras, field)?;
        read.uv_set = uvs.set.unwrap_or(0);
        Ok(read)
    }

    fn filled(
        &mut self,
        mut material: Material,
        source: &json::Material,
        extras: Option<Extras>,
        field: &str,
    ) -> Result<Read, Error> {
        let conventions = self.conventions;
        let mut medium = medium::read(self.document, source, extras.as_ref(), conventions, field)?;
        if material.bsdf.transmits() {
            material.priority = extras.map_or(0, |e| e.priority);
        } else if medium.take().is_some() && medium::is_body(source, extras.as_ref(), conventions.1)
        {
            let why = "light does not enter, so that its medium is left out: give it a \
                       transmissionFactor above 0, or `\"surface\": \"none\"` in `extras.tyndall`";
            self.notice(field, source, why);
        }
        Ok(Read {
            material,
            medium,
            uv_set: 0,
        })
    }

    fn notice(&mut self, field: &str, source: &json::Material, why: &str) {
        let path = self.document.path.display();
        let name = source.name.as_deref().unwrap_or_default();
        self.notices
            .push(format!("{path}: {field} {name:?}: {why}"));
    }

    /// `is_body`: light that is transmitted enters a body.
    fn constants(
        &mut self,
        source: &json::Material,
        is_body: bool,
        field: &str,
    ) -> Result<MetallicRoughness<Rgb>, Error> {
        let ior = self.ior(source, field)?;
        let pbr = &source.pbr_metallic_roughness;
        let extensions = source.extensions.as_ref();
        let share = |key: &str, x: f32| match x {
            0.0..=1.0 => Ok(x),
            _ => {
                let field = format!("{field}.{key}");
                Err(self
                    .document
                    .error(field, format!("is {x}, but must be from 0 to 1")))
            }
        };
        let colour = |x| share("pbrMetallicRoughness.baseColorFactor", x);
        let [r, g, b, _] = pbr.base_color_factor.0;
        let transmission = extensions.and_then(|e| e.transmission.as_ref());
        let transmission = transmission.map_or(0.0, |t| t.transmission_factor.0);
        Ok(MetallicRoughness {
            base_color: Rgb::new(colour(r)?, colour(g)?, colour(b)?),
            metallic: share("pbrMetallicRoughness.metallicFactor", pbr.metallic_factor.0)?,
            roughness: share(
                "pbrMetallicRoughness.roughnessFactor",
                pbr.roughness_factor.0,
            )?,
            ior,
            transmission: share("extensions.KHR_materials_transmission", transmission)?,
            thin: !is_body,
        })
    }

    fn ior(&mut self, source: &json::Material, field: &str) -> Result<f32, Error> {
        let extension = source.extensions.as_ref().and_then(|e| e.ior.as_ref());
        let ior = extension.map_or(DEFAULT_IOR, |i| i.ior.0);
        let field = format!("{field}.extensions.KHR_materials_ior.ior");
        if ior == 0.0 {
            let why = format!(
                "is 0, by which `KHR_materials_specular`, which is left out, takes the place of \
                 Fresnel's law: read as {DEFAULT_IOR}"
            );
            self.notice(&field, source, &why);
            return Ok(DEFAULT_IOR);
        }
        if !(1.0..=10.0).contains(&ior) {
            let why = format!("is {ior}, but must be from 1 to 10, or 0: export again");
            return Err(self.document.error(field, why));
        }
        Ok(ior)
    }

    fn emission(&self, source: &json::Material, field: &str) -> Result<Rgb, Error> {
        let extension = source
            .extensions
            .as_ref()
            .and_then(|e| e.emissive_strength.as_ref());
        let strength = extension.map_or(1.0, |e| e.emissive_strength.0);
        let [r, g, b] = source.emissive_factor.0.map(|x| x * strength);
        let emission = Rgb::new(r, g, b);
        if emission.0.min_element() >= 0.0 && emission.0.is_finite() {
            return Ok(emission);
        }
        let why = "times its strength must be finite and not negative: export again";
        Err(self.document.error(format!("{field}.emissiveFactor"), why))
    }

    fn maps(
        &mut self,
        source: &json::Material,
        uvs: &mut UvSet,
        field: &str,
    ) -> Result<Maps, Error> {
        let pbr = &source.pbr_metallic_roughness;
        let extensions = source.extensions.as_ref();
        let transmission = extensions.and_then(|e| e.transmission.as_ref());
        let transmission = transmission.and_then(|t| t.transmission_texture.as_ref());
        let mut info =
            |info: Option<&Info>, space| info.map(|i| self.map(i, space, uvs, field)).transpose();
        let base_color = info(pbr.base_color_texture.as_ref(), ColourSpace::Srgb)?;
        let packed = info(pbr.metallic_roughness_texture.as_ref(), ColourSpace::Linear)?;
        let transmission = info(transmission, ColourSpace::Linear)?;
        let emission = info(source.emissive_texture.as_ref(), ColourSpace::Srgb)?;
        let channel = |map: &Option<Map>, channel| {
            let map = map.clone()?;
            Some(ScalarMap { map, channel })
        };
        let alpha_mode = self.alpha_mode(source, field)?;
        let has_alpha = |map: &&ScalarMap| map.map.texture.has_alpha();
        let alpha_map = channel(&base_color, 3);
        Ok(Maps {
            roughness: channel(&packed, 1),
            metallic: channel(&packed, 2),
            transmission: channel(&transmission, 0),
            normal: self.normal(source, uvs, field)?,
            emission,
            alpha_map: alpha_map.as_ref().filter(has_alpha).cloned(),
            alpha: pbr.base_color_factor.0[3].clamp(0.0, 1.0),
            alpha_mode,
            base_color,
        })
    }

    fn normal(
        &mut self,
        source: &json::Material,
        uvs: &mut UvSet,
        field: &str,
    ) -> Result<Option<NormalMap>, Error> {
        let Some(info) = &source.normal_texture else {
            return Ok(None);
        };
        let field = format!("{field}.normalTexture");
        if !info.scale.is_finite() {
            return Err(self
                .document
                .error(format!("{field}.scale"), "must be finite: export again"));
        }
        // The crate reads the transformation of all textures but this.
        let others = info.extensions.as_ref().map(|e| &e.others);
        let transform = others.and_then(|o| o.get("KHR_texture_transform"));
        let transform = transform.map(|value| serde_json::from_value(value.clone()));
        let transform: Option<TextureTransform> = transform.transpose().map_err(|e| {
            let field = format!("{field}.extensions.KHR_texture_transform");
            self.document.error(field, format!("{e}: export again"))
        })?;
        let map = self.mapped(
            info.index,
            (info.tex_coord, transform.as_ref()),
            ColourSpace::Linear,
            uvs,
            &field,
        )?;
        let scale = info.scale;
        Ok(Some(NormalMap { map, scale }))
    }

    fn alpha_mode(&self, source: &json::Material, field: &str) -> Result<AlphaMode, Error> {
        let cutoff = source.alpha_cutoff.map_or(0.5, |c| c.0);
        Ok(match source.alpha_mode {
            Checked::Valid(Alpha::Mask) if cutoff.is_finite() => AlphaMode::Mask { cutoff },
            Checked::Valid(Alpha::Mask) => {
                let why = "must be finite: export again";
                return Err(self.document.error(format!("{field}.alphaCutoff"), why));
            }
            Checked::Valid(Alpha::Blend) => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        })
    }

    fn map(
        &mut self,
        info: &Info,
        space: ColourSpace,
        uvs: &mut UvSet,
        field: &str,
    ) -> Result<Map, Error> {
        let transform = info
            .extensions
            .as_ref()
            .and_then(|e| e.texture_transform.as_ref());
        self.mapped(info.index, (info.tex_coord, transform), space, uvs, field)
    }

    fn mapped(
        &mut self,
        texture: Index<json::Texture>,
        (uv_set, transform): (u32, Option<&TextureTransform>),
        space: ColourSpace,
        uvs: &mut UvSet,
        field: &str,
    ) -> Result<Map, Error> {
        uvs.see(transform.and_then(|t| t.tex_coord).unwrap_or(uv_set));
        let transform = transform.map_or(Affine2::IDENTITY, affine);
        if !transform.is_finite() {
            let field = format!("{field}.extensions.KHR_texture_transform");
            return Err(self.document.error(field, "must be finite: export again"));
        }
        Ok(Map {
            texture: self.textures.get(texture, space)?,
            transform: transform * FLIP,
        })
    }
}

/// Of a material that does not say its index of refraction.
const DEFAULT_IOR: f32 = 1.5;

/// The set of texture coordinates that textures share: a mesh carries one.
#[derive(Default)]
struct UvSet {
    set: Option<u32>,
    differ: bool,
}

impl UvSet {
    fn see(&mut self, set: u32) {
        self.differ |= *self.set.get_or_insert(set) != set;
    }
}

/// First scaled, then rotated, then moved. v runs downwards here, so that a rotation that is
/// counter-clockwise to the eye takes (1, 0) to (cos, −sin).
fn affine(transform: &TextureTransform) -> Affine2 {
    let (sin, cos) = transform.rotation.0.sin_cos();
    let scale = Vec2::from(transform.scale.0);
    let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    Affine2::from_mat2_translation(
        rotation * Mat2::from_diagonal(scale),
        transform.offset.0.into(),
    )
}

/// Smooth clear glass is told by name: it has no lobes to sample.
fn simplest(constants: MetallicRoughness<Rgb>, maps: &Maps) -> Bsdf<Rgb> {
    if !maps.vary_bsdf() && constants.is_clear() {
        Bsdf::Dielectric { ior: constants.ior }
    } else {
        Bsdf::MetallicRoughness(constants)
    }
}
