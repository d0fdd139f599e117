//! `[film]`.

use super::reader::{Field, Table};
use crate::Error;
use crate::camera::{Film, Filter, FilterShape};

/// Pixels of a picture at most.
const MAX_PIXELS: u64 = 1 << 28;

/// Reads the film.
pub(super) fn read(field: &Field<'_>) -> Result<Film, Error> {
    let table = field.table()?;
    let side = |key| Ok::<_, Error>(table.required(key)?.integer(1, 65536)? as u32);
    let resolution = [side("width")?, side("height")?];
    let mut film = Film::new(resolution);
    let mut pixels = resolution;
    if let Some(crop) = table.optional("crop") {
        let [offset, size] = read_crop(&crop, resolution)?;
        film = film.cropped(offset, size);
        pixels = size;
    }
    if let Some(filter) = table.optional("filter")
        && let Some(filter) = read_filter(&filter)?
    {
        film = film.filtered(filter);
    }
    table.finish()?;
    if u64::from(pixels[0]) * u64::from(pixels[1]) > MAX_PIXELS {
        return Err(field.error(format!(
            "has more than {MAX_PIXELS} pixels: lower `width` or `height`"
        )));
    }
    Ok(film)
}

/// First pixel and number of pixels.
fn read_crop(field: &Field<'_>, [width, height]: [u32; 2]) -> Result<[[u32; 2]; 2], Error> {
    let wrong = || {
        field.error(format!(
            "must be [x, y, width, height] in whole pixels, of the {width} × {height} that there are"
        ))
    };
    let elements = field.elements().map_err(|_| wrong())?;
    let [x, y, w, h] = elements.as_slice() else {
        return Err(wrong());
    };
    let along = |start: &Field<'_>, count: &Field<'_>, side: u32| {
        let start = start.integer(0, i64::from(side) - 1).ok()?;
        let count = count.integer(1, i64::from(side) - start).ok()?;
        Some([start as u32, count as u32])
    };
    let [x, w] = along(x, w, width).ok_or_else(wrong)?;
    let [y, h] = along(y, h, height).ok_or_else(wrong)?;
    Ok([[x, y], [w, h]])
}

/// `None` for the mean over the pixel.
fn read_filter(field: &Field<'_>) -> Result<Option<Filter>, Error> {
    const KINDS: [&str; 5] = ["box", "tent", "gaussian", "mitchell", "blackman_harris"];
    let table = match field.is_string() {
        true => None,
        false => Some(field.table()?),
    };
    let kind = match &table {
        None => field.one_of(&KINDS)?,
        Some(table) => table.required("kind")?.one_of(&KINDS)?,
    };
    let number = |key, default: f64, min: f64, max: f64| {
        let Some(field) = table.as_ref().and_then(|t| t.optional(key)) else {
            return Ok::<_, Error>(default);
        };
        let range = format!("a number from {min} to {max}");
        let number = field.number_that(|x| (min..=max).contains(&x), &range)?;
        Ok(f64::from(number))
    };
    let (shape, radius) = match kind {
        "box" => (FilterShape::Box, 0.5),
        "tent" => (FilterShape::Tent, 1.0),
        "gaussian" => {
            let stddev = number("stddev", 0.5, 0.01, 16.0)?;
            (FilterShape::Gaussian { stddev }, (4.0 * stddev).min(16.0))
        }
        "mitchell" => {
            let [b, c] = [
                number("b", 1.0 / 3.0, 0.0, 1.0)?,
                number("c", 1.0 / 3.0, 0.0, 1.0)?,
            ];
            (FilterShape::Mitchell { b, c }, 2.0)
        }
        _ => (FilterShape::BlackmanHarris, 1.5),
    };
    let radius = number("radius", radius, 0.05, 16.0)?;
    table.as_ref().map_or(Ok(()), Table::finish)?;
    if (shape, radius) == (FilterShape::Box, 0.5) {
        return Ok(None);
    }
    let filter = Filter::new(shape, radius as f32);
    filter.map(Some).ok_or_else(|| {
        field.error("has lobes that cancel, so that pixels would be noise: lower `c` or raise `b`")
    })
}
