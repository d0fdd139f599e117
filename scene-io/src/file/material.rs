//! `[materials.NAME]`.

use super::reader::{Field, Table};
use super::texture::{self, Textures};
use crate::Error;
use crate::material::{
    AlphaMode, Bsdf, Maps, MetallicRoughness, NormalMap, RoughConductor, ScalarMap,
};
use crate::media::Filling;
use crate::texture::ColourSpace;
use tyndall_core::Rgb;

/// A material as the scene file describes it; media by their index.
#[derive(Clone, Debug)]
pub(crate) struct Material {
    pub(crate) bsdf: Bsdf<Rgb>,
    /// Radiance emitted on the side of the normal.
    pub(crate) emission: Rgb,
    pub(crate) maps: Maps,
    pub(crate) inside: Filling,
    /// Whether that shares its place with what is there without the shape.
    pub(crate) adds: bool,
    /// What lies around the surface where no other shape contains it, if the file says.
    pub(crate) outside: Option<Filling>,
    pub(crate) priority: i32,
}

impl Material {
    /// One that light does not enter.
    pub(crate) fn opaque(bsdf: Bsdf<Rgb>, emission: Rgb) -> Self {
        Self {
            bsdf,
            emission,
            maps: Maps::default(),
            inside: Vec::new(),
            adds: false,
            outside: None,
            priority: 0,
        }
    }
}

const KINDS: [&str; 6] = [
    "diffuse",
    "mirror",
    "dielectric",
    "conductor",
    "metallic_roughness",
    "null",
];

/// Reads a material; `media` are the names of the scene's media.
pub(super) fn read(
    field: &Field<'_>,
    media: &[&str],
    textures: &mut Textures<'_>,
) -> Result<Material, Error> {
    let table = field.table()?;
    let mut maps = Maps::default();
    let bsdf = bsdf(&table, textures, &mut maps)?;
    let mut emission = Rgb::default();
    if let Some(field) = table.optional("emission") {
        (emission, maps.emission) = textures.colour(&field, |f| f.colour())?;
    }
    read_relief_and_holes(&table, textures, &mut maps)?;
    let mut material = Material::opaque(bsdf, emission);
    material.maps = maps;
    if bsdf.transmits() {
        if let Some(name) = table.optional("inside") {
            material.inside = filling(&name, media)?;
        }
        if let (Bsdf::Null, Some(adds)) = (bsdf, table.optional("adds")) {
            material.adds = adds.boolean()?;
        }
        if let Some(name) = table.optional("outside") {
            material.outside = Some(filling(&name, media)?);
        }
        if let Some(priority) = table.optional("priority") {
            material.priority = priority.integer(i32::MIN.into(), i32::MAX.into())? as i32;
        }
    }
    table.finish()?;
    Ok(material)
}

/// `normal_map`, `alpha`, `alpha_cutoff`.
fn read_relief_and_holes(
    table: &Table<'_>,
    textures: &mut Textures<'_>,
    maps: &mut Maps,
) -> Result<(), Error> {
    if let Some(field) = table.optional("normal_map") {
        let table = field.table()?;
        let scale = table.optional("strength").map_or(Ok(1.0), |f| f.number())? as f32;
        let map = textures.map(&table, ColourSpace::Linear)?;
        table.finish()?;
        maps.normal = Some(NormalMap { map, scale });
    }
    let alpha = table.optional("alpha");
    if let Some(field) = &alpha {
        (maps.alpha, maps.alpha_map) = textures.scalar(field, true)?;
        maps.alpha_mode = AlphaMode::Blend;
    }
    if let Some(field) = table.optional("alpha_cutoff") {
        let cutoff = texture::share(&field)?;
        maps.alpha_mode = AlphaMode::Mask { cutoff };
        if alpha.is_none() {
            let base = maps.base_color.clone().filter(|m| m.texture.has_alpha());
            let map = base.ok_or_else(|| {
                field.error("needs `alpha`, or a texture that has it in place of the colour")
            })?;
            maps.alpha_map = Some(ScalarMap { map, channel: 3 });
        }
    }
    Ok(())
}

fn bsdf(
    table: &Table<'_>,
    textures: &mut Textures<'_>,
    maps: &mut Maps,
) -> Result<Bsdf<Rgb>, Error> {
    Ok(match table.required("kind")?.one_of(&KINDS)? {
        "diffuse" => {
            let field = table.required("reflectance")?;
            let (reflectance, map) = textures.colour(&field, |f| f.fraction())?;
            maps.base_color = map;
            Bsdf::Diffuse(reflectance)
        }
        "mirror" => Bsdf::Mirror(match table.optional("reflectance") {
            Some(field) => field.fraction()?,
            None => Rgb::new(1.0, 1.0, 1.0),
        }),
        "dielectric" => {
            let ior = ior(&table.required("ior")?)?;
            match roughness(table)? {
                None => Bsdf::Dielectric { ior },
                Some(alpha) => Bsdf::MetallicRoughness(MetallicRoughness::glass(ior, alpha.sqrt())),
            }
        }
        "conductor" => {
            let eta = (table.required("eta")?)
                .colour_that(|x| (1e-6..=1e3).contains(&x), "between 1e-6 and 1000")?;
            let k = table
                .required("k")?
                .colour_that(|x| x <= 1e3, "between 0 and 1000")?;
            match roughness(table)? {
                None => Bsdf::Conductor { eta, k },
                Some(alpha) => Bsdf::RoughConductor(RoughConductor::new(eta, k, alpha)),
            }
        }
        "metallic_roughness" => Bsdf::MetallicRoughness(metallic_roughness(table, textures, maps)?),
        _ => Bsdf::Null,
    })
}

fn metallic_roughness(
    table: &Table<'_>,
    textures: &mut Textures<'_>,
    maps: &mut Maps,
) -> Result<MetallicRoughness<Rgb>, Error> {
    let base_color;
    (base_color, maps.base_color) =
        textures.colour(&table.required("base_color")?, |f| f.fraction())?;
    let mut scalar = |field: Option<Field<'_>>, default| match field {
        Some(field) => textures.scalar(&field, false),
        None => Ok((default, None)),
    };
    let packed = table.optional("metallic_roughness");
    let unpacked = if packed.is_some() { 1.0 } else { 0.0 };
    let (metallic, roughness, transmission);
    (metallic, maps.metallic) = scalar(table.optional("metallic"), unpacked)?;
    (transmission, maps.transmission) = scalar(table.optional("transmission"), 0.0)?;
    (roughness, maps.roughness) = match &packed {
        Some(_) => scalar(table.optional("roughness"), 1.0)?,
        None => scalar(Some(table.required("roughness")?), 1.0)?,
    };
    if let Some(field) = packed {
        if maps.metallic.is_some() || maps.roughness.is_some() {
            return Err(field.error(
                "holds both: let `metallic` and `roughness` be its factors, without textures",
            ));
        }
        let table = field.table()?;
        let map = textures.map(&table, ColourSpace::Linear)?;
        table.finish()?;
        let channel = |channel| {
            Some(ScalarMap {
                map: map.clone(),
                channel,
            })
        };
        (maps.roughness, maps.metallic) = (channel(1), channel(2));
    }
    Ok(MetallicRoughness {
        base_color,
        metallic,
        roughness,
        ior: table.optional("ior").map_or(Ok(1.5), |f| ior(&f))?,
        transmission,
        thin: table.optional("thin").map_or(Ok(false), |f| f.boolean())?,
    })
}

fn ior(field: &Field<'_>) -> Result<f32, Error> {
    let range = "an index of refraction from 0.1 to 10";
    field.number_that(|x| (0.1..=10.0).contains(&x), range)
}

fn roughness(table: &Table<'_>) -> Result<Option<f32>, Error> {
    let Some(field) = table.optional("roughness") else {
        return Ok(None);
    };
    let range = "0 (smooth) or a number from 0.001 to 1";
    let alpha = field.number_that(|x| x == 0.0 || (0.001..=1.0).contains(&x), range)?;
    Ok((alpha > 0.0).then_some(alpha))
}

/// The medium of a name, or several in the same place; `vacuum` is none.
pub(super) fn filling(field: &Field<'_>, media: &[&str]) -> Result<Filling, Error> {
    if !field.is_array() {
        let names: Vec<_> = ["vacuum"].iter().chain(media).copied().collect();
        let found = field.name_in("medium", &names)?.checked_sub(1);
        return Ok(found.into_iter().collect());
    }
    let names = field.elements()?;
    let found = names.iter().map(|name| name.name_in("medium", media));
    let mut filling: Filling = found.collect::<Result<_, _>>()?;
    filling.sort_unstable();
    match filling.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(field.error(format!("has {:?} twice: remove one", media[pair[0]]))),
        None => Ok(filling),
    }
}
