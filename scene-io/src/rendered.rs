//! Rendered images from EXR files.

mod attributes;
mod channels;
mod pixels;

use crate::{Error, Metadata};
use channels::Selection;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A rendered image, as [`write_exr`](crate::write_exr) or another renderer wrote it.
///
/// A plane is one number a pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RenderedImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Where the first pixel is in the whole picture: not `[0, 0]` if the image is a crop.
    pub position: [i32; 2],
    /// Columns and rows of the whole picture.
    pub picture: [u32; 2],
    /// Radiance: planes R, G, B, or one.
    pub radiance: Vec<Vec<f32>>,
    /// Variance of `radiance` as an estimate of the mean, plane by plane.
    pub variance: Option<Vec<Vec<f32>>>,
    /// Samples that a pixel took.
    pub samples: Option<Vec<f32>>,
    /// How it came to be, as far as the file says: `passes` is 0 if it does not.
    pub metadata: Metadata,
}

/// Reads an image from an EXR file: scan lines or tiles, any compression that keeps pixels apart,
/// any type of sample. Of several resolutions the finest is read.
///
/// Radiance is the channels `R`, `G`, `B`, or else `Y`, of the first part that has them without a
/// prefix; else those of a layer called `Combined`, `beauty`, `rgb`, `rgba` or `color`; else those
/// of the only layer that has them. Alpha is left out. Variance and features are the layers that
/// [`write_exr`](crate::write_exr) names, in the same part.
///
/// # Errors
/// [`Error::Read`] if the file cannot be read; [`Error::Build`] if it is no EXR file, is damaged,
/// promises more pixels than its bytes can hold, or has no such channels.
pub fn read_exr(path: &Path) -> Result<RenderedImage, Error> {
    let unreadable = |source| Error::Read {
        path: path.to_owned(),
        source,
    };
    let wrong = |problem: String| Error::Build {
        path: path.to_owned(),
        problem,
    };
    let file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let reader = exr::block::read(BufReader::new(file), false)
        .map_err(|e| wrong(format!("is no EXR file that can be read: {e}")))?;
    let selection = Selection::of(reader.headers()).map_err(wrong)?;
    let header = &reader.headers()[selection.part];
    let attributes = attributes::read(header).map_err(wrong)?;
    let position = header.own_attributes.layer_position;
    let picture = header.shared_attributes.display_window;
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let mut planes = pixels::read(reader, length, &selection).map_err(wrong)?;
    Ok(RenderedImage {
        width: width as u32,
        height: height as u32,
        position: [
            position.x().saturating_sub(picture.position.x()),
            position.y().saturating_sub(picture.position.y()),
        ],
        picture: [picture.size.width() as u32, picture.size.height() as u32],
        radiance: planes.take(&selection.radiance),
        variance: selection.variance.map(|channels| planes.take(&channels)),
        samples: selection.samples.map(|channel| planes.take_one(channel)),
        metadata: attributes,
    })
}
