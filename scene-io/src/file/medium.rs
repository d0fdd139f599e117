//! `[media.NAME]`.

use super::reader::{Field, Table};
use super::shape::transform;
use super::volume::{Placing, Source, UNIT, Volumes};
use crate::Error;
use crate::media::{Boxed, Colours, Density, Glow, Grid, MediumDescription, Scalars};
use glam::{DAffine3, DVec3};
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::{BlackBody, Filter, Phase, Tracking};

/// Reads a medium, and the volume files that it names.
pub(super) fn read(field: &Field<'_>, volumes: &Volumes<'_>) -> Result<MediumDescription, Error> {
    let table = field.table()?;
    let kind = table
        .required("kind")?
        .one_of(&["homogeneous", "atmosphere", "grid"])?;
    let phase = match table.optional("phase") {
        Some(field) => phase(&field)?,
        None => Phase::Isotropic,
    };
    let (coefficients, density) = match kind {
        "homogeneous" => (coefficients(&table)?, Density::Constant),
        "atmosphere" => (coefficients(&table)?, atmosphere(&table)?),
        _ => {
            let (coefficients, grid) = grid(&table, volumes)?;
            (coefficients, Density::Grid(Box::new(grid)))
        }
    };
    table.finish()?;
    Ok(MediumDescription {
        coefficients,
        phase,
        density,
    })
}

fn colour_or_black(table: &Table<'_>, key: &'static str) -> Result<Rgb, Error> {
    table
        .optional(key)
        .map_or(Ok(Rgb::default()), |field| field.colour())
}

fn coefficients(table: &Table<'_>) -> Result<Coefficients<Rgb>, Error> {
    table.expect(&["sigma_a", "sigma_s", "emission"]);
    Ok(Coefficients {
        sigma_a: table.required("sigma_a")?.colour()?,
        sigma_s: table.required("sigma_s")?.colour()?,
        emission: colour_or_black(table, "emission")?,
    })
}

fn atmosphere(table: &Table<'_>) -> Result<Density, Error> {
    let vector = |key| table.optional(key).map(|f| f.vector()).transpose();
    let up = table.optional("up").map(|f| f.direction()).transpose()?;
    Ok(Density::Exponential {
        origin: vector("origin")?.unwrap_or(DVec3::ZERO),
        up: up.unwrap_or(DVec3::Y),
        scale_height: table.required("scale_height")?.positive()?,
    })
}

fn grid<'a>(table: &Table<'a>, volumes: &Volumes<'_>) -> Result<(Coefficients<Rgb>, Grid), Error> {
    let sigma_t = table.required("scale")?.colour()?;
    let (density, source, placing) = density(table, volumes)?;
    let other = source.as_ref().filter(|source| !source.is_dense());
    let colours = |field: &Field<'a>, usual| colours(field, usual, other, (volumes, &placing));
    let varies = |field: &Field<'_>| field.is_string() || field.is_table();
    let (mut albedo, mut albedo_grid) = (Rgb::default(), None);
    match table.required("albedo")? {
        field if varies(&field) => {
            let (grid, source) = colours(&field, "albedo")?;
            let Rgb(most) = grid.max();
            if most.max_element() > 1.0 {
                let why = format!("its largest albedo is {most}: make it at most 1 by `factor`");
                return Err(volumes.fault(&source, why));
            }
            albedo_grid = Some(grid);
        }
        field => albedo = field.fraction()?,
    }
    let (mut emission, mut glow) = (Rgb::default(), None);
    match (table.optional("emission"), table.optional("temperature")) {
        (Some(_), Some(both)) => {
            return Err(both.error("`emission` and `temperature` exclude each other: remove one"));
        }
        (Some(field), None) if varies(&field) => {
            glow = Some(Glow::Emission(colours(&field, "emission")?.0));
        }
        (Some(field), None) => emission = field.colour()?,
        (None, Some(field)) => glow = Some(heat(&field, other, volumes, &placing)?),
        (None, None) => {}
    }
    let tracking = match density {
        Scalars::Dense(_) => tracking(table)?,
        Scalars::Sparse(_) => Tracking::Ratio,
    };
    let coefficients = Coefficients {
        sigma_a: sigma_t * albedo.map(|a| 1.0 - a),
        sigma_s: sigma_t * albedo,
        emission,
    };
    let grid = Grid {
        density,
        albedo: albedo_grid,
        glow,
        tracking,
    };
    Ok((coefficients, grid))
}

/// A grid of colours, and where it is from.
fn colours<'a>(
    field: &Field<'a>,
    usual: &'static str,
    other: Option<&Source<'a>>,
    (volumes, placing): (&Volumes<'_>, &Placing),
) -> Result<(Colours, Source<'a>), Error> {
    let (source, factor) = if field.is_table() {
        let table = field.table()?;
        let source = Source::of(&table, usual, other)?;
        let factor = factor(&table)?;
        table.finish()?;
        (source, factor)
    } else {
        (Source::file(field, usual)?, 1.0)
    };
    let values = volumes.colours(&source, placing)?;
    Ok((Colours { values, factor }, source))
}

/// Of all values of a grid.
fn factor(table: &Table<'_>) -> Result<f32, Error> {
    table
        .optional("factor")
        .map_or(Ok(1.0), |f| f.not_negative())
}

fn tracking(table: &Table<'_>) -> Result<Tracking, Error> {
    match table.optional("transmittance") {
        Some(field) if field.one_of(&["ratio", "regular"])? == "regular" => Ok(Tracking::Regular),
        _ => Ok(Tracking::Ratio),
    }
}

/// `temperature`: what a grid makes glow.
fn heat(
    field: &Field<'_>,
    other: Option<&Source<'_>>,
    volumes: &Volumes<'_>,
    placing: &Placing,
) -> Result<Glow, Error> {
    let table = field.table()?;
    let source = Source::of(&table, "temperature", other)?;
    let factor = factor(&table)?;
    let (mut body, mut luminance) = (BlackBody::absolute(), 1.0);
    if let Some(field) = table.optional("relative_to") {
        let kelvin = field.number()? as f32;
        body = BlackBody::relative_to(kelvin).map_err(|e| field.error(e))?;
        let field = table.optional("luminance");
        luminance = field.map_or(Ok(1.0), |f| f.not_negative())?;
    }
    table.finish()?;
    Ok(Glow::Heat {
        temperature: volumes.scalars(&source, placing)?,
        factor,
        body,
        luminance,
    })
}

/// The density, the file that it is from or `None` if it is made, and how its grids are placed.
fn density<'a>(
    table: &Table<'a>,
    volumes: &Volumes<'_>,
) -> Result<(Scalars, Option<Source<'a>>, Placing), Error> {
    let (field, made) = table.either("file", "plume")?;
    let filter = match table.optional("filter") {
        Some(field) if field.one_of(&["trilinear", "nearest"])? == "nearest" => Filter::Nearest,
        _ => Filter::Trilinear,
    };
    let mut placing = Placing {
        transform: DAffine3::IDENTITY,
        corners: None,
        filter,
    };
    if made {
        let corners = corners(table)?;
        let corners =
            corners.ok_or_else(|| field.error("a plume needs `min` and `max`: add them"))?;
        placing.corners = Some(corners);
        return Ok((plume(&field, corners, filter)?, None, placing));
    }
    let source = Source::of(table, "density", None)?;
    if source.is_dense() {
        placing.corners = corners(table)?;
    } else {
        placing.transform = transform(table)?;
    }
    let density = volumes.scalars(&source, &placing)?;
    if let Scalars::Dense(boxed) = &density {
        placing.corners = Some(boxed.corners);
    }
    Ok((density, Some(source), placing))
}

/// `min` and `max`.
fn corners(table: &Table<'_>) -> Result<Option<[DVec3; 2]>, Error> {
    match (table.optional("min"), table.optional("max")) {
        (Some(min), Some(max)) => {
            let corners = [min.vector()?, max.vector()?];
            if !corners[0].cmplt(corners[1]).all() {
                return Err(max.error("must exceed `min` in x, y and z"));
            }
            Ok(Some(corners))
        }
        (None, None) => Ok(None),
        (Some(one), None) | (None, Some(one)) => {
            Err(one.error("`min` and `max` go together: add the other"))
        }
    }
}

/// A procedural plume whose longest edge has `resolution` voxels.
fn plume(field: &Field<'_>, corners: [DVec3; 2], filter: Filter) -> Result<Scalars, Error> {
    let table = field.table()?;
    let resolution = table.required("resolution")?.integer(2, 512)?;
    let seed = (table.optional("seed")).map_or(Ok(0), |f| f.integer(0, i64::from(u32::MAX)))?;
    table.finish()?;
    let size = corners[1] - corners[0];
    let voxels = (size / size.max_element() * resolution as f64).round();
    let counts = voxels.to_array().map(|n| (n as usize).max(1));
    let grid = tyndall_media::plume(counts, UNIT, seed as u32).map_err(|e| field.error(e))?;
    let grid = grid.with_filter(filter);
    Ok(Scalars::Dense(Boxed { grid, corners }))
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
