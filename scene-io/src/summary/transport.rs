//! Which transport a scene needs, and why.

use super::geometry::kind_of;
use super::{GeometrySummary, MediumSummary};
use crate::file::Part;
use crate::light::Source;
use crate::{Scattering, Scene, SceneFile};
use serde::Serialize;
use std::f32::consts::PI;
use tyndall_core::{Spectrum, SurfaceKind};

/// What an integrator has to do for a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TransportSummary {
    /// What media ask for.
    pub needed: Needed,
    /// Of the light that crosses a medium the longest way, the largest share that is scattered. It
    /// estimates the share of the light that media scatter which single scattering leaves out; no
    /// bound, for what crosses media several times (between bright walls, say) is scattered more.
    pub scattered_share: f32,
    /// Whether light is focused by smooth surfaces, and whether path tracing finds it.
    pub caustics: Caustics,
    /// The share of all directions in which the smallest lamp lies, seen from a smooth surface;
    /// `None` without both.
    pub lamp_share: Option<f32>,
    /// Whether connections must walk through surfaces that light passes straight.
    pub null_surfaces: bool,
    /// The same in sentences, with numbers and settings.
    pub advice: Vec<String>,
}

/// What media ask of an integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Needed {
    /// Nothing: there are none.
    Vacuum,
    /// Absorption (and emission) alone.
    Absorption,
    /// Light that is scattered once; more changes little, by estimate.
    Single,
    /// Light that is scattered again and again.
    Multiple,
}

/// Light that smooth surfaces focus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Caustics {
    /// None.
    None,
    /// Of lamps large enough for path tracing to meet them by chance.
    Found,
    /// Of lamps so small that path tracing seldom meets them: the image is noisy.
    Noisy,
    /// Of lights that no ray meets: path tracing leaves them out.
    Missing,
}

/// A share of scattered light that may be left out.
const LITTLE: f32 = 0.03;

/// A lamp in a smaller share of all directions makes noise.
const SMALL: f32 = 0.01;

pub(super) fn judge<S: Spectrum>(
    file: &SceneFile,
    scene: &Scene<S>,
    media: &[MediumSummary],
    geometry: &GeometrySummary,
) -> TransportSummary {
    let shares = media.iter().filter(|m| m.matters());
    let shares = shares.map(|m| (m, m.scattered_share()));
    let most = shares.max_by(|(_, a), (_, b)| a.total_cmp(b));
    let needed = match most {
        None => Needed::Vacuum,
        Some((_, 0.0)) => Needed::Absorption,
        Some((_, share)) if share < LITTLE => Needed::Single,
        Some(_) => Needed::Multiple,
    };
    let lamp_share = smallest_lamp(file, scene);
    let unhittable = scene.lights.powers().any(|(source, _)| unhittable(source));
    let caustics = match lamp_share {
        _ if geometry.delta_shapes == 0 => Caustics::None,
        _ if unhittable => Caustics::Missing,
        Some(share) if share < SMALL => Caustics::Noisy,
        Some(_) => Caustics::Found,
        None => Caustics::None,
    };
    let mut transport = TransportSummary {
        needed,
        scattered_share: most.map_or(0.0, |(_, share)| share),
        caustics,
        lamp_share,
        null_surfaces: scene.has_null_surfaces,
        advice: Vec::new(),
    };
    transport.advice = [
        of_media(needed, most, file.integrator().scattering),
        of_caustics(caustics, lamp_share, geometry),
        of_null_surfaces(scene.has_null_surfaces, geometry),
        of_channels(file),
    ]
    .into_iter()
    .flatten()
    .collect();
    transport
}

/// Whether rays never meet it.
fn unhittable(source: &Source) -> bool {
    matches!(
        source,
        Source::Point(_) | Source::Spot(_) | Source::Directional(_) | Source::Beam(_)
    )
}

/// The share of the sphere that the smallest emissive shape fills, seen from the middle of the
/// smooth shape that is nearest to it: A/(4π·d²), at most 1. An environment fills all of it.
fn smallest_lamp<S: Spectrum>(file: &SceneFile, scene: &Scene<S>) -> Option<f32> {
    let smooth = |part: &&Part| kind_of(file, part.material) == SurfaceKind::Delta;
    let smooth: Vec<_> = file
        .parts
        .iter()
        .filter(smooth)
        .map(|p| p.bounds.center())
        .collect();
    let mut shapes: Vec<(u32, f32)> = Vec::new();
    let mut shares = Vec::new();
    for (source, _) in scene.lights.powers() {
        match (source, shapes.last_mut()) {
            (Source::Environment(_), _) if !smooth.is_empty() => shares.push(1.0),
            (Source::Area(area), Some((shape, sum))) if *shape == area.shape => *sum += area.area,
            (Source::Area(area), _) => shapes.push((area.shape, area.area)),
            _ => {}
        }
    }
    for (shape, area) in shapes {
        let lamp = file.parts[shape as usize].bounds.center();
        let distances = smooth.iter().map(|p| p.distance_squared(lamp));
        shares.extend(
            distances
                .reduce(f32::min)
                .map(|d2| area / (4.0 * PI * d2).max(area)),
        );
    }
    shares.into_iter().reduce(f32::min)
}

fn of_media(
    needed: Needed,
    most: Option<(&MediumSummary, f32)>,
    set: Scattering,
) -> Option<String> {
    let Some((medium, share)) = most else {
        return Some("no light meets a medium: media cost nothing here".into());
    };
    let why = format!(
        "{:?} scatters up to {:.2} % of the light that crosses it once (optical depth {:.3}, albedo \
         {:.3})",
        medium.name,
        100.0 * share,
        medium.optical_depth,
        medium.largest_albedo(),
    );
    Some(match (needed, set) {
        (Needed::Vacuum | Needed::Absorption, Scattering::None) => return None,
        (Needed::Vacuum | Needed::Absorption, _) => {
            "media absorb and do not scatter: `scattering = \"none\"` gives the same image for less"
                .into()
        }
        (Needed::Single, Scattering::None) | (Needed::Multiple, Scattering::None) => {
            format!("{why}, which `scattering = \"none\"` leaves out")
        }
        (Needed::Single, Scattering::Single) => {
            format!("{why}: single scattering is about enough")
        }
        (Needed::Single, Scattering::Multiple) => format!(
            "{why}: `scattering = \"single\"` leaves out about that share of what media scatter, and \
             more where light crosses media again and again (bright walls, many media)"
        ),
        (Needed::Multiple, Scattering::Single) => {
            format!("{why}: multiple scattering counts, which `scattering = \"single\"` leaves out")
        }
        (Needed::Multiple, Scattering::Multiple) => {
            format!("{why}: multiple scattering counts")
        }
    })
}

fn of_caustics(
    caustics: Caustics,
    lamp_share: Option<f32>,
    geometry: &GeometrySummary,
) -> Option<String> {
    let shapes = geometry.delta_shapes;
    let percent = 100.0 * lamp_share.unwrap_or(0.0);
    Some(match caustics {
        Caustics::None => return None,
        Caustics::Missing => format!(
            "smooth surfaces (shapes: {shapes}) focus the light of point, spot, directional or beam \
             lights, which no path from the camera meets: `path` leaves these caustics out; give \
             the lights a size (an emissive sphere or disk)"
        ),
        Caustics::Noisy => format!(
            "smooth surfaces (shapes: {shapes}) focus light of a lamp that fills {percent:.3} % of \
             their directions: `path` finds these caustics by chance, with noise; a larger lamp \
             or roughness helps"
        ),
        Caustics::Found => format!(
            "smooth surfaces (shapes: {shapes}) focus light; the smallest lamp fills {percent:.1} % \
             of their directions, enough for `path`"
        ),
    })
}

fn of_null_surfaces(null_surfaces: bool, geometry: &GeometrySummary) -> Option<String> {
    null_surfaces.then(|| {
        format!(
            "light may pass surfaces straight (shapes that only bound media: {}): shadow rays walk \
             through them one by one",
            geometry.null_shapes
        )
    })
}

fn of_channels(file: &SceneFile) -> Option<String> {
    file.is_grey()
        .then(|| "every colour is grey: one channel is carried instead of three".into())
}
