//! Rendered images from EXR files.

mod attributes;
mod channels;
mod pixels;

use crate::open::open;
use crate::{Error, Features, Metadata, View};
use channels::Selection;
use exr::meta::header::Header;
use glam::Vec3;
use pixels::Planes;
use std::io::BufReader;
use std::path::Path;
use tyndall_core::Rgb;

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
    /// What the sensor's rays meet first.
    pub features: Option<Features>,
    /// The camera, if the file describes one.
    pub view: Option<View>,
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
    let wrong = |problem: String| Error::Build {
        path: path.to_owned(),
        problem,
    };
    let (file, length) = open(path)?;
    let reader = exr::block::read(BufReader::new(file), false).map_err(|e| {
        wrong(format!(
            "is no EXR file that can be read: {e}: export it again"
        ))
    })?;
    let selection = Selection::of(reader.headers()).map_err(wrong)?;
    let header = reader.headers()[selection.part].clone();
    let metadata = attributes::read(&header).map_err(wrong)?;
    let mut planes = pixels::read(reader, length, &selection).map_err(wrong)?;
    let position = position(&header);
    let picture = header.shared_attributes.display_window.size;
    Ok(RenderedImage {
        width: header.layer_size.width() as u32,
        height: header.layer_size.height() as u32,
        position,
        picture: [picture.width() as u32, picture.height() as u32],
        radiance: planes.take(&selection.radiance),
        variance: selection.variance.map(|channels| planes.take(&channels)),
        samples: selection.samples.map(|channel| planes.take_one(channel)),
        features: selection
            .features
            .map(|channels| features(&mut planes, channels)),
        view: view(&header),
        metadata,
    })
}

/// Where the first pixel is in the whole picture.
fn position(header: &Header) -> [i32; 2] {
    let first = header.own_attributes.layer_position;
    let picture = header.shared_attributes.display_window.position;
    [
        first.x().saturating_sub(picture.x()),
        first.y().saturating_sub(picture.y()),
    ]
}

fn features(planes: &mut Planes, channels: [usize; 7]) -> Features {
    let [r, g, b, x, y, z, depth] = channels.map(|channel| planes.take_one(channel));
    let triples = |a: Vec<f32>, b: Vec<f32>, c: Vec<f32>| a.into_iter().zip(b).zip(c);
    Features {
        albedo: (triples(r, g, b))
            .map(|((r, g), b)| Rgb::new(r, g, b))
            .collect(),
        normal: (triples(x, y, z))
            .map(|((x, y), z)| Vec3::new(x, y, z))
            .collect(),
        depth,
    }
}

/// The camera that `write_exr` describes.
fn view(header: &Header) -> Option<View> {
    let matrix = header.own_attributes.world_to_camera?;
    let [x, y] = position(header).map(u32::try_from);
    let picture = header.shared_attributes.display_window.size;
    let column = |i: usize| Vec3::new(matrix[i], matrix[4 + i], matrix[8 + i]);
    Some(View {
        picture: [picture.width() as u32, picture.height() as u32],
        offset: [x.ok()?, y.ok()?],
        axes: [column(0), column(1), column(2)],
        shift: Vec3::new(matrix[12], matrix[13], matrix[14]),
        screen_width: header.own_attributes.screen_window_width,
    })
}
