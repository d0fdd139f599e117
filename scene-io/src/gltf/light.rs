//! `KHR_lights_punctual`: they shine along −z of their node.

use super::document::Document;
use super::node::Placed;
use crate::Error;
use crate::light::{Directional, Light, Point, Source, Spot, cone_height};
use glam::{DVec3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Punctual, Type};
use gltf::json::validation::Checked;
use std::f32::consts::FRAC_PI_2;
use tyndall_core::{MediumId, Rgb};

/// A light, in `f64`.
#[derive(Clone, Debug)]
pub(crate) struct Lamp {
    position: DVec3,
    direction: Vec3,
    kind: Kind,
    /// Intensity in W/sr, or irradiance in W·m⁻².
    colour: Rgb,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Point,
    /// Angles from the axis, in radians.
    Spot {
        inner: f32,
        outer: f32,
    },
    Directional,
}

impl Lamp {
    /// The light as it is rendered, `origin` being moved to 0.
    pub(crate) fn place(&self, origin: DVec3) -> Light<Rgb> {
        let medium = MediumId::VACUUM;
        let position = (self.position - origin).as_vec3();
        let source = match self.kind {
            Kind::Point => Source::Point(Point { position, medium }),
            Kind::Spot { inner, outer } => Source::Spot(Spot {
                position,
                axis: self.direction,
                inner: cone_height(inner),
                outer: cone_height(outer),
                medium,
            }),
            Kind::Directional => Source::Directional(Directional {
                direction: self.direction,
            }),
        };
        let colour = self.colour;
        Light { colour, source }
    }
}

/// The lights of the nodes. `efficacy` is how many lumens are a watt, `scale` that of the lengths of
/// the file: intensities grow with its square, so that what they light looks the same.
pub(super) fn read(
    document: &Document,
    nodes: &[Placed],
    efficacy: f64,
    scale: f64,
) -> Result<Vec<Lamp>, Error> {
    let root = &document.root;
    let extension = (root.extensions.as_ref()).and_then(|e| e.khr_lights_punctual.as_ref());
    let all = extension.map_or(&[][..], |e| &e.lights);
    let mut lamps = Vec::new();
    for placed in nodes {
        let node = &root.nodes[placed.node];
        let reference = node
            .extensions
            .as_ref()
            .and_then(|e| e.khr_lights_punctual.as_ref());
        let Some(index) = reference.map(|r| r.light.value()) else {
            continue;
        };
        let field = format!("extensions.KHR_lights_punctual.lights[{index}]");
        let kind = kind(document, &all[index], &field)?;
        let factor = match kind {
            Kind::Directional => 1.0 / efficacy,
            Kind::Point | Kind::Spot { .. } => scale * scale / efficacy,
        };
        let colour = colour(document, &all[index], factor, &field)?;
        let direction = (-placed.to_world.matrix3.z_axis).try_normalize();
        let direction = direction.ok_or_else(|| {
            let why = "flattens its light: mend its transformation";
            document.error(format!("nodes[{}]", placed.node), why)
        })?;
        lamps.push(Lamp {
            position: placed.to_world.translation,
            direction: direction.as_vec3(),
            kind,
            colour,
        });
    }
    Ok(lamps)
}

fn kind(document: &Document, light: &Punctual, field: &str) -> Result<Kind, Error> {
    Ok(match light.type_ {
        Checked::Valid(Type::Directional) => Kind::Directional,
        Checked::Valid(Type::Spot) => {
            let spot = light.spot.as_ref();
            let inner = spot.map_or(0.0, |s| s.inner_cone_angle);
            let outer = spot.map_or(0.5 * FRAC_PI_2, |s| s.outer_cone_angle);
            // Exporters round angles to single precision, and a cone may be as wide as its rim.
            if !(0.0 <= inner && inner <= outer && 0.0 < outer && outer <= FRAC_PI_2 + 1e-5) {
                let why = "must have 0 ≤ innerConeAngle ≤ outerConeAngle ≤ π/2: export again";
                return Err(document.error(format!("{field}.spot"), why));
            }
            Kind::Spot { inner, outer }
        }
        _ => Kind::Point,
    })
}

fn colour(document: &Document, light: &Punctual, factor: f64, field: &str) -> Result<Rgb, Error> {
    let [r, g, b] = light
        .color
        .map(|c| (f64::from(c) * f64::from(light.intensity) * factor) as f32);
    let colour = Rgb::new(r, g, b);
    if colour.0.min_element() >= 0.0 && colour.0.is_finite() {
        return Ok(colour);
    }
    let why = "color times intensity must be finite and not negative: export again";
    Err(document.error(field, why))
}
