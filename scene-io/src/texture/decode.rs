//! From image files to texels, and from those to linear numbers.

use super::ColourSpace;
use crate::{Error, open};
use glam::Vec4;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

/// Texels on an edge, and bytes while decoding, at most.
const MAX_EDGE: u32 = 1 << 15;
const MAX_BYTES: u64 = 1 << 30;
/// More than deflate packs 1-bit texels: what claims more is no image.
const MAX_RATIO: u64 = 1 << 14;

pub(super) fn read(path: &Path) -> Result<DynamicImage, Error> {
    let bytes = open::read(path)?;
    decode(&bytes).map_err(|problem| Error::Build {
        path: path.to_owned(),
        problem,
    })
}

/// Decodes a PNG or JPEG file that is in memory.
pub(crate) fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let format = image::guess_format(bytes).ok();
    let format = (format.filter(|f| matches!(f, ImageFormat::Png | ImageFormat::Jpeg)))
        .ok_or("is neither a PNG nor a JPEG image: convert it to one")?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE);
    limits.max_image_height = Some(MAX_EDGE);
    limits.max_alloc = Some(MAX_BYTES.min(MAX_RATIO * bytes.len() as u64));
    reader.limits(limits);
    reader.decode().map_err(|e| match e {
        image::ImageError::Limits(_) => {
            "claims to be larger than it can be, or than 32768 texels on an edge or 1 GiB: scale \
             it down, or export it again"
                .into()
        }
        e => format!("cannot be decoded ({e}): export it again"),
    })
}

/// Groups of four channels.
pub(super) fn texels<T: Copy>(channels: Vec<T>) -> Vec<[T; 4]> {
    let (texels, _) = channels.as_chunks();
    texels.to_vec()
}

pub(super) fn is_grey<T: PartialEq>(texels: &[[T; 4]]) -> bool {
    texels.iter().all(|[r, g, b, _]| r == g && g == b)
}

pub(super) fn eight(texel: [u8; 4], space: ColourSpace) -> Vec4 {
    let [r, g, b, a] = texel;
    let alpha = f32::from(a) / 255.0;
    match space {
        ColourSpace::Linear => {
            Vec4::new(f32::from(r), f32::from(g), f32::from(b), 255.0 * alpha) / 255.0
        }
        ColourSpace::Srgb => {
            let [r, g, b] = [r, g, b].map(|c| SRGB[usize::from(c)]);
            Vec4::new(r, g, b, alpha)
        }
    }
}

pub(super) fn sixteen(texel: [u16; 4], space: ColourSpace) -> Vec4 {
    let [r, g, b, a] = texel.map(|c| f32::from(c) / 65535.0);
    match space {
        ColourSpace::Linear => Vec4::new(r, g, b, a),
        ColourSpace::Srgb => Vec4::new(linear(r), linear(g), linear(b), a),
    }
}

static SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| linear(i as f32 / 255.0)));

/// What a display shows for an encoded value (IEC 61966-2-1).
fn linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}
