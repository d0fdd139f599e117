//! Images of environments: OpenEXR and Radiance HDR.

use crate::Error;
use crate::open::open;
use exr::prelude::{MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, read};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;
use tyndall_core::{Rgb, Spectrum};

/// Linear radiance from all directions; finite and not negative.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentImage {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Row by row from the top.
    pub(crate) pixels: Vec<Rgb>,
}

/// Pixels at most: 16384 × 8192, which take 1.6 GiB.
const MAX_PIXELS: u64 = 1 << 27;
/// Pixels at most for each byte of the file. Deflate, the best of the compressions, makes 1032
/// bytes of one.
const PIXELS_PER_BYTE: u64 = 1032;

impl EnvironmentImage {
    /// Reads a file by what its first bytes say it is.
    ///
    /// # Errors
    /// [`Error::Read`] if the file cannot be read, [`Error::Build`] if it is no such image.
    pub(crate) fn read(path: &Path) -> Result<Self, Error> {
        let unreadable = |source| Error::Read {
            path: path.to_owned(),
            source,
        };
        let (file, length) = open(path)?;
        let mut file = BufReader::new(file);
        let mut magic = Vec::new();
        (file.by_ref().take(4).read_to_end(&mut magic)).map_err(unreadable)?;
        file.rewind().map_err(unreadable)?;
        let image = match magic.as_slice() {
            [0x76, 0x2f, 0x31, 0x01] => read_exr(file, length),
            [b'#', b'?', ..] => read_hdr(file, length),
            _ => Err("is neither OpenEXR nor Radiance HDR: convert it to one of them".into()),
        };
        let image = image.and_then(|image| match image.first_wrong() {
            Some(wrong) => Err(wrong),
            None => Ok(image),
        });
        image.map_err(|problem| Error::Build {
            path: path.to_owned(),
            problem,
        })
    }

    /// The image times `scale`.
    ///
    /// # Errors
    /// A sentence if that overflows.
    pub(crate) fn scaled(mut self, scale: Rgb) -> Result<Self, String> {
        self.pixels.iter_mut().for_each(|c| *c *= scale);
        match self.pixels.iter().all(|c| c.is_finite()) {
            true => Ok(self),
            false => Err("overflows when it is multiplied by `scale`: lower `scale`".into()),
        }
    }

    /// A complaint about the first pixel that is no radiance.
    fn first_wrong(&self) -> Option<String> {
        let is_radiance = |x: f32| (0.0..f32::INFINITY).contains(&x);
        let mut wrong = self.pixels.iter().enumerate().flat_map(|(i, c)| {
            let channels = c.0.to_array().into_iter().zip(["red", "green", "blue"]);
            channels.map(move |(value, name)| (i, value, name))
        });
        let (i, value, name) = wrong.find(|(_, value, _)| !is_radiance(*value))?;
        let (x, y) = (i % self.width, i / self.width);
        Some(format!(
            "{name} is {value} at column {x}, row {y} (from 0, at the upper left), which is no \
             radiance: clamp the image to finite values ≥ 0"
        ))
    }
}

/// Whether `length` bytes can hold what the header promises, and we want it.
fn check_size(width: u64, height: u64, length: u64) -> Result<(), String> {
    let pixels = width.saturating_mul(height);
    if pixels == 0 {
        return Err("has no pixels: export it again".into());
    }
    if pixels > MAX_PIXELS {
        return Err(format!(
            "has {width} × {height} pixels, more than {MAX_PIXELS}: scale it down"
        ));
    }
    if pixels > PIXELS_PER_BYTE.saturating_mul(length) {
        return Err(format!(
            "promises {width} × {height} pixels in {length} bytes: the file is cut off or damaged, export it again"
        ));
    }
    Ok(())
}

fn read_exr(mut file: BufReader<File>, length: u64) -> Result<EnvironmentImage, String> {
    let damaged = |e: exr::error::Error| format!("cannot be read as OpenEXR: {e}: export it again");
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(damaged)?;
    file.rewind().map_err(|e| e.to_string())?;
    for header in &meta.headers {
        check_size(
            header.layer_size.0 as u64,
            header.layer_size.1 as u64,
            length,
        )?;
    }
    let has = |name: &str| {
        let layer = meta.headers.iter().find(|header| {
            let mut channels = header.channels.list.iter();
            channels.any(|channel| channel.name == *name)
        });
        layer.is_some()
    };
    if has("R") && has("G") && has("B") {
        let pixels = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgb_channels(
                |size, _| blank(size.0, size.1),
                |image: &mut EnvironmentImage, at, (r, g, b): (f32, f32, f32)| {
                    image.pixels[at.1 * image.width + at.0] = Rgb::new(r, g, b);
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(file);
        Ok(pixels.map_err(damaged)?.layer_data.channel_data.pixels)
    } else if has("Y") && !has("RY") {
        let pixels = read()
            .no_deep_data()
            .largest_resolution_level()
            .specific_channels()
            .required("Y")
            .collect_pixels(
                |size, _| blank(size.0, size.1),
                |image: &mut EnvironmentImage, at, (y,): (f32,)| {
                    image.pixels[at.1 * image.width + at.0] = Rgb::new(y, y, y);
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(file);
        Ok(pixels.map_err(damaged)?.layer_data.channel_data.pixels)
    } else {
        Err("has no channels R, G and B, and no Y alone: export it as plain RGB".into())
    }
}

fn blank(width: usize, height: usize) -> EnvironmentImage {
    EnvironmentImage {
        width,
        height,
        pixels: vec![Rgb::default(); width * height],
    }
}

fn read_hdr(file: BufReader<File>, length: u64) -> Result<EnvironmentImage, String> {
    let damaged =
        |e: image::ImageError| format!("cannot be read as Radiance HDR: {e}: export it again");
    let decoder = HdrDecoder::new_nonstrict(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into(), length)?;
    let mut bytes = vec![0; width as usize * height as usize * 12];
    decoder.read_image(&mut bytes).map_err(damaged)?;
    let float = |b: &[u8]| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]);
    let pixels = bytes.chunks_exact(12);
    let pixels = pixels.map(|p| Rgb::new(float(&p[..4]), float(&p[4..8]), float(&p[8..])));
    Ok(EnvironmentImage {
        width: width as usize,
        height: height as usize,
        pixels: pixels.collect(),
    })
}
