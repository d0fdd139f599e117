//! `[integrator]`.

use super::reader::{Field, Table};
use crate::{Error, Place};
use tyndall_density::{Estimate, Kernel};

/// What `[integrator]` says: plain data, for the command to make an integrator of.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IntegratorConfig {
    /// Its name; `path` unless the file says otherwise.
    pub name: String,
    /// Longest path in bounces; `None` is unlimited.
    pub max_depth: Option<u32>,
    /// Which bounces in media count.
    pub scattering: Scattering,
    /// Passes to render unless told otherwise.
    pub passes: Option<u64>,
    /// What methods that gather photons are told.
    pub photons: PhotonConfig,
    /// The options that were set, and where: every key but `kind` and `passes`, which concern every
    /// method.
    pub set: Vec<(String, Place)>,
}

/// How often light may be scattered by media.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scattering {
    /// As often as it is.
    Multiple,
    /// Once: right for thin media.
    Single,
    /// Never: right for media that only absorb and emit.
    None,
}

/// Settings of methods that gather photons; `None` is the method's own default.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PhotonConfig {
    /// Light paths a pass.
    pub paths: Option<u64>,
    /// Mebibytes that the photons of a pass may take.
    pub memory: Option<u64>,
    /// The (starting) radius in scene units; never with `nearest`.
    pub radius: Option<f32>,
    /// The photons that a (starting) radius holds; never with `radius`.
    pub nearest: Option<usize>,
    /// No photon farther away is taken, in scene units.
    pub max_radius: Option<f32>,
    /// [`PhotonConfig::radius`] on surfaces, where it is another than in media.
    pub surface_radius: Option<f32>,
    /// [`PhotonConfig::nearest`] on surfaces, where it is another than in media.
    pub surface_nearest: Option<usize>,
    /// [`PhotonConfig::max_radius`] on surfaces, where it is another than in media.
    pub surface_max_radius: Option<f32>,
    /// How slowly radii shrink: the share of photons kept, in (0, 1].
    pub alpha: Option<f64>,
    /// The smoothing kernel.
    pub kernel: Option<Kernel>,
    /// Whether the lights are sampled for direct light, or photons bring it.
    pub sample_lights: Option<bool>,
    /// Walks of final gathering.
    pub final_gather: Option<u32>,
    /// Whether radii follow the statistics of each pixel.
    pub statistics: Option<bool>,
    /// Dimensions over which photons along a ray are smoothed: 2 or 3.
    pub blur: Option<u8>,
    /// Whether transmittance along a ray is found by flights, or by a table.
    pub tracking: Option<bool>,
    /// How photon points and beams are estimated.
    pub estimator: Option<Estimate>,
    /// The (starting) radius of photon beams, the largest if they differ, in scene units.
    pub beam_radius: Option<f32>,
    /// Radius of photon beams by differentials, over that of a path's own light.
    pub beam_differentials: Option<f32>,
    /// Ends of others that the radius at an end of a photon beam reaches.
    pub beam_nearest: Option<usize>,
    /// Whether photon beams end where light collides.
    pub short_light_beams: Option<bool>,
    /// Whether beams of sight end where they would collide.
    pub short_sight_beams: Option<bool>,
    /// Free flights along a long photon beam in media that vary.
    pub light_flights: Option<u32>,
}

/// The smoothing kernels.
const KERNELS: [Kernel; 5] = [
    Kernel::Constant,
    Kernel::Epanechnikov,
    Kernel::Biweight,
    Kernel::Cone,
    Kernel::Gaussian,
];

impl IntegratorConfig {
    /// Of a file that has no `[integrator]`.
    fn absent() -> Self {
        Self {
            name: "path".into(),
            max_depth: None,
            scattering: Scattering::Multiple,
            passes: None,
            photons: PhotonConfig::default(),
            set: Vec::new(),
        }
    }
}

/// Reads the integrator.
pub(super) fn read(field: Option<&Field<'_>>) -> Result<IntegratorConfig, Error> {
    let mut config = IntegratorConfig::absent();
    let Some(field) = field else {
        return Ok(config);
    };
    let table = field.table()?;
    if let Some(kind) = table.optional("kind") {
        config.name = kind.string()?.into();
    }
    if let Some(depth) = count(&table, "max_depth", 1, u32::MAX.into())? {
        config.max_depth = Some(depth as u32);
    }
    if let Some(field) = table.optional("scattering") {
        config.scattering = match field.one_of(&["multiple", "single", "none"])? {
            "single" => Scattering::Single,
            "none" => Scattering::None,
            _ => Scattering::Multiple,
        };
    }
    config.passes = count(&table, "passes", 1, i64::MAX)?;
    config.photons = read_photons(&table)?;
    table.finish()?;
    let options = (table.keys()).filter(|(key, _)| !["kind", "passes"].contains(key));
    config.set = options
        .map(|(k, place)| (k.into(), place.clone()))
        .collect();
    Ok(config)
}

/// A radius, or how it is found.
struct Radii {
    radius: Option<f32>,
    nearest: Option<usize>,
    max_radius: Option<f32>,
}

impl Radii {
    /// From keys for each.
    fn read(table: &Table<'_>, keys: [&'static str; 3]) -> Result<Self, Error> {
        let [radius, nearest, max_radius] = keys.map(|key| table.optional(key));
        for (key, other) in [(keys[1], &nearest), (keys[2], &max_radius)] {
            if let (Some(_), Some(other)) = (&radius, other) {
                return Err(other.error(format!(
                    "`{}` and `{key}` exclude each other: remove one",
                    keys[0]
                )));
            }
        }
        Ok(Self {
            radius: radius.map(|field| field.positive()).transpose()?,
            max_radius: max_radius.map(|field| field.positive()).transpose()?,
            nearest: count(table, keys[1], 2, 1 << 20)?.map(|n| n as usize),
        })
    }
}

fn read_photons(table: &Table<'_>) -> Result<PhotonConfig, Error> {
    let media = Radii::read(table, ["radius", "nearest", "max_radius"])?;
    let surfaces = ["surface_radius", "surface_nearest", "surface_max_radius"];
    let surfaces = Radii::read(table, surfaces)?;
    let alpha = table.optional("alpha").map(|field| {
        let range = "a number above 0 and at most 1";
        (field.number_that(|x| x as f32 > 0.0 && x <= 1.0, range)).and_then(|_| field.number())
    });
    let chosen = |key, words: &[&str]| {
        let field = table.optional(key);
        field.map(|field| field.name_in("value", words)).transpose()
    };
    let truth = |key| {
        let field = table.optional(key);
        field.map(|field| field.boolean()).transpose()
    };
    let kernels = KERNELS.map(|kernel| kernel.to_string());
    let estimators = Estimate::ALL.map(|estimate| estimate.to_string());
    let beam_radius = table.optional("beam_radius");
    let differentials = table.optional("beam_differentials");
    if let (Some(_), Some(other)) = (&differentials, table.optional("beam_nearest")) {
        let why = "`beam_differentials` and `beam_nearest` exclude each other: remove one";
        return Err(other.error(why));
    }
    Ok(PhotonConfig {
        paths: count(table, "paths", 1, 1 << 32)?,
        memory: count(table, "memory", 1, 1 << 40)?,
        radius: media.radius,
        nearest: media.nearest,
        max_radius: media.max_radius,
        surface_radius: surfaces.radius,
        surface_nearest: surfaces.nearest,
        surface_max_radius: surfaces.max_radius,
        alpha: alpha.transpose()?,
        kernel: chosen("kernel", &kernels.each_ref().map(String::as_str))?.map(|i| KERNELS[i]),
        sample_lights: truth("sample_lights")?,
        final_gather: count(table, "final_gather", 1, 1 << 20)?.map(|n| n as u32),
        statistics: truth("statistics")?,
        blur: count(table, "blur", 2, 3)?.map(|n| n as u8),
        tracking: chosen("transmittance", &["table", "tracking"])?.map(|i| i == 1),
        estimator: chosen("estimator", &estimators.each_ref().map(String::as_str))?
            .map(|i| Estimate::ALL[i]),
        beam_radius: beam_radius.map(|field| field.positive()).transpose()?,
        beam_differentials: differentials.map(|field| field.positive()).transpose()?,
        beam_nearest: count(table, "beam_nearest", 2, 1 << 20)?.map(|n| n as usize),
        short_light_beams: chosen("light_beams", &["long", "short"])?.map(|i| i == 1),
        short_sight_beams: chosen("sight_beams", &["long", "short"])?.map(|i| i == 1),
        light_flights: count(table, "light_flights", 1, 1 << 10)?.map(|n| n as u32),
    })
}

/// A whole number, if the key is there.
fn count(table: &Table<'_>, key: &'static str, min: i64, max: i64) -> Result<Option<u64>, Error> {
    let field = table.optional(key);
    let number = field.map(|field| field.integer(min, max)).transpose()?;
    Ok(number.map(|n| n as u64))
}
