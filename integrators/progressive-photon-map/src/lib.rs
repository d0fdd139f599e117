//! Progressive photon mapping: photon mapping whose error falls to nothing in bounded memory.
//!
//! Every pass traces new light paths, and one new walk of sight a pixel. The walk goes on through
//! specular surfaces until a surface or a medium scatters into many directions; there it gathers
//! photons within a radius that shrinks from pass to pass, so that the mean of the passes converges
//! to the right radiance while no pass keeps its photons. In a medium the walk ends at a collision
//! sampled by free flight, and gathers in a ball: surfaces and media are one framework.
//!
//! Radii shrink in one of two ways, [`Radii`]:
//! - *memoryless* (Knaus & Zwicker 2011), the default: by the light paths traced before the pass.
//!   Passes run in any order on any machine and may be merged; pixels remember nothing.
//! - by *statistics* (Hachisuka et al. 2008, 2009): by the photons that the pixel has found.
//!   Radii shrink where photons are, and stay wide where they are few. A pixel's passes must follow
//!   each other, and every part of a divided render starts its radii anew.
//!
//! ```
//! use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
//! let quick = ProgressivePhotonMap::new().paths(20_000);
//! let adaptive = ProgressivePhotonMap::sampling_lights().radii(Radii::Statistics).nearest(30);
//! # let _ = (quick, adaptive);
//! ```
//!
//! # Needs of the host
//! [`Geometry`], [`Shading`], [`Media`], [`LightEmission`], and a [`Sensor`](tyndall_core::Sensor)
//! to drive it; [`ProgressivePhotonMap::sampling_lights`] needs
//! [`LightDirect`](tyndall_core::LightDirect) too.
//!
//! # Radii
//! The starting radius r₀ is meant for [`starting_paths`](ProgressivePhotonMap::starting_paths)
//! light paths (n₀): it is given, or holds the k photons that so many paths would leave nearest to
//! the point. After n paths it is
//!
//! ```text
//! r(n)ᵈ = r₀ᵈ (1 + n/n₀)^(α−1),   d = 2 on surfaces, 3 in media
//! ```
//!
//! exactly in the memoryless way ([`Schedule`](tyndall_density::Schedule)), and by statistics
//! wherever photons are spread evenly: a pixel begins as if it had kept the k photons of its
//! starting radius. The picture to be expected after n paths then does not depend on how many of
//! them make a pass. By statistics this holds while passes are small beside n₀: with n₀ paths a
//! pass radii stay wider by 4 % in media and 5 % on surfaces, with 16 n₀ by 31 % and 39 %.
//!
//! # Bias and variance
//! Of n paths the variance is ∝ n^−α and the bias ∝ n^−2(1−α)/d; with the default α = 4/(4 + d)
//! the root mean square error falls as n^−1/3 on surfaces and n^−2/7 in media, against n^−1/2 of
//! an unbiased method. The bias is blur: within a radius of edges of shadows, of the boundary of a
//! medium and of a surface, of corners and of thin walls, through which light leaks; there it falls
//! only with the radius, not its square.
//!
//! # What it does not handle well
//! By statistics, a pixel whose walks end in bright places and in dark ones has one radius for all
//! of them. Where a medium thins out to nothing, photons that lie in denser places count at
//! collisions in thin ones: rare bright samples. Media that emit are seen but do not light their
//! surroundings. Radii of a pass that leaves only a few photons in a map are those of the whole
//! map.
//!
//! # Promised ranges
//! Radii from 1e-12 to 1e12 scene units ([`RADII`](tyndall_density::RADII)) as they are given and
//! as they have shrunk, α in (0, 1], any extinction, any albedo, 1 to 2⁶⁴ light paths in all. What
//! is out of range is an error of the first pass that meets it.
//!
//! # Cost
//! Memory: the photons of one pass, 29.5 bytes each in three channels, and more while they are
//! traced, bounded by [`max_bytes`](ProgressivePhotonMap::max_bytes); and a [`Pixel`], 32 bytes.
//! Time: linear in light paths, and a search a vertex of sight, ∝ the photons that the radius holds
//! and the logarithm of all; the memoryless way looks for the nearest photons in every pass,
//! statistics in the first alone.
//!
//! # References
//! - Toshiya Hachisuka, Shinji Ogaki, Henrik Wann Jensen (2008), "Progressive Photon Mapping".
//! - Toshiya Hachisuka, Henrik Wann Jensen (2009), "Stochastic Progressive Photon Mapping": the
//!   statistics are the pixel's, its vertices new in every pass.
//! - Claude Knaus, Matthias Zwicker (2011), "Progressive Photon Mapping: A Probabilistic Approach":
//!   the memoryless radii, also in media.
//!
//! Deviations: radii are indexed by light paths, not by passes; a pixel remembers no flux (see
//! [`Pixel`]); in media the points of sight are sampled collisions rather than marched steps.
#![forbid(unsafe_code)]

mod memory;
mod points;
mod reach;

pub use memory::{Pass, Pixel};
pub use tyndall_density::{Kernel, Statistics};
pub use tyndall_walk::{ByPhotons, BySampling};

use memory::Place;
use points::Points;
use reach::Reach;
use std::marker::PhantomData;
use tyndall_core::{
    Aabb, Figure, Geometry, Integrator, LightEmission, Media, PassContext, PassError, Sampler,
    SensorRay, Shading, StateError, Streams,
};
use tyndall_density::Dimension;
use tyndall_photons::{Emission, PhotonMaps, Progress, Start, radiance};
use tyndall_walk::DirectLight;

/// What makes radii shrink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Radii {
    /// The light paths traced before: passes in any order, on any machine.
    #[default]
    Memoryless,
    /// The photons that the pixel has found: adaptive, pass after pass.
    Statistics,
}

/// Progressive photon mapping. `D` says who finds the light that nothing has scattered before.
#[derive(Clone, Copy, Debug)]
pub struct ProgressivePhotonMap<D = ByPhotons> {
    emission: Emission,
    progress: Progress,
    reach: tyndall_photons::Reach,
    kernel: Kernel,
    radii: Radii,
    direct: PhantomData<D>,
}

impl ProgressivePhotonMap {
    /// 100,000 light paths a pass, radii of the 50 nearest photons, memoryless; photons bring
    /// direct light too.
    pub fn new() -> Self {
        Self::default()
    }
}

impl ProgressivePhotonMap<BySampling> {
    /// As [`ProgressivePhotonMap::new`], but direct light is sampled: sharp shadows at once.
    pub fn sampling_lights() -> Self {
        Self::default()
    }
}

impl<D> Default for ProgressivePhotonMap<D> {
    fn default() -> Self {
        Self {
            emission: Emission::default(),
            progress: Progress::default(),
            reach: tyndall_photons::Reach::nearest(50),
            kernel: Kernel::default(),
            radii: Radii::default(),
            direct: PhantomData,
        }
    }
}

impl<D> ProgressivePhotonMap<D> {
    /// Light paths a pass, at least 1. Few make passes quick and memory small; what a pass costs
    /// beside them, its walks of sight, then weighs more.
    #[must_use]
    pub fn paths(mut self, paths: u64) -> Self {
        self.emission.paths = paths;
        self
    }

    /// Bytes that photons may take at any time of a pass, 80 to 124 each in three channels; a pass
    /// that needs more ends in [`PassError::Memory`].
    #[must_use]
    pub fn max_bytes(mut self, bytes: u64) -> Self {
        self.emission.max_bytes = bytes;
        self
    }

    /// Starts with the radius that holds this many photons of
    /// [`starting_paths`](Self::starting_paths) light paths, at least 2.
    #[must_use]
    pub fn nearest(mut self, photons: usize) -> Self {
        self.reach.start = Start::Nearest(photons);
        self
    }

    /// Starts with this radius everywhere, in scene units.
    #[must_use]
    pub fn radius(mut self, radius: f32) -> Self {
        self.reach.start = Start::Radius(radius);
        self
    }

    /// The number of light paths for which the starting radius is meant, at least 1.
    #[must_use]
    pub fn starting_paths(mut self, paths: u64) -> Self {
        self.progress.starting_paths = paths;
        self
    }

    /// The starting radius of the nearest photons is not larger, in scene units; may be infinite.
    /// Without it, a tenth of the diagonal of the host's bounds: see
    /// [`Reach::max_radius`](tyndall_photons::Reach::max_radius).
    #[must_use]
    pub fn max_radius(mut self, radius: f32) -> Self {
        self.reach.max_radius = Some(radius);
        self
    }

    /// The share of photons kept as radii shrink, in (0, 1], on surfaces and in media; 1 keeps the
    /// radius. Without it, 2/3 on surfaces and 4/7 in media, for which the error falls fastest.
    #[must_use]
    pub fn alpha(mut self, alpha: f64) -> Self {
        self.progress.alpha = Some(alpha);
        self
    }

    /// How a photon is smoothed.
    #[must_use]
    pub fn kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    /// What makes radii shrink.
    #[must_use]
    pub fn radii(self, radii: Radii) -> Self {
        Self { radii, ..self }
    }

    /// How far the vertices of one kind gather in pass `pass`.
    fn reach(&self, dimension: Dimension, pass: u64, bounds: Aabb) -> Result<Reach, PassError> {
        let mut share = self.progress.share(dimension, self.emission, pass)?;
        if self.radii == Radii::Statistics {
            share.radius = 1.0; // pixels shrink it
        }
        Ok(Reach {
            search: self.reach.in_pass("", dimension, share, bounds)?,
            shrinkage: self.progress.shrinkage(dimension)?,
            share,
        })
    }
}

impl<H, D> Integrator<H> for ProgressivePhotonMap<D>
where
    H: Geometry + Shading + Media + LightEmission,
    D: DirectLight<H>,
{
    type Pass = Pass<H::Spectrum>;
    type Pixel = Pixel;

    fn begin_pass<R: Streams>(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        previous: Option<Self::Pass>,
    ) -> Result<Self::Pass, PassError> {
        drop(previous); // before the photons of this pass are traced
        let bounds = host.bounds();
        Ok(Pass {
            surfaces: self.reach(Dimension::Two, cx.pass, bounds)?,
            media: self.reach(Dimension::Three, cx.pass, bounds)?,
            maps: PhotonMaps::trace::<H, D, R>(host, cx, self.emission)?,
        })
    }

    fn estimate(
        &self,
        host: &H,
        pass: &Self::Pass,
        pixel: &mut Self::Pixel,
        ray: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let adaptive = self.radii == Radii::Statistics;
        let Pixel { surfaces, media } = pixel;
        let place = |reach, statistics| Place::new(reach, adaptive.then_some(statistics));
        let mut points = Points::<H, D>::new(
            &pass.maps,
            self.kernel,
            place(pass.surfaces, surfaces),
            place(pass.media, media),
        );
        let radiance = radiance(host, ray, &mut points, sampler);
        points.remember();
        radiance
    }

    fn figures(&self, pass: &Self::Pass) -> Vec<Figure> {
        let mut figures = self.emission.figures(pass.maps.photons(), pass.maps.lost);
        if self.radii == Radii::Memoryless {
            figures.extend([
                Figure::range(
                    "radius on surfaces over the starting one",
                    pass.surfaces.share.radius,
                ),
                Figure::range(
                    "radius in media over the starting one",
                    pass.media.share.radius,
                ),
            ]);
        }
        figures
    }

    fn options(&self) -> Vec<(&'static str, String)> {
        let mut options = self.emission.options(D::BY_PHOTONS);
        options.extend(self.progress.options("2/3 on surfaces and 4/7 in media"));
        options.extend(self.reach.options(["radius", "nearest", "max_radius"]));
        let statistics = self.radii == Radii::Statistics;
        options.extend([
            ("kernel", self.kernel.to_string()),
            ("statistics", statistics.to_string()),
        ]);
        options
    }

    fn save_pass(&self, _: &Self::Pass, _: &mut Vec<u8>) -> Result<(), StateError> {
        Ok(())
    }

    fn save_pixel(&self, pixel: &Pixel, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        if self.radii == Radii::Statistics {
            pixel.save(bytes);
        }
        Ok(())
    }

    fn restore_pixel(&self, bytes: &mut &[u8]) -> Result<Pixel, StateError> {
        match self.radii {
            Radii::Memoryless => Ok(Pixel::default()),
            Radii::Statistics => Pixel::restore(bytes),
        }
    }
}
