//! Photon mapping in participating media.
//!
//! A pass traces light paths and stores a photon where each meets a surface that scatters into
//! many directions or collides in a medium. Radiance is the density of the photons nearest to a
//! point. Rays of sight are marched through media, in jittered steps of bounded optical depth, and
//! gather photons at each; at surfaces they gather once, or send out walks that do
//! ([`PhotonMap::final_gather`]). Light that nothing has scattered is brought by photons
//! ([`PhotonMap::new`]), or by sampling the lights ([`PhotonMap::sampling_lights`]): in media that
//! is single scattering, at surfaces direct light. Never by both.
//!
//! ```
//! use tyndall_photon_map::{Kernel, PhotonMap};
//! let quick = PhotonMap::new().paths(20_000);
//! let smooth = PhotonMap::sampling_lights().nearest(200).kernel(Kernel::Cone).final_gather(64);
//! ```
//!
//! # Needs of the host
//! [`Geometry`], [`Shading`], [`Media`], [`LightEmission`], and a
//! [`Sensor`](tyndall_core::Sensor) to drive it. To sample lights,
//! [`LightDirect`](tyndall_core::LightDirect) too.
//!
//! # Bias and variance
//! Each pass has a map of its own, and passes are averaged: noise falls with the square root of
//! their number, **bias stays**. It is that of the [`Kernel`]: a blur of the radius of the `k`
//! nearest, ∝ (k/photons)^(2/3) in media and ∝ k/photons at surfaces where light varies smoothly.
//! More [paths](PhotonMap::paths) a pass lessen it, fewer [nearest](PhotonMap::nearest) do for more
//! noise; the progressive methods take it away. In a field of even density the mean is exact: the
//! `k`-th photon, which only says how far the kernel reaches, is left out.
//!
//! Kernels lose the energy that they spread beyond a boundary: up to half of the multiple
//! scattering next to a flat one, over a radius; and they let light through walls thinner than a
//! radius where the same medium is behind. Marching is unbiased: halving its steps changes no
//! mean.
//!
//! # Promised ranges
//! Radii from 1e-12 to 1e12 scene units; extinction from 0 to 1e6 over the size of the scene, each
//! channel for itself; any albedo; mean cosines up to ±0.999. Infinite media. An image is never
//! NaN; where no photons are found it is black but for what is sampled or seen directly.
//!
//! # What it does not handle well
//! Thin media lit by a narrow beam: few points of a march fall into it. Nearly specular
//! surfaces gather what comes from their sharp directions by walks, one a sample. Light that media
//! emit is seen, but does not light its surroundings.
//!
//! # Cost
//! Tracing is linear in the paths, the build of the maps n log n. A segment in a medium costs one
//! search a step, at most 2.3 + 1 units of optical depth of steps after which it has lost nine
//! tenths, plus its share of what Russian roulette lets on. A search is ∝ k + log n. A photon takes
//! 29.5 bytes in three channels.
//!
//! # References
//! - Henrik Wann Jensen, Per Christensen (1998), "Efficient Simulation of Light Transport in Scenes
//!   with Participating Media Using Photon Maps". Deviations: all scattering is by photons unless
//!   lights are sampled; steps are adapted to the majorant of the medium rather than to the light
//!   found; photons carry their flux times the albedo where they collided.
//! - Henrik Wann Jensen (1996), "Global Illumination Using Photon Maps": caustic and global map,
//!   final gathering. Deviation: no second map of direct light is kept for shadows.
#![forbid(unsafe_code)]

mod gather;

pub use tyndall_density::Kernel;
pub use tyndall_walk::{ByPhotons, BySampling};

use gather::Gathering;
use std::marker::PhantomData;
use tyndall_core::{
    Figure, Geometry, Integrator, LightEmission, Media, PassContext, PassError, Sampler, SensorRay,
    Shading, StateError, Streams,
};
use tyndall_density::Dimension;
use tyndall_photons::{Emission, March, PhotonMaps, Reach, Search, Share, Start, radiance};
use tyndall_walk::DirectLight;

/// Photon mapping. `D` says who finds the light that nothing has scattered.
#[derive(Clone, Copy, Debug)]
pub struct PhotonMap<D = ByPhotons> {
    emission: Emission,
    reach: Reach,
    kernel: Kernel,
    final_gather: u32,
    march: March,
    direct: PhantomData<D>,
}

/// The photons of a pass, and how they are searched.
#[derive(Clone, Debug)]
pub struct Pass<S> {
    /// The photons.
    pub maps: PhotonMaps<S>,
    surfaces: Search,
    media: Search,
}

impl PhotonMap<ByPhotons> {
    /// All light is brought by photons: of the lights the host only needs their emission. Small
    /// lights cast soft shadows in media and at surfaces.
    pub fn new() -> Self {
        Self::default()
    }
}

impl PhotonMap<BySampling> {
    /// Light that nothing has scattered is found by sampling the lights, once a surface and once a
    /// segment in a medium, near to the light where the host tells a
    /// [`pivot`](tyndall_core::LightDirect::pivot): sharp shadows and beams.
    pub fn sampling_lights() -> Self {
        Self::default()
    }
}

impl<D> Default for PhotonMap<D> {
    fn default() -> Self {
        Self {
            emission: Emission::default(),
            reach: Reach::nearest(60),
            kernel: Kernel::default(),
            final_gather: 0,
            march: March {
                step: 0.5,
                min_steps: 8,
            },
            direct: PhantomData,
        }
    }
}

impl<D> PhotonMap<D> {
    /// Light paths of a pass, at least 1; 100,000 by default.
    #[must_use]
    pub fn paths(mut self, paths: u64) -> Self {
        self.emission.paths = paths;
        self
    }

    /// Bytes that photons may take at any time of a pass; 4 GiB by default. Building their maps
    /// takes most: 80 to 124 each in three channels.
    #[must_use]
    pub fn max_bytes(mut self, bytes: u64) -> Self {
        self.emission.max_bytes = bytes;
        self
    }

    /// Gathers as far as the `count`-th nearest photon, at least 2 (below 16, as far as it lies on
    /// average where the 16th is); 60 by default. The same for surfaces and media: in both the
    /// relative noise of an estimate is about 1/√count.
    #[must_use]
    pub fn nearest(mut self, count: usize) -> Self {
        self.reach.start = Start::Nearest(count);
        self
    }

    /// Gathers within a fixed radius, in scene units, instead: blur is the same everywhere and the
    /// mean does not depend on the paths of a pass, but noise grows where light is dim.
    #[must_use]
    pub fn radius(mut self, radius: f32) -> Self {
        self.reach.start = Start::Radius(radius);
        self
    }

    /// The [nearest](PhotonMap::nearest) are looked for no farther than this, in scene units; may
    /// be infinite. Without it, a tenth of the diagonal of the host's bounds: see
    /// [`Reach::max_radius`].
    #[must_use]
    pub fn max_radius(mut self, radius: f32) -> Self {
        self.reach.max_radius = Some(radius);
        self
    }

    /// How photons are weighted by their distance; Epanechnikov by default.
    #[must_use]
    pub fn kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    /// Light that was scattered before it arrives at the first surface in sight is found by this
    /// many walks from there, which gather where they end; 0, the default, gathers it on the spot,
    /// which blurs it. Caustics are gathered on the spot in both cases.
    #[must_use]
    pub fn final_gather(self, walks: u32) -> Self {
        Self {
            final_gather: walks,
            ..self
        }
    }

    /// Largest optical depth of a step through a medium, measured by its majorant; 0.5 by default.
    /// Smaller steps lessen noise, never bias.
    #[must_use]
    pub fn step(mut self, optical_depth: f32) -> Self {
        self.march.step = optical_depth;
        self
    }

    /// Fewest steps through a medium from one surface to the next, at least 1; 8 by default.
    #[must_use]
    pub fn min_steps(mut self, steps: u32) -> Self {
        self.march.min_steps = steps;
        self
    }
}

impl<H, D> Integrator<H> for PhotonMap<D>
where
    H: Geometry + Shading + Media + LightEmission,
    D: DirectLight<H>,
{
    type Pass = Pass<H::Spectrum>;
    type Pixel = ();

    fn begin_pass<R: Streams>(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        previous: Option<Self::Pass>,
    ) -> Result<Self::Pass, PassError> {
        drop(previous); // before the new maps need its memory
        self.march.check()?;
        let bounds = host.bounds();
        let search = |dimension| self.reach.in_pass("", dimension, Share::WHOLE, bounds);
        Ok(Pass {
            surfaces: search(Dimension::Two)?,
            media: search(Dimension::Three)?,
            maps: PhotonMaps::trace::<H, D, R>(host, cx, self.emission)?,
        })
    }

    fn estimate(
        &self,
        host: &H,
        pass: &Self::Pass,
        (): &mut (),
        ray: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let mut gathering = Gathering::<H, D>::new(host, self, pass);
        radiance(host, ray, &mut gathering, sampler)
    }

    fn figures(&self, Pass { maps, .. }: &Self::Pass) -> Vec<Figure> {
        self.emission.figures(maps.photons(), maps.lost)
    }

    fn options(&self) -> Vec<(&'static str, String)> {
        let mut options = self.emission.options(D::BY_PHOTONS);
        options.extend(self.reach.options(["radius", "nearest", "max_radius"]));
        options.extend([
            ("kernel", self.kernel.to_string()),
            ("final_gather", self.final_gather.to_string()),
            ("step", self.march.step.to_string()),
            ("min_steps", self.march.min_steps.to_string()),
        ]);
        options
    }

    /// Nothing: each pass has photons of its own.
    fn save_pass(&self, _: &Self::Pass, _: &mut Vec<u8>) -> Result<(), StateError> {
        Ok(())
    }
}
