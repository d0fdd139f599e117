//! Two images whose pixels correspond.

use super::DiffArguments;
use std::path::PathBuf;
use tyndall_scene_io::RenderedImage;

/// Why two images do not show the same pixels.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Mismatch {
    #[error(
        "{} has {} × {} pixels and {} has {} × {}: render both at one resolution and crop",
        .image.display(), .sizes[0][0], .sizes[0][1], .reference.display(), .sizes[1][0], .sizes[1][1]
    )]
    Size {
        image: PathBuf,
        reference: PathBuf,
        sizes: [[u32; 2]; 2],
    },
    #[error(
        "{} begins at pixel {:?} of the picture and {} at {:?}: render both with one crop",
        .image.display(), .positions[0], .reference.display(), .positions[1]
    )]
    Position {
        image: PathBuf,
        reference: PathBuf,
        positions: [[i32; 2]; 2],
    },
    #[error("{} has no pixel that is finite in both images: render it again", .0.display())]
    NotFinite(PathBuf),
}

/// An image beside its reference, in the channels of the one that has more.
pub(crate) struct Pair<'a> {
    pub(crate) image: &'a RenderedImage,
    pub(crate) reference: &'a RenderedImage,
    /// Pixels that are finite in both, by index.
    pub(crate) pixels: Vec<usize>,
}

impl<'a> Pair<'a> {
    pub(crate) fn new(
        arguments: &DiffArguments,
        image: &'a RenderedImage,
        reference: &'a RenderedImage,
    ) -> Result<Self, Mismatch> {
        let files = || (arguments.image.clone(), arguments.reference.clone());
        let sizes = [image, reference].map(|i| [i.width, i.height]);
        if sizes[0] != sizes[1] {
            let (image, reference) = files();
            return Err(Mismatch::Size {
                image,
                reference,
                sizes,
            });
        }
        let positions = [image.position, reference.position];
        if positions[0] != positions[1] {
            let (image, reference) = files();
            return Err(Mismatch::Position {
                image,
                reference,
                positions,
            });
        }
        let planes = || image.radiance.iter().chain(&reference.radiance);
        let all = image.radiance[0].len();
        let pixels: Vec<_> = (0..all)
            .filter(|&i| planes().all(|p| p[i].is_finite()))
            .collect();
        if pixels.is_empty() {
            return Err(Mismatch::NotFinite(arguments.image.clone()));
        }
        Ok(Self {
            image,
            reference,
            pixels,
        })
    }

    /// Names of the channels.
    pub(crate) fn channels(&self) -> &'static [&'static str] {
        if self.image.radiance.len().max(self.reference.radiance.len()) == 1 {
            &["Y"]
        } else {
            &["R", "G", "B"]
        }
    }

    /// Pixels that are left out because they are not finite.
    pub(crate) fn left_out(&self) -> usize {
        self.image.radiance[0].len() - self.pixels.len()
    }

    /// Column and row in the whole picture of a pixel by index.
    pub(crate) fn place(&self, pixel: usize) -> [i64; 2] {
        let width = self.image.width as usize;
        let [x, y] = self.image.position.map(i64::from);
        [x + (pixel % width) as i64, y + (pixel / width) as i64]
    }

    /// The finite values of a channel in the image and in the reference.
    pub(crate) fn values(&self, channel: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let [a, b] = [self.image, self.reference].map(|i| plane(&i.radiance, channel));
        (self.pixels.iter()).map(|&i| (f64::from(a[i]), f64::from(b[i])))
    }

    /// The variances where [`Pair::values`] are; `None` unless both images have them.
    pub(crate) fn variances(
        &self,
        channel: usize,
    ) -> Option<impl Iterator<Item = (f64, f64)> + '_> {
        let a = plane(self.image.variance.as_ref()?, channel);
        let b = plane(self.reference.variance.as_ref()?, channel);
        Some((self.pixels.iter()).map(move |&i| (f64::from(a[i]), f64::from(b[i]))))
    }
}

/// A channel; a grey image has the same in all.
pub(crate) fn plane(planes: &[Vec<f32>], channel: usize) -> &[f32] {
    &planes[channel.min(planes.len() - 1)]
}
