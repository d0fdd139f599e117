//! `[camera]` and `[integrator]`.

use super::film;
use super::material::filling;
use super::reader::{Field, Table};
use crate::camera::{Across, Camera, Lens, Pose};
use crate::media::Filling;
use crate::{Error, Place};
use glam::DVec3;

/// What `[integrator]` says: plain data, for the command to make an integrator of.
#[derive(Clone, Debug, PartialEq, Eq)]
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

/// The camera, and what is around it if it says.
pub(super) type View = (Camera, Option<(Filling, Place)>);

/// Reads the camera, over the film that `[film]` describes; `origin` is the point that becomes 0.
pub(super) fn read(
    camera: &Field<'_>,
    film: &Field<'_>,
    media: &[&str],
    origin: DVec3,
) -> Result<View, Error> {
    let film = film::read(film)?;
    let table = camera.table()?;
    let kind = table.optional("kind");
    let kind = kind.map(|f| f.one_of(&["pinhole", "thin_lens", "orthographic"]));
    let kind = kind.transpose()?.unwrap_or("pinhole");
    let position = table.required("position")?.vector()?;
    let (forward, up) = axes(&table, position)?;
    let pose = Pose::new(
        (position - origin).as_vec3(),
        forward.as_vec3(),
        up.as_vec3(),
    );
    let camera = if kind == "orthographic" {
        let (size, is_height) = table.either("width", "height")?;
        Camera::orthographic(pose, across(size.positive()?, is_height), film)
    } else {
        let lens = match kind {
            "thin_lens" => Some(lens(&table)?),
            _ => None,
        };
        let (fov, is_height) = table.either("fov", "vertical_fov")?;
        let range = "an angle between 0 and 180 degrees";
        let angle = fov.number_that(|x| x as f32 > 0.0 && (x as f32) < 180.0, range)?;
        Camera::perspective(pose, across(angle.to_radians(), is_height), lens, film)
    };
    let medium = match table.optional("medium") {
        Some(field) => Some((filling(&field, media)?, field.place())),
        None => None,
    };
    table.finish()?;
    Ok((camera, medium))
}

fn across(size: f32, is_height: bool) -> Across {
    if is_height {
        Across::Height(size)
    } else {
        Across::Width(size)
    }
}

fn lens(table: &Table<'_>) -> Result<Lens, Error> {
    Ok(Lens {
        radius: table.required("lens_radius")?.positive()?,
        focus_distance: table.required("focus_distance")?.positive()?,
    })
}

/// Where the camera looks, and up.
fn axes(table: &Table<'_>, position: DVec3) -> Result<(DVec3, DVec3), Error> {
    let target = table.required("look_at")?;
    let forward = (target.vector()? - position).try_normalize();
    let forward = forward.ok_or_else(|| target.error("must differ from `position`"))?;
    let Some(field) = table.optional("up") else {
        let up = if forward.y.abs() < 0.999 {
            DVec3::Y
        } else {
            DVec3::Z
        };
        return Ok((forward, up));
    };
    let up = field.direction()?;
    if forward.cross(up).length() < 1e-4 {
        return Err(field.error("must not be parallel to the view: choose another direction"));
    }
    Ok((forward, up))
}

/// Reads the integrator.
pub(super) fn read_integrator(field: Option<&Field<'_>>) -> Result<IntegratorConfig, Error> {
    let mut config = IntegratorConfig {
        name: "path".into(),
        max_depth: None,
        scattering: Scattering::Multiple,
        passes: None,
    };
    let Some(field) = field else {
        return Ok(config);
    };
    let table = field.table()?;
    if let Some(kind) = table.optional("kind") {
        config.name = kind.string()?.into();
    }
    if let Some(depth) = table.optional("max_depth") {
        config.max_depth = Some(depth.integer(1, i64::from(u32::MAX))? as u32);
    }
    if let Some(field) = table.optional("scattering") {
        config.scattering = match field.one_of(&["multiple", "single", "none"])? {
            "single" => Scattering::Single,
            "none" => Scattering::None,
            _ => Scattering::Multiple,
        };
    }
    if let Some(passes) = table.optional("passes") {
        config.passes = Some(passes.integer(1, i64::MAX)? as u64);
    }
    table.finish()?;
    Ok(config)
}
