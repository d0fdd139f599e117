//! `[camera]`.

use super::film;
use super::material::filling;
use super::reader::{Field, Table};
use crate::camera::{Across, Camera, Lens, Pose};
use crate::media::Filling;
use crate::{Error, Place};
use glam::DVec3;

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
