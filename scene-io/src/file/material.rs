//! `[materials.NAME]`.

use super::reader::{Field, Table};
use crate::Error;
use crate::material::{Bsdf, Maps, MetallicRoughness, RoughConductor};
use tyndall_core::Rgb;

/// A material as the scene file describes it; media by their index.
#[derive(Clone, Debug)]
pub(crate) struct Material {
    pub(crate) bsdf: Bsdf<Rgb>,
    /// Radiance emitted on the side of the normal.
    pub(crate) emission: Rgb,
    pub(crate) maps: Maps,
    pub(crate) inside: MediumName,
    /// What lies around the surface where no other shape contains it, if the file says.
    pub(crate) outside: Option<MediumName>,
    pub(crate) priority: i32,
}

/// A medium, or vacuum.
pub(crate) type MediumName = Option<usize>;

impl Material {
    /// One that light does not enter.
    pub(crate) fn opaque(bsdf: Bsdf<Rgb>, emission: Rgb) -> Self {
        Self {
            bsdf,
            emission,
            maps: Maps::default(),
            inside: None,
            outside: None,
            priority: 0,
        }
    }
}

const KINDS: [&str; 5] = ["diffuse", "mirror", "dielectric", "conductor", "null"];

/// Reads a material; `media` are the names of the scene's media.
pub(super) fn read(field: &Field<'_>, media: &[&str]) -> Result<Material, Error> {
    let table = field.table()?;
    let bsdf = bsdf(&table)?;
    let emission = (table.optional("emission")).map_or(Ok(Rgb::default()), |f| f.colour())?;
    let mut material = Material::opaque(bsdf, emission);
    if bsdf.transmits() {
        if let Some(name) = table.optional("inside") {
            material.inside = medium_name(&name, media)?;
        }
        if let Some(name) = table.optional("outside") {
            material.outside = Some(medium_name(&name, media)?);
        }
        if let Some(priority) = table.optional("priority") {
            material.priority = priority.integer(i32::MIN.into(), i32::MAX.into())? as i32;
        }
    }
    table.finish()?;
    Ok(material)
}

fn bsdf(table: &Table<'_>) -> Result<Bsdf<Rgb>, Error> {
    Ok(match table.required("kind")?.one_of(&KINDS)? {
        "diffuse" => Bsdf::Diffuse(table.required("reflectance")?.fraction()?),
        "mirror" => Bsdf::Mirror(match table.optional("reflectance") {
            Some(field) => field.fraction()?,
            None => Rgb::new(1.0, 1.0, 1.0),
        }),
        "dielectric" => {
            let ior = (table.required("ior")?).number_that(
                |x| (0.1..=10.0).contains(&x),
                "an index of refraction from 0.1 to 10",
            )?;
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
        _ => Bsdf::Null,
    })
}

fn roughness(table: &Table<'_>) -> Result<Option<f32>, Error> {
    let Some(field) = table.optional("roughness") else {
        return Ok(None);
    };
    let range = "0 (smooth) or a number from 0.001 to 1";
    let alpha = field.number_that(|x| x == 0.0 || (0.001..=1.0).contains(&x), range)?;
    Ok((alpha > 0.0).then_some(alpha))
}

/// The medium of this name; `vacuum` is none.
pub(super) fn medium_name(field: &Field<'_>, media: &[&str]) -> Result<MediumName, Error> {
    let names: Vec<_> = ["vacuum"].iter().chain(media).copied().collect();
    Ok(field.name_in("medium", &names)?.checked_sub(1))
}
