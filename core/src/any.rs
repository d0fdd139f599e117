//! The object-safe twin of an integrator: one virtual call a tile, none a photon.

use crate::{
    Domain, Figure, HostTypes, Integrator, PassContext, PassError, Sampler, Sensor, Splat,
    StateError, Streams,
};
use std::any::Any;

/// A prepared pass whose type only its integrator knows.
pub type AnyPass = Box<dyn Any + Send + Sync>;

/// The states of a tile's pixels, whose type only their integrator knows.
pub type AnyPixels = Box<dyn Any + Send>;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Smallest column and row.
    pub min: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl Tile {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Whether it holds no pixel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Its pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let Self { min, size } = *self;
        (min[1]..min[1] + size[1])
            .flat_map(move |y| (min[0]..min[0] + size[0]).map(move |x| [x, y]))
    }
}

/// An [`Integrator`] as a trait object, implemented for every one of them.
///
/// `R` are the random streams of the driver that holds it.
pub trait AnyIntegrator<H: HostTypes, R: Streams>: Sync {
    /// See [`Integrator::begin_pass`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Panics
    /// If `previous` comes from another integrator.
    fn begin_any(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        previous: Option<AnyPass>,
    ) -> Result<AnyPass, PassError>;

    /// Fresh states for `count` pixels.
    fn pixels(&self, count: usize) -> AnyPixels;

    /// One sample of every pixel of a tile, weighted by the sensor, row by row into `radiance`.
    ///
    /// # Panics
    /// If `pass` or `pixels` come from another integrator, or `radiance` is shorter than the tile.
    fn estimate_tile(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        pass: &AnyPass,
        pixels: &mut AnyPixels,
        tile: Tile,
        radiance: &mut [H::Spectrum],
    );

    /// See [`Integrator::splats`].
    fn splats_any<'p>(&self, pass: &'p AnyPass) -> &'p [Splat<H::Spectrum>];

    /// See [`Integrator::figures`].
    ///
    /// # Panics
    /// If `pass` comes from another integrator.
    fn figures_any(&self, pass: &AnyPass) -> Vec<Figure>;

    /// See [`Integrator::options`].
    fn options_any(&self) -> Vec<(&'static str, String)>;

    /// See [`Integrator::save_pass`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Panics
    /// If `pass` comes from another integrator.
    fn save_any(&self, pass: &AnyPass, bytes: &mut Vec<u8>) -> Result<(), StateError>;

    /// See [`Integrator::restore_pass`].
    ///
    /// # Errors
    /// As there.
    fn restore_any(&self, host: &H, bytes: &[u8]) -> Result<Option<AnyPass>, StateError>;

    /// Appends to `bytes` what all these pixels remember.
    ///
    /// # Errors
    /// See [`Integrator::save_pixel`].
    ///
    /// # Panics
    /// If `pixels` come from another integrator.
    fn save_pixels(&self, pixels: &AnyPixels, bytes: &mut Vec<u8>) -> Result<(), StateError>;

    /// `count` pixels from what [`AnyIntegrator::save_pixels`] wrote of as many.
    ///
    /// # Errors
    /// [`StateError::Corrupt`], also for bytes that are left over.
    fn restore_pixels(&self, count: usize, bytes: &[u8]) -> Result<AnyPixels, StateError>;
}

impl<H: Sensor, R: Streams, I: Integrator<H>> AnyIntegrator<H, R> for I {
    fn begin_any(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        previous: Option<AnyPass>,
    ) -> Result<AnyPass, PassError> {
        let previous = previous.map(|p| *p.downcast::<I::Pass>().expect(FOREIGN));
        Ok(Box::new(self.begin_pass(host, cx, previous)?))
    }

    fn pixels(&self, count: usize) -> AnyPixels {
        Box::new(vec![I::Pixel::default(); count])
    }

    fn estimate_tile(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        pass: &AnyPass,
        pixels: &mut AnyPixels,
        tile: Tile,
        radiance: &mut [H::Spectrum],
    ) {
        let pass = pass.downcast_ref::<I::Pass>().expect(FOREIGN);
        let pixels = pixels.downcast_mut::<Vec<I::Pixel>>().expect(FOREIGN);
        let width = u64::from(host.resolution()[0]);
        for (i, px) in tile.pixels().enumerate() {
            let index = u64::from(px[1]) * width + u64::from(px[0]);
            let mut sampler = cx.streams.sampler(Domain::SENSOR, index);
            let ray = host.sensor_ray(px, sampler.next());
            let arriving = self.estimate(host, pass, &mut pixels[i], &ray, &mut sampler);
            radiance[i] = arriving * ray.weight;
        }
    }

    fn splats_any<'p>(&self, pass: &'p AnyPass) -> &'p [Splat<H::Spectrum>] {
        self.splats(pass.downcast_ref::<I::Pass>().expect(FOREIGN))
    }

    fn figures_any(&self, pass: &AnyPass) -> Vec<Figure> {
        self.figures(pass.downcast_ref::<I::Pass>().expect(FOREIGN))
    }

    fn options_any(&self) -> Vec<(&'static str, String)> {
        self.options()
    }

    fn save_any(&self, pass: &AnyPass, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        self.save_pass(pass.downcast_ref::<I::Pass>().expect(FOREIGN), bytes)
    }

    fn restore_any(&self, host: &H, bytes: &[u8]) -> Result<Option<AnyPass>, StateError> {
        let pass = self.restore_pass(host, bytes)?;
        Ok(pass.map(|pass| Box::new(pass) as AnyPass))
    }

    fn save_pixels(&self, pixels: &AnyPixels, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        let pixels = pixels.downcast_ref::<Vec<I::Pixel>>().expect(FOREIGN);
        (pixels.iter()).try_for_each(|pixel| self.save_pixel(pixel, bytes))
    }

    fn restore_pixels(&self, count: usize, mut bytes: &[u8]) -> Result<AnyPixels, StateError> {
        let pixels: Result<Vec<I::Pixel>, _> =
            (0..count).map(|_| self.restore_pixel(&mut bytes)).collect();
        match bytes {
            [] => Ok(Box::new(pixels?)),
            _ => Err(StateError::Corrupt),
        }
    }
}

const FOREIGN: &str = "the state belongs to another integrator";
