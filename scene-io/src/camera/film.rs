//! The pixels of a picture, and the part of it that is rendered.

use super::Filter;
use std::sync::Arc;

/// The film of a camera. Places on it are measured in pixels from the upper left corner.
#[derive(Clone, Debug)]
pub(crate) struct Film {
    picture: [u32; 2],
    /// First pixel and number of pixels of the part that is rendered.
    offset: [u32; 2],
    size: [u32; 2],
    /// `None`: a pixel is the mean over its area.
    filter: Option<Arc<Filter>>,
}

impl Film {
    /// A film of `picture` pixels.
    pub(crate) fn new(picture: [u32; 2]) -> Self {
        Self {
            picture,
            offset: [0; 2],
            size: picture,
            filter: None,
        }
    }

    /// Renders but `size` pixels from `offset` on, which lie within the picture.
    #[must_use]
    pub(crate) fn cropped(self, offset: [u32; 2], size: [u32; 2]) -> Self {
        Self {
            offset,
            size,
            ..self
        }
    }

    /// With a reconstruction filter in place of the mean over the pixel.
    #[must_use]
    pub(crate) fn filtered(self, filter: Filter) -> Self {
        Self {
            filter: Some(Arc::new(filter)),
            ..self
        }
    }

    /// Pixels of the whole picture.
    pub(crate) fn picture(&self) -> [u32; 2] {
        self.picture
    }

    /// First pixel that is rendered.
    pub(crate) fn offset(&self) -> [u32; 2] {
        self.offset
    }

    /// Pixels that are rendered.
    pub(crate) fn resolution(&self) -> [u32; 2] {
        self.size
    }

    /// The share of the picture that is rendered.
    pub(super) fn share(&self) -> f32 {
        let pixels = |[x, y]: [u32; 2]| f64::from(x) * f64::from(y);
        (pixels(self.size) / pixels(self.picture)) as f32
    }

    /// A place in the whole picture for a ray of the rendered pixel `px`, and the weight of its
    /// radiance in the pixel: filter importance sampling (Ernst, Stamminger & Greiner 2006).
    pub(super) fn sample(&self, px: [u32; 2], u: [f32; 2]) -> ([f32; 2], f32) {
        let corner = [0, 1].map(|i| (self.offset[i] + px[i]) as f32);
        let Some(filter) = &self.filter else {
            return ([corner[0] + u[0], corner[1] + u[1]], 1.0);
        };
        let [(x, weight_x), (y, weight_y)] = u.map(|u| filter.sample(u));
        let place = [corner[0] + 0.5 + x, corner[1] + 0.5 + y];
        (place, weight_x * weight_y)
    }

    /// Where on the rendered part light is recorded that arrives at `place` in the whole picture,
    /// and its weight; `None` if no pixel sees it.
    ///
    /// A filter that covers several pixels chooses one of them by its value there, so that the
    /// expectation of every pixel is the filtered image, as that of [`Film::sample`] is.
    pub(super) fn splat(&self, place: [f32; 2], u: [f32; 2]) -> Option<([f32; 2], f32)> {
        let on_film = [0, 1].map(|i| place[i] - self.offset[i] as f32);
        let Some(filter) = &self.filter else {
            let inside = |i| on_film[i] >= 0.0 && on_film[i] < self.size[i] as f32;
            return (inside(0) && inside(1)).then_some((on_film, 1.0));
        };
        let (x, weight_x) = filter.choose(on_film[0], self.size[0], u[0])?;
        let (y, weight_y) = filter.choose(on_film[1], self.size[1], u[1])?;
        Some(([x, y].map(|i| i as f32 + 0.5), weight_x * weight_y))
    }
}
