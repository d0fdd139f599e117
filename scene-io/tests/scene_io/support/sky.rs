//! Files of environment images that vanish with the test.

use exr::prelude::{Image, SpecificChannels, WritableImage, write_rgb_file};
use image::codecs::hdr::HdrEncoder;
use std::io::Write;
use tempfile::NamedTempFile;
use tyndall_core::Rgb;

pub(crate) struct Sky(NamedTempFile);

impl Sky {
    fn empty() -> Self {
        Self(NamedTempFile::new().unwrap())
    }

    pub(crate) fn path(&self) -> String {
        self.0.path().display().to_string()
    }

    /// OpenEXR of 32-bit floats.
    pub(crate) fn exr(
        width: usize,
        height: usize,
        pixel: impl Sync + Fn(usize, usize) -> Rgb,
    ) -> Self {
        let sky = Self::empty();
        let channels = |x, y| <(f32, f32, f32)>::from(pixel(x, y).0);
        write_rgb_file(sky.path(), width, height, channels).unwrap();
        sky
    }

    /// Radiance HDR: each channel keeps 8 bits.
    pub(crate) fn hdr(width: usize, height: usize, pixel: impl Fn(usize, usize) -> Rgb) -> Self {
        let pixels = (0..width * height).map(|i| pixel(i % width, i / width).0.to_array());
        let pixels: Vec<_> = pixels.map(image::Rgb).collect();
        let sky = Self::empty();
        let encoder = HdrEncoder::new(sky.0.as_file());
        encoder.encode(&pixels, width, height).unwrap();
        sky
    }

    /// OpenEXR of the channel Y alone, in 16-bit floats.
    pub(crate) fn luminance(
        width: usize,
        height: usize,
        pixel: impl Sync + Fn(usize, usize) -> f32,
    ) -> Self {
        let sky = Self::empty();
        let channels = SpecificChannels::build()
            .with_channel::<exr::prelude::f16>("Y")
            .with_pixel_fn(|at| (exr::prelude::f16::from_f32(pixel(at.0, at.1)),));
        let image = Image::from_channels((width, height), channels);
        image.write().to_file(sky.path()).unwrap();
        sky
    }

    /// A file that holds this.
    pub(crate) fn bytes(bytes: &[u8]) -> Self {
        let mut sky = Self::empty();
        sky.0.write_all(bytes).unwrap();
        sky
    }
}
