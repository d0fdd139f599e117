//! `[[lights]]` and `[environment]`.

use super::reader::{Field, Table};
use crate::Error;
use crate::environment_image::EnvironmentImage;
use crate::files::Files;
use crate::light::{
    Beam, Directional, Environment, Light, Point, Sky, Source, Spot, cone_height, cone_power,
};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;
use tyndall_core::{MediumId, Rgb};

/// Reads a light; `origin` is the point that becomes 0. Media are found when the scene is built.
pub(super) fn read(field: &Field<'_>, origin: DVec3) -> Result<Light<Rgb>, Error> {
    let table = field.table()?;
    let kinds = ["point", "spot", "directional", "beam"];
    let kind = table.required("kind")?.one_of(&kinds)?;
    let medium = MediumId::VACUUM;
    let position = || Ok::<_, Error>((table.required("position")?.vector()? - origin).as_vec3());
    let (source, colour) = match kind {
        "point" => {
            let position = position()?;
            let light = Point { position, medium };
            (Source::Point(light), intensity(&table, 4.0 * PI)?)
        }
        "spot" => {
            let [inner, outer] = cones(&table)?;
            let light = Spot {
                position: position()?,
                axis: direction(&table)?,
                inner,
                outer,
                medium,
            };
            let colour = intensity(&table, cone_power(inner, outer))?;
            (Source::Spot(light), colour)
        }
        "directional" => {
            let direction = table.required("direction")?.direction()?.as_vec3();
            let light = Directional { direction };
            let colour = table.required("irradiance")?.colour()?;
            (Source::Directional(light), colour)
        }
        _ => {
            let light = Beam {
                position: position()?,
                direction: direction(&table)?,
                radius: table.required("radius")?.positive()?,
                medium,
            };
            (Source::Beam(light), table.required("power")?.colour()?)
        }
    };
    table.finish()?;
    Ok(Light { colour, source })
}

/// `[environment]`.
pub(super) fn read_environment(field: &Field<'_>, files: &Files) -> Result<Light<Rgb>, Error> {
    let table = field.table()?;
    let (light, is_image) = table.either("radiance", "file")?;
    let (colour, environment) = if is_image {
        let sky = read_sky(&light, &table, files)?;
        (Rgb::new(1.0, 1.0, 1.0), Environment::Image(Arc::new(sky)))
    } else {
        (light.colour()?, Environment::Constant)
    };
    table.finish()?;
    let source = Source::Environment(environment);
    Ok(Light { colour, source })
}

/// An image of the sky, and how it is turned.
fn read_sky(file: &Field<'_>, table: &Table<'_>, files: &Files) -> Result<Sky, Error> {
    let scale = table.optional("scale");
    let scale = scale.map_or(Ok(Rgb::new(1.0, 1.0, 1.0)), |f| f.colour())?;
    let up = table.optional("up");
    let up = up.map_or(Ok(DVec3::Y), |f| f.direction())?;
    let rotate = table.optional("rotate");
    let rotate = rotate.map_or(Ok(0.0), |f| f.number())?;
    let path = files.named(file.string()?);
    let image = EnvironmentImage::read(&path).map_err(|e| file.error(e))?;
    let image = image.scaled(scale).map_err(|e| file.error(e))?;
    Ok(Sky::new(image, up, rotate.to_radians()))
}

/// `intensity`, or `power` over the solid angle that it fills.
fn intensity(table: &Table<'_>, solid_angle: f32) -> Result<Rgb, Error> {
    let (field, is_intensity) = table.either("power", "intensity")?;
    let colour = field.colour()?;
    Ok(if is_intensity {
        colour
    } else {
        colour * (1.0 / solid_angle)
    })
}

/// `direction`, or that from `position` to `look_at`.
fn direction(table: &Table<'_>) -> Result<Vec3, Error> {
    let (field, is_look_at) = table.either("direction", "look_at")?;
    if !is_look_at {
        return Ok(field.direction()?.as_vec3());
    }
    let position = table.required("position")?.vector()?;
    let w = (field.vector()? - position).try_normalize();
    Ok(w.ok_or_else(|| field.error("must differ from `position`"))?
        .as_vec3())
}

/// Heights of the inner and the outer cone.
fn cones(table: &Table<'_>) -> Result<[f32; 2], Error> {
    let outer = table.required("cone_angle")?;
    let range = "an angle above 0 and up to 180 degrees";
    let outer = outer.number_that(|x| x as f32 > 0.0 && x <= 180.0, range)?;
    let inner = match table.optional("falloff_angle") {
        None => 0.75 * outer,
        Some(field) => {
            let range = format!("an angle from 0 to `cone_angle`, {outer} degrees");
            field.number_that(|x| (0.0..=outer).contains(&(x as f32)), &range)?
        }
    };
    Ok([inner, outer].map(|angle| cone_height(angle.to_radians())))
}
