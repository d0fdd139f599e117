//! Images that colour surfaces.

mod decode;

use crate::Error;
pub(crate) use decode::Budget;
use glam::{DVec4, Vec2, Vec4};
use image::{DynamicImage, ImageBuffer, Rgba, RgbaImage};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// How the numbers of an image are meant. Alpha is always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ColourSpace {
    /// Colours: encoded for displays (IEC 61966-2-1).
    Srgb,
    /// Roughness, normals and all else.
    Linear,
}

/// What lies outside of the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image and its mirror image in turn.
    Mirror,
    /// The border.
    Clamp,
}

/// What lies between the centres of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Filter {
    /// The four around, in proportion to their nearness.
    #[default]
    Bilinear,
    /// The texel that the point is in.
    Nearest,
}

/// A decoded image.
#[derive(Clone, Debug)]
pub(crate) struct Texture {
    /// Textures of one image share them.
    texels: Arc<Texels>,
    space: ColourSpace,
    /// Along u and v.
    pub(crate) wrap: [Wrap; 2],
    pub(crate) filter: Filter,
    is_grey: bool,
    has_alpha: bool,
    mean: OnceLock<Vec4>,
}

/// Rows from the top, as the file has them.
#[derive(Clone, Debug)]
enum Texels {
    Eight(RgbaImage),
    Sixteen(ImageBuffer<Rgba<u16>, Vec<u16>>),
}

impl Texture {
    /// Reads a PNG or JPEG file.
    ///
    /// # Errors
    /// [`Error::Read`], or [`Error::Build`] that names the file and the mend.
    pub(crate) fn load(path: &Path, space: ColourSpace, budget: &Budget) -> Result<Self, Error> {
        let image = decode::read(path, budget)?;
        Ok(Self::from_image(image, space))
    }

    /// [`Texture::load`] of a file that is in memory; or what is wrong with it.
    pub(crate) fn decode(
        bytes: &[u8],
        space: ColourSpace,
        budget: &Budget,
    ) -> Result<Self, String> {
        Ok(Self::from_image(decode::decode(bytes, budget)?, space))
    }

    /// The texture of an image; of 8 bits a channel, or 16 where it has more.
    fn from_image(image: DynamicImage, space: ColourSpace) -> Self {
        let color = image.color();
        let eight = color.bytes_per_pixel() == color.channel_count();
        let texels = if eight {
            Texels::Eight(image.into_rgba8())
        } else {
            Texels::Sixteen(image.into_rgba16())
        };
        Self {
            is_grey: match &texels {
                Texels::Eight(t) => decode::is_grey(t),
                Texels::Sixteen(t) => decode::is_grey(t),
            },
            has_alpha: match &texels {
                Texels::Eight(t) => t.pixels().any(|t| t[3] != u8::MAX),
                Texels::Sixteen(t) => t.pixels().any(|t| t[3] != u16::MAX),
            },
            texels: Arc::new(texels),
            space,
            wrap: [Wrap::default(); 2],
            filter: Filter::default(),
            mean: OnceLock::new(),
        }
    }

    /// Width and height in texels.
    pub(crate) fn size(&self) -> [u32; 2] {
        match &*self.texels {
            Texels::Eight(texels) => texels.dimensions(),
            Texels::Sixteen(texels) => texels.dimensions(),
        }
        .into()
    }

    /// Where the texels are: the same for textures that share them.
    pub(crate) fn address(&self) -> *const () {
        Arc::as_ptr(&self.texels).cast()
    }

    /// Memory of the texels.
    pub(crate) fn bytes(&self) -> u64 {
        let bytes = match &*self.texels {
            Texels::Eight(texels) => size_of_val(texels.as_raw().as_slice()),
            Texels::Sixteen(texels) => size_of_val(texels.as_raw().as_slice()),
        };
        bytes as u64
    }

    /// Whether red, green and blue are equal everywhere.
    pub(crate) fn is_grey(&self) -> bool {
        self.is_grey
    }

    /// Whether some texel is not opaque.
    pub(crate) fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// The mean of the texels, in linear numbers.
    pub(crate) fn mean(&self) -> Vec4 {
        *self.mean.get_or_init(|| {
            let [width, height] = self.size();
            let row = |y| (0..width).map(move |x| self.texel(x, y).as_dvec4());
            let sum: DVec4 = (0..height).flat_map(row).sum();
            (sum / (f64::from(width) * f64::from(height))).as_vec4()
        })
    }

    /// Whether it looks like a normal map rather than one of heights: bluish, not grey.
    pub(crate) fn holds_normals(&self) -> bool {
        let [width, height] = self.size().map(|n| n as usize);
        let texels = width * height;
        // Enough to know, of a large image.
        let some = (0..texels).step_by(texels.div_ceil(1 << 12));
        let count = some.len() as f32;
        let sum: Vec4 = some
            .map(|i| self.texel((i % width) as u32, (i / width) as u32))
            .sum();
        let mean = sum / count;
        !self.is_grey && mean.z > 0.6 && (mean.x - 0.5).abs() < 0.2 && (mean.y - 0.5).abs() < 0.2
    }

    /// Red, green, blue (linear) and alpha at texture coordinates `uv`: (0, 0) is the upper left
    /// corner of the image, (1, 1) the lower right, as in glTF. Infinite coordinates count as 0.
    pub(crate) fn lookup(&self, uv: Vec2) -> Vec4 {
        let [u, v] = uv.to_array();
        let [width, height] = self.size();
        match self.filter {
            Filter::Nearest => self.texel(
                nearest(u, width, self.wrap[0]),
                nearest(v, height, self.wrap[1]),
            ),
            Filter::Bilinear => {
                let ([x0, x1], s) = between(u, width, self.wrap[0]);
                let ([y0, y1], t) = between(v, height, self.wrap[1]);
                let upper = self.texel(x0, y0).lerp(self.texel(x1, y0), s);
                let lower = self.texel(x0, y1).lerp(self.texel(x1, y1), s);
                upper.lerp(lower, t)
            }
        }
    }

    fn texel(&self, x: u32, y: u32) -> Vec4 {
        match &*self.texels {
            Texels::Eight(texels) => decode::eight(texels.get_pixel(x, y).0, self.space),
            Texels::Sixteen(texels) => decode::sixteen(texels.get_pixel(x, y).0, self.space),
        }
    }
}

/// The texel that coordinate `u` is in.
fn nearest(u: f32, count: u32, wrap: Wrap) -> u32 {
    let x = f64::from(u) * f64::from(count);
    wrap.index(x.floor(), count)
}

/// The texels whose centres are before and after coordinate `u`, and how far it is to the second.
fn between(u: f32, count: u32, wrap: Wrap) -> ([u32; 2], f32) {
    let x = f64::from(u) * f64::from(count) - 0.5;
    let x = if x.is_finite() { x } else { 0.0 };
    let before = x.floor();
    let indices = [before, before + 1.0].map(|i| wrap.index(i, count));
    (indices, (x - before) as f32)
}

impl Wrap {
    /// The texel in place of number `i`, which may be outside.
    fn index(self, i: f64, count: u32) -> u32 {
        let n = f64::from(count);
        // The cast takes what is not a number to 0; rounding may reach n.
        let inside = |x: f64| (x as u32).min(count - 1);
        match self {
            Self::Clamp => inside(i),
            Self::Repeat => inside(i.rem_euclid(n)),
            Self::Mirror => {
                let i = i.rem_euclid(2.0 * n);
                inside(if i < n { i } else { 2.0 * n - 1.0 - i })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Rgba};

    /// 0, 51 over 102, 255 in red, and alpha 128.
    fn four(wrap: Wrap, filter: Filter) -> Texture {
        let red = [[0, 51], [102, 255]];
        let pixel = |x: u32, y: u32| Rgba([red[y as usize][x as usize], 0, 0, 128_u8]);
        let image = ImageBuffer::from_fn(2, 2, pixel);
        let texture = Texture::from_image(image.into(), ColourSpace::Linear);
        let wrap = [wrap; 2];
        Texture {
            wrap,
            filter,
            ..texture
        }
    }

    fn red(texture: &Texture, u: f32, v: f32) -> f32 {
        (texture.lookup(Vec2::new(u, v)).x * 1e4).round() / 1e4
    }

    #[test]
    fn texels_are_met_at_their_centres_and_mixed_between() {
        let texture = four(Wrap::Repeat, Filter::Bilinear);
        assert_eq!(red(&texture, 0.25, 0.25), 0.0);
        assert_eq!(red(&texture, 0.75, 0.25), 0.2);
        assert_eq!(red(&texture, 0.25, 0.75), 0.4);
        assert_eq!(red(&texture, 0.5, 0.25), 0.1);
        assert_eq!(red(&texture, 0.5, 0.5), 0.4);
        assert_eq!(red(&texture, 1.25, -1.75), 0.0);
        assert_eq!(red(&texture, 0.0, 0.25), 0.1);
        assert_eq!(texture.lookup(Vec2::splat(0.3)).w, 128.0 / 255.0);
    }

    #[test]
    fn what_lies_outside_is_repeated_mirrored_or_the_border() {
        let row = |wrap| [-0.25, 1.25, 1.75].map(|u| red(&four(wrap, Filter::Nearest), u, 0.25));
        assert_eq!(row(Wrap::Repeat), [0.2, 0.0, 0.2]);
        assert_eq!(row(Wrap::Mirror), [0.0, 0.2, 0.0]);
        assert_eq!(row(Wrap::Clamp), [0.0, 0.2, 0.2]);
    }

    #[test]
    fn coordinates_without_bounds_are_looked_up() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Bilinear, Filter::Nearest] {
                let texture = four(wrap, filter);
                for u in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX, -1e-30] {
                    assert!(texture.lookup(Vec2::new(u, u)).is_finite());
                }
            }
        }
    }

    #[test]
    fn display_values_are_decoded_and_alpha_is_not() {
        let image = ImageBuffer::from_pixel(1, 1, Rgba([188_u8, 10, 255, 188]));
        let texture = Texture::from_image(image.into(), ColourSpace::Srgb);
        let texel = texture.lookup(Vec2::ZERO);
        // ((188/255 + 0.055)/1.055)^2.4 and (10/255)/12.92
        let expected = Vec4::new(0.502_886, 0.003_035_3, 1.0, 188.0 / 255.0);
        assert!((texel - expected).abs().max_element() < 1e-6, "{texel}");
        assert!(!texture.is_grey() && texture.has_alpha());
    }

    #[test]
    fn sixteen_bits_are_kept() {
        let image = ImageBuffer::from_pixel(1, 1, Rgba([1_u16, 1, 1, 65535]));
        let texture = Texture::from_image(image.into(), ColourSpace::Linear);
        assert_eq!(texture.lookup(Vec2::ZERO).x, 1.0 / 65535.0);
        assert!(texture.is_grey());
    }
}
