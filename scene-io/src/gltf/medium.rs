//! What fills closed shapes: `KHR_materials_volume`, its draft of scattering, and the extras
//! `tyndall`.

use super::document::Document;
use crate::Error;
use crate::media::{Density, MediumDescription};
use glam::DVec3;
use gltf::json::Material;
use gltf::json::extensions::material::Volume;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::Phase;

const SCATTER: &str = "KHR_materials_volume_scatter";

/// What `extras.tyndall` of a material may hold; coefficients in 1/length of the file.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Extras {
    /// `"none"`: the surface is not seen, it bounds the medium.
    pub(super) surface: Option<Surface>,
    #[serde(default)]
    pub(super) priority: i32,
    sigma_a: Option<Colour>,
    sigma_s: Option<Colour>,
    emission: Option<Colour>,
    g: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Surface {
    None,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
enum Colour {
    Grey(f32),
    Rgb([f32; 3]),
}

impl Colour {
    fn rgb(self) -> Rgb {
        match self {
            Self::Grey(x) => Rgb::new(x, x, x),
            Self::Rgb([r, g, b]) => Rgb::new(r, g, b),
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Scatter {
    multiscatter_color: [f32; 3],
    scatter_anisotropy: f32,
}

impl Default for Scatter {
    fn default() -> Self {
        let (multiscatter_color, scatter_anisotropy) = ([0.0; 3], 0.0);
        Self {
            multiscatter_color,
            scatter_anisotropy,
        }
    }
}

/// The extras of a material, if it has any of ours.
pub(super) fn extras(
    document: &Document,
    material: &Material,
    field: &str,
) -> Result<Option<Extras>, Error> {
    let all = material.extras.as_ref();
    let all = all.and_then(|raw| serde_json::from_str::<serde_json::Value>(raw.get()).ok());
    match all.as_ref().and_then(|all| all.get("tyndall")) {
        None => Ok(None),
        Some(value) => parse(document, value, &format!("{field}.extras.tyndall")).map(Some),
    }
}

fn parse<T: DeserializeOwned>(
    document: &Document,
    value: &serde_json::Value,
    field: &str,
) -> Result<T, Error> {
    serde_json::from_value(value.clone())
        .map_err(|e| document.error(field, format!("{e}: see the documentation of scene files")))
}

/// Whether a material means a body rather than a sheet: by its thickness, or because it says what
/// else than absorption there is inside.
pub(super) fn is_body(material: &Material, extras: Option<&Extras>, drafts: bool) -> bool {
    let extensions = material.extensions.as_ref();
    let volume = extensions.and_then(|e| e.volume.as_ref());
    let thick = volume.is_some_and(|v| v.thickness_factor.0 > 0.0);
    let scatters = drafts && extensions.is_some_and(|e| e.others.contains_key(SCATTER));
    let said = |e: &Extras| {
        [e.sigma_a, e.sigma_s, e.emission]
            .iter()
            .any(Option::is_some)
    };
    thick || scatters || extras.is_some_and(said)
}

/// The medium inside of a material, coefficients over `scale`; `None` for vacuum.
pub(super) fn read(
    document: &Document,
    material: &Material,
    extras: Option<&Extras>,
    (scale, drafts): (f64, bool),
    field: &str,
) -> Result<Option<MediumDescription>, Error> {
    let extensions = material.extensions.as_ref();
    let volume = extensions.and_then(|e| e.volume.as_ref());
    let sigma_t = volume.map_or(Ok(Rgb::default()), |v| extinction(document, v, field))?;
    let mut medium = Coefficients {
        sigma_a: sigma_t,
        sigma_s: Rgb::default(),
        emission: Rgb::default(),
    };
    let mut g = 0.0;
    let scatter = extensions.and_then(|e| e.others.get(SCATTER));
    if let Some(value) = scatter.filter(|_| drafts) {
        let field = format!("{field}.extensions.{SCATTER}");
        let scatter: Scatter = parse(document, value, &field)?;
        let [r, g_, b] = scatter.multiscatter_color;
        let colour = Rgb::new(r, g_, b);
        if !(colour.0.min_element() >= 0.0 && colour.0.max_element() <= 1.0) {
            let why = "must be from 0 to 1: export again";
            return Err(document.error(format!("{field}.multiscatterColor"), why));
        }
        medium.sigma_s = sigma_t * colour.map(single_scatter_albedo);
        medium.sigma_a = sigma_t * colour.map(|c| 1.0 - single_scatter_albedo(c));
        g = scatter.scatter_anisotropy;
    }
    if let Some(extras) = extras {
        let replace = |old: &mut Rgb, new: Option<Colour>| *old = new.map_or(*old, Colour::rgb);
        replace(&mut medium.sigma_a, extras.sigma_a);
        replace(&mut medium.sigma_s, extras.sigma_s);
        replace(&mut medium.emission, extras.emission);
        g = extras.g.unwrap_or(g);
    }
    let per_unit = |c: Rgb| c * (1.0 / scale) as f32;
    let coefficients = Coefficients {
        sigma_a: per_unit(medium.sigma_a),
        sigma_s: per_unit(medium.sigma_s),
        emission: per_unit(medium.emission),
    };
    if coefficients.sigma_t().is_black() && coefficients.emission.is_black() {
        return Ok(None);
    }
    let fault = |e: tyndall_media::MediumError| document.error(field, e);
    let phase = match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).map_err(fault)?,
    };
    let description = MediumDescription {
        coefficients,
        phase,
        density: Density::Constant,
    };
    description.build::<Rgb>(DVec3::ZERO).map_err(fault)?;
    Ok(Some(description))
}

/// σt = −ln(colour)/distance; a black channel counts as one that lets 10⁻³⁸ pass.
fn extinction(document: &Document, volume: &Volume, field: &str) -> Result<Rgb, Error> {
    let field = format!("{field}.extensions.KHR_materials_volume");
    let distance = volume.attenuation_distance.0;
    if distance <= 0.0 {
        let why = "must be above 0: export again";
        return Err(document.error(format!("{field}.attenuationDistance"), why));
    }
    let [r, g, b] = volume.attenuation_color.0;
    let colour = Rgb::new(r, g, b);
    if !(colour.0.min_element() >= 0.0 && colour.0.max_element() <= 1.0) {
        let why = "must be from 0 to 1: export again";
        return Err(document.error(format!("{field}.attenuationColor"), why));
    }
    Ok(colour.map(|c| -c.max(f32::MIN_POSITIVE).ln().min(0.0) / distance))
}

/// The albedo of one scattering that gives a half space of isotropic scatterers the colour `c`
/// (Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", as the draft of the
/// extension has it).
fn single_scatter_albedo(c: f32) -> f32 {
    let c = f64::from(c);
    let root = (9.59217 + 41.6808 * c + 17.7126 * c * c).sqrt();
    let s = 4.09712 + 4.20863 * c - root;
    (1.0 - s * s).clamp(0.0, 1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black stays black and white white, and in between the albedo is above the colour.
    #[test]
    fn albedos_of_one_scattering_lie_above_those_of_many() {
        assert!(single_scatter_albedo(0.0) < 1e-2);
        assert!(single_scatter_albedo(1.0) > 0.999);
        let mut last = 0.0;
        for i in 1..10 {
            let c = 0.1 * i as f32;
            let albedo = single_scatter_albedo(c);
            assert!(albedo > c && albedo > last && albedo < 1.0, "{c}: {albedo}");
            last = albedo;
        }
    }
}
