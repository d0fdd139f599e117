//! `[media.NAME]`.

use super::reader::{Field, Table};
use crate::Error;
use crate::files::Files;
use crate::media::{Grid, MediumDescription};
use crate::vol::{Volume, read_vol};
use glam::DVec3;
use std::fmt::Display;
use tyndall_core::{Aabb, Coefficients, Rgb, Spectrum};
use tyndall_media::{DenseGrid, MediumError, Phase, Tracking};

/// Reads a medium; `files` gets those that it names, `origin` the point that becomes 0.
pub(super) fn read(
    field: &Field<'_>,
    files: &Files,
    origin: DVec3,
) -> Result<MediumDescription, Error> {
    let table = field.table()?;
    let kind = table.required("kind")?.one_of(&["homogeneous", "grid"])?;
    let phase = match table.optional("phase") {
        Some(field) => phase(&field)?,
        None => Phase::Isotropic,
    };
    let (coefficients, grid) = match kind {
        "homogeneous" => (homogeneous(&table)?, None),
        _ => grid(&table, files, origin)?,
    };
    table.finish()?;
    let description = MediumDescription {
        coefficients,
        phase,
        grid,
    };
    let built = description.build::<Rgb>();
    built.map_err(|e| match (&e, table.optional("albedo")) {
        (MediumError::Albedo { .. }, Some(albedo)) => of_file(&albedo, files, e),
        _ => field.error(e),
    })?;
    Ok(description)
}

fn colour_or_black(table: &Table<'_>, key: &'static str) -> Result<Rgb, Error> {
    table
        .optional(key)
        .map_or(Ok(Rgb::default()), |field| field.colour())
}

fn homogeneous(table: &Table<'_>) -> Result<Coefficients<Rgb>, Error> {
    table.expect(&["sigma_a", "sigma_s", "emission"]);
    Ok(Coefficients {
        sigma_a: table.required("sigma_a")?.colour()?,
        sigma_s: table.required("sigma_s")?.colour()?,
        emission: colour_or_black(table, "emission")?,
    })
}

fn grid(
    table: &Table<'_>,
    files: &Files,
    origin: DVec3,
) -> Result<(Coefficients<Rgb>, Option<Grid>), Error> {
    let sigma_t = table.required("scale")?.colour()?;
    let (density, bounds) = density(table, files, origin)?;
    let mut albedo = Rgb::default();
    let albedo_grid = match table.required("albedo")? {
        field if field.is_string() => Some(colours(&field, files, bounds)?),
        field => {
            albedo = field.fraction()?;
            None
        }
    };
    let mut emission = Rgb::default();
    let emission_grid = match table.optional("emission") {
        Some(field) if field.is_string() => Some(colours(&field, files, bounds)?),
        Some(field) => {
            emission = field.colour()?;
            None
        }
        None => None,
    };
    let tracking = match table.optional("transmittance") {
        Some(field) if field.one_of(&["ratio", "regular"])? == "regular" => Tracking::Regular,
        _ => Tracking::Ratio,
    };
    let coefficients = Coefficients {
        sigma_a: sigma_t * albedo.map(|a| 1.0 - a),
        sigma_s: sigma_t * albedo,
        emission,
    };
    let grid = Grid {
        density,
        albedo: albedo_grid,
        emission: emission_grid,
        tracking,
    };
    Ok((coefficients, Some(grid)))
}

/// The density, from a file or made, and its box.
fn density(table: &Table<'_>, files: &Files, origin: DVec3) -> Result<(DenseGrid, Aabb), Error> {
    let (source, made) = table.either("file", "plume")?;
    let corners = match (table.optional("min"), table.optional("max")) {
        (Some(min), Some(max)) => {
            let corners = [min.vector()?, max.vector()?];
            if !corners[0].cmplt(corners[1]).all() {
                return Err(max.error("must exceed `min` in x, y and z"));
            }
            Some(corners)
        }
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => {
            return Err(one.error("`min` and `max` go together: add the other"));
        }
    };
    let place = |[min, max]: [DVec3; 2]| Aabb {
        min: (min - origin).as_vec3(),
        max: (max - origin).as_vec3(),
    };
    if made {
        let corners =
            corners.ok_or_else(|| source.error("a plume needs `min` and `max`: add them"))?;
        let bounds = place(corners);
        return Ok((plume(&source, bounds)?, bounds));
    }
    let voxels = volume(&source, files)?;
    let bounds = place(corners.unwrap_or(voxels.bounds));
    if voxels.channels != 1 {
        let n = voxels.channels;
        let why = format!("has {n} channels, and a density has 1: write one of 1");
        return Err(of_file(&source, files, why));
    }
    let grid = DenseGrid::new(voxels.resolution, bounds, voxels.values);
    Ok((grid.map_err(|e| of_file(&source, files, e))?, bounds))
}

/// A procedural plume whose longest edge has `resolution` voxels.
fn plume(field: &Field<'_>, bounds: Aabb) -> Result<DenseGrid, Error> {
    let table = field.table()?;
    let resolution = table.required("resolution")?.integer(2, 512)?;
    let seed = (table.optional("seed")).map_or(Ok(0), |f| f.integer(0, i64::from(u32::MAX)))?;
    table.finish()?;
    let size = bounds.size();
    let voxels = (size / size.max_element() * resolution as f32).round();
    let counts = voxels.to_array().map(|n| (n as usize).max(1));
    tyndall_media::plume(counts, bounds, seed as u32).map_err(|e| field.error(e))
}

/// A grid of one or three channels, in the box of the density.
fn colours(field: &Field<'_>, files: &Files, bounds: Aabb) -> Result<DenseGrid<Rgb>, Error> {
    let voxels = volume(field, files)?;
    let values = match voxels.channels {
        1 => voxels.values.into_iter().map(Rgb::splat).collect(),
        3 => (voxels.values.chunks_exact(3))
            .map(|c| Rgb::new(c[0], c[1], c[2]))
            .collect(),
        n => {
            let why = format!("has {n} channels: write one of 1 or 3 channels");
            return Err(of_file(field, files, why));
        }
    };
    DenseGrid::new(voxels.resolution, bounds, values).map_err(|e| of_file(field, files, e))
}

fn volume(field: &Field<'_>, files: &Files) -> Result<Volume, Error> {
    read_vol(&files.named(field.string()?)).map_err(|e| field.error(e))
}

/// A complaint about the file that `field` names.
fn of_file(field: &Field<'_>, files: &Files, problem: impl Display) -> Error {
    let path = files.named(field.string().unwrap_or_default());
    field.error(format!("{}: {problem}", path.display()))
}

fn phase(field: &Field<'_>) -> Result<Phase, Error> {
    if field.is_string() {
        return Ok(match field.one_of(&["isotropic", "rayleigh"])? {
            "rayleigh" => Phase::Rayleigh(tyndall_media::Rayleigh),
            _ => Phase::Isotropic,
        });
    }
    let table = field.table()?;
    let kinds = [
        "isotropic",
        "rayleigh",
        "henyey_greenstein",
        "tabulated",
        "blend",
    ];
    let phase = match table.required("kind")?.one_of(&kinds)? {
        "isotropic" => Phase::Isotropic,
        "rayleigh" => Phase::Rayleigh(tyndall_media::Rayleigh),
        "henyey_greenstein" => {
            let g = table.required("g")?;
            Phase::henyey_greenstein(g.number()? as f32).map_err(|e| g.error(e))?
        }
        "tabulated" => {
            let cosines = numbers(&table.required("cosines")?)?;
            let values = numbers(&table.required("values")?)?;
            Phase::tabulated(&cosines, &values).map_err(|e| field.error(e))?
        }
        _ => {
            let parts = table.required("parts")?.elements()?;
            let parts: Result<_, _> = parts.iter().map(part).collect();
            Phase::blend(parts?).map_err(|e| field.error(e))?
        }
    };
    table.finish()?;
    Ok(phase)
}

fn part(field: &Field<'_>) -> Result<(f32, Phase), Error> {
    let table = field.table()?;
    let weight = table.required("weight")?.not_negative()?;
    let phase = phase(&table.required("phase")?)?;
    table.finish()?;
    Ok((weight, phase))
}

fn numbers(field: &Field<'_>) -> Result<Vec<f32>, Error> {
    let elements = field.elements()?;
    elements.iter().map(|x| Ok(x.number()? as f32)).collect()
}
