//! From image files to texels, and from those to linear numbers.

use super::ColourSpace;
use crate::{Error, open, srgb};
use glam::Vec4;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Limits, Rgba};
use std::cell::Cell;
use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

/// Texels on an edge at most.
const MAX_EDGE: u32 = 1 << 15;
/// Memory of the texels of one image, and of all images of a scene, at most.
const MAX_BYTES: u64 = 1 << 30;
const MAX_SCENE_BYTES: u64 = 1 << 32;
/// More texels a byte than deflate packs, even of one bit: what claims more is no image.
const MAX_RATIO: u64 = 1 << 14;

/// How many bytes of texels may yet be made.
pub(crate) struct Budget(Cell<u64>);

impl Default for Budget {
    /// That of a scene.
    fn default() -> Self {
        Self(Cell::new(MAX_SCENE_BYTES))
    }
}

impl Budget {
    fn spend(&self, bytes: u64) -> Result<(), String> {
        let left = self.0.get().checked_sub(bytes);
        self.0.set(left.ok_or(
            "has, with the images before it, more than 4 GiB of texels: scale images down",
        )?);
        Ok(())
    }
}

pub(super) fn read(path: &Path, budget: &Budget) -> Result<DynamicImage, Error> {
    let bytes = open::read(path)?;
    decode(&bytes, budget).map_err(|problem| Error::Build {
        path: path.to_owned(),
        problem,
    })
}

/// Decodes a PNG or JPEG file that is in memory; its size is judged before it is unpacked.
pub(super) fn decode(bytes: &[u8], budget: &Budget) -> Result<DynamicImage, String> {
    let format = image::guess_format(bytes).ok();
    let format = (format.filter(|f| matches!(f, ImageFormat::Png | ImageFormat::Jpeg)))
        .ok_or("is neither a PNG nor a JPEG image: convert it to one")?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE);
    limits.max_image_height = Some(MAX_EDGE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(broken)?;
    budget.spend(size(&decoder, bytes.len() as u64)?)?;
    DynamicImage::from_decoder(decoder).map_err(broken)
}

/// Bytes of the texels: four channels of one byte or two, whatever the file has.
fn size(decoder: &impl ImageDecoder, file: u64) -> Result<u64, String> {
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let depth = u64::from(color.bytes_per_pixel() / color.channel_count());
    let texels = u64::from(width) * u64::from(height);
    if texels > MAX_RATIO * file {
        return Err(format!(
            "claims {width} × {height} texels, more than a file of {file} bytes holds: export it \
             again"
        ));
    }
    let bytes = 4 * depth * texels;
    if bytes > MAX_BYTES {
        return Err(format!(
            "takes more than 1 GiB as {width} × {height} texels of {} bits: scale it down",
            32 * depth
        ));
    }
    Ok(bytes)
}

fn broken(e: image::ImageError) -> String {
    match e {
        image::ImageError::Limits(_) => {
            format!("has more than {MAX_EDGE} texels on an edge, or 1 GiB: scale it down")
        }
        e => format!("cannot be decoded ({e}): export it again"),
    }
}

pub(super) fn is_grey<T>(texels: &ImageBuffer<Rgba<T>, Vec<T>>) -> bool
where
    T: PartialEq,
    Rgba<T>: image::Pixel<Subpixel = T>,
{
    texels.pixels().all(|Rgba([r, g, b, _])| r == g && g == b)
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
        ColourSpace::Srgb => Vec4::new(srgb::decode(r), srgb::decode(g), srgb::decode(b), a),
    }
}

static SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| srgb::decode(i as f32 / 255.0)));

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG of this many bytes, grey of one bit a texel, as far as its first bytes tell.
    fn claim(edges: [u32; 2], crc: u32, bytes: usize) -> Vec<u8> {
        let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        file.extend(edges.iter().flat_map(|n| n.to_be_bytes()));
        file.extend([1, 0, 0, 0, 0]);
        file.extend(crc.to_be_bytes());
        file.extend((bytes as u32).to_be_bytes());
        file.extend(b"IDAT");
        file.resize(bytes, 0);
        file
    }

    #[test]
    fn images_are_judged_by_what_they_unpack_to() {
        let why = |file: &[u8]| decode(file, &Budget::default()).unwrap_err();
        let four_gib = why(&claim([32768, 32000], 0xe9ae_c5cb, 130_000));
        assert!(
            four_gib.contains("more than 1 GiB as 32768 × 32000"),
            "{four_gib}"
        );
        let hollow = why(&claim([4096, 4096], 0xdad8_19ba, 1000));
        assert!(
            hollow.contains("more than a file of 1000 bytes"),
            "{hollow}"
        );
        let damaged = why(&claim([4096, 4096], 0xdad8_19ba, 2000));
        assert!(damaged.contains("cannot be decoded"), "{damaged}");
    }

    #[test]
    fn images_share_a_budget() {
        let mut file = Cursor::new(Vec::new());
        let image = DynamicImage::new_luma8(2, 2);
        image.write_to(&mut file, ImageFormat::Png).unwrap();
        let budget = Budget(Cell::new(4 * 4 + 4 * 4 - 1));
        assert!(decode(file.get_ref(), &budget).is_ok());
        let why = decode(file.get_ref(), &budget).unwrap_err();
        assert!(why.contains("with the images before it"), "{why}");
    }
}
