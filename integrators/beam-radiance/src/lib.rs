//! The beam radiance estimate: photons in media, gathered along a whole ray at once.
//!
//! Light paths leave photons where they collide. Around each lies a disc that faces whatever ray
//! passes, as large as the photons are sparse there; a ray takes all discs that it goes through, in
//! one traversal of a tree: no marching, no steps to choose, no place looked up twice. With Φ the
//! power that arrives at a photon, α the albedo there, t its distance along the ray and d from it,
//!
//! ```text
//! L = Σ Tr(t) p(wo, wi) αΦ K₂(d, r)
//! ```
//!
//! or, smoothed in three dimensions, the constant density of a ball times ∫Tr dt over the chord:
//! [`Blur`]. Radii reach to the k-th nearest other photon or are fixed, and shrink from pass to
//! pass so that the mean over passes converges: [`BeamRadiance::alpha`].
//!
//! Surfaces gather the photons on them, straight and through specular surfaces.
//!
//! ```
//! use tyndall_beam_radiance::{BeamRadiance, Blur};
//! let method = BeamRadiance::new().paths(200_000).nearest(40);
//! let unshrunk = method.blur(Blur::Ball).alpha(1.0);
//! # let _ = unshrunk;
//! ```
//!
//! # Needs of the host
//! [`Geometry`], [`Shading`], [`Media`] and [`LightEmission`], and a
//! [`Sensor`](tyndall_core::Sensor) to drive it. [`BeamRadiance::sampling_lights`] needs
//! [`LightDirect`](tyndall_core::LightDirect) too.
//!
//! # Bias and variance
//! A radius blurs light over it: the bias is ∝ r². Within r of the boundary of a medium it is ∝ r,
//! for there are photons on one side alone, and light is lost (or leaks, from the same medium behind
//! a thin wall). With the default α the squared error falls fastest with passes, the error as
//! n^−1/3: with discs, and with balls too, for their variance along a ray is ∝ 1/r² as well
//! (measured: shrunk as three dimensions would, n^−0.36 while noise rules and n^−2/7 in the end). It
//! does not depend on how the paths are cut into passes. `alpha(1)` keeps the blur for less noise.
//!
//! In media that are not the same everywhere, [`Transmittance::Table`] adds a bias no larger than
//! its `max_error`, told by [`Integrator::figures`]; [`Transmittance::Tracking`] adds
//! noise instead.
//!
//! # What it does not handle well
//! All light of a pass is one sample: what it blurs is blurred in all pixels. Many photons in one
//! place (a laser's first mean free path, seen from within) have radii that `nearest` makes tiny
//! and `radius` bright. More than k (or 16) photons at one point have no radius and are left out.
//! Thin media hold few photons: collisions are where light was absorbed or scattered, and nothing
//! forces any.
//!
//! # Promised ranges
//! σt from 0 to 1e6 mean free paths a scene, any albedo in \[0, 1\], any phase function. Radii
//! within [`RADII`](tyndall_density::RADII): those beyond are left out if they were found, and
//! refused if they were given. Scenes of 1e-8 to 1e8 units.
//!
//! # Cost
//! Linear in light paths; a ray costs what lies along it, ∝ N^(1/3)·k^(2/3) photons of N. A photon
//! of three channels in a medium takes 24 bytes beside those of its disc (see `tyndall-bvh`);
//! [`Pass::bytes`] tells.
//!
//! # References
//! - Wojciech Jarosz, Matthias Zwicker, Henrik Wann Jensen (2008), "The Beam Radiance Estimate for
//!   Volumetric Photon Mapping". Deviation: transmittance is to where the ray passes the photon,
//!   and in uneven media from an adaptive table rather than one of even steps.
//! - Jaroslav Křivánek et al. (2014), "Unifying Points, Beams, and Paths in Volumetric Light
//!   Transport Simulation": the estimators over discs and balls.
//! - Claude Knaus, Matthias Zwicker (2011), "Progressive Photon Mapping: A Probabilistic Approach".
#![forbid(unsafe_code)]

mod pass;
mod sight;

pub use pass::Pass;
pub use tyndall_density::Kernel;
pub use tyndall_photons::{Blur, Transmittance};
pub use tyndall_walk::{ByPhotons, BySampling};

use sight::Beams;
use std::marker::PhantomData;
use tyndall_core::{
    Figure, Geometry, Integrator, LightEmission, Media, PassContext, PassError, Sampler, SensorRay,
    Shading, StateError, Streams,
};
use tyndall_density::Dimension;
use tyndall_photons::{AlongRay, Emission, Gather, PhotonMaps, Progress, Reach, Start, radiance};
use tyndall_walk::DirectLight;

/// The beam radiance estimate. `D` says who finds light that nothing has scattered before.
#[derive(Clone, Copy, Debug)]
pub struct BeamRadiance<D = ByPhotons> {
    emission: Emission,
    progress: Progress,
    volume: Reach,
    surfaces: Reach,
    kernel: Kernel,
    blur: Blur,
    transmittance: Transmittance,
    direct: PhantomData<D>,
}

impl BeamRadiance<ByPhotons> {
    /// Photons bring all light.
    pub fn new() -> Self {
        Self::default()
    }
}

impl BeamRadiance<BySampling> {
    /// Light that arrives straight from its source is sampled, at surfaces and at one point of
    /// every segment in a medium.
    pub fn sampling_lights() -> Self {
        Self::default()
    }
}

impl<D> Default for BeamRadiance<D> {
    fn default() -> Self {
        Self {
            emission: Emission::default(),
            progress: Progress::default(),
            volume: Reach::nearest(30),
            surfaces: Reach::nearest(50),
            kernel: Kernel::default(),
            blur: Blur::default(),
            transmittance: Transmittance::default(),
            direct: PhantomData,
        }
    }
}

impl<D> BeamRadiance<D> {
    /// Light paths a pass; 100,000 by default. Radii do not depend on it.
    #[must_use]
    pub fn paths(mut self, paths: u64) -> Self {
        self.emission.paths = paths;
        self
    }

    /// Bytes that photons may take at any time of a pass; 4 GiB by default. Finding their radii and
    /// building their discs takes most: up to 128 each in three channels.
    #[must_use]
    pub fn max_bytes(mut self, bytes: u64) -> Self {
        self.emission.max_bytes = bytes;
        self
    }

    /// The light paths for which `nearest`, and every radius at the start, is meant; 100,000 by
    /// default.
    #[must_use]
    pub fn starting_paths(mut self, paths: u64) -> Self {
        self.progress.starting_paths = paths;
        self
    }

    /// The radius of a photon in a medium reaches to its so many-th nearest other, among those of
    /// [`BeamRadiance::starting_paths`]; 30 by default.
    #[must_use]
    pub fn nearest(mut self, photons: usize) -> Self {
        self.volume.start = Start::Nearest(photons);
        self
    }

    /// But it is not larger than this at the start, in scene units; may be infinite. Without it, a
    /// tenth of the diagonal of the host's bounds: see [`Reach::max_radius`].
    #[must_use]
    pub fn max_radius(mut self, radius: f32) -> Self {
        self.volume.max_radius = Some(radius);
        self
    }

    /// One radius for all photons in media.
    #[must_use]
    pub fn radius(mut self, radius: f32) -> Self {
        self.volume.start = Start::Radius(radius);
        self
    }

    /// As [`BeamRadiance::nearest`] around points of surfaces; 50 by default.
    #[must_use]
    pub fn surface_nearest(mut self, photons: usize) -> Self {
        self.surfaces.start = Start::Nearest(photons);
        self
    }

    /// As [`BeamRadiance::max_radius`] on surfaces.
    #[must_use]
    pub fn surface_max_radius(mut self, radius: f32) -> Self {
        self.surfaces.max_radius = Some(radius);
        self
    }

    /// As [`BeamRadiance::radius`] on surfaces.
    #[must_use]
    pub fn surface_radius(mut self, radius: f32) -> Self {
        self.surfaces.start = Start::Radius(radius);
        self
    }

    /// The kernel of discs and of surfaces; [`Kernel::Epanechnikov`] by default. Balls have a
    /// constant one, whatever it is.
    #[must_use]
    pub fn kernel(mut self, kernel: Kernel) -> Self {
        self.kernel = kernel;
        self
    }

    /// Over what photons in media are smoothed; discs by default.
    #[must_use]
    pub fn blur(mut self, blur: Blur) -> Self {
        self.blur = blur;
        self
    }

    /// How transmittance is found where the medium is not the same everywhere.
    #[must_use]
    pub fn transmittance(mut self, transmittance: Transmittance) -> Self {
        self.transmittance = transmittance;
        self
    }

    /// How fast radii shrink from pass to pass, see [`Shrinkage`](tyndall_density::Shrinkage): in
    /// (0, 1], and 1 keeps them. 2/3 by default, the best for
    /// variances ∝ 1/r²: those of discs, balls and surfaces.
    #[must_use]
    pub fn alpha(mut self, alpha: f64) -> Self {
        self.progress.alpha = Some(alpha);
        self
    }
}

impl<H, D> Integrator<H> for BeamRadiance<D>
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
        drop(previous); // its memory is wanted
        self.transmittance.check()?;
        let (two, bounds) = (Dimension::Two, host.bounds());
        // For balls too: a ray meets r² photons, each for a chord of r/r³.
        let share = self.progress.share(two, self.emission, cx.pass)?;
        let volume = (self.volume).in_pass("", Dimension::Three, share, bounds)?;
        let surfaces = (self.surfaces).in_pass("surface_", two, share, bounds)?;
        let maps = PhotonMaps::trace::<H, D, R>(host, cx, self.emission)?;
        Pass::build(
            self.emission,
            maps,
            surfaces,
            volume,
            self.blur,
            share.radius,
        )
    }

    fn estimate(
        &self,
        host: &H,
        pass: &Self::Pass,
        (): &mut (),
        ray: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let mut beams = Beams::<H, D> {
            host,
            pass,
            media: AlongRay::new(self.kernel, self.transmittance),
            surfaces: Gather::new(pass.search, self.kernel),
            direct: PhantomData,
        };
        let radiance = radiance(host, ray, &mut beams, sampler);
        pass.error.report(beams.media.error);
        radiance
    }

    fn figures(&self, pass: &Self::Pass) -> Vec<Figure> {
        let mut figures = self.emission.figures(pass.photons(), pass.lost);
        figures.extend(pass.figures());
        figures
    }

    fn options(&self) -> Vec<(&'static str, String)> {
        let mut options = self.emission.options(D::BY_PHOTONS);
        options.extend(self.progress.options(2.0 / 3.0));
        options.extend(self.volume.options(["radius", "nearest", "max_radius"]));
        let surfaces = ["surface_radius", "surface_nearest", "surface_max_radius"];
        options.extend(self.surfaces.options(surfaces));
        options.extend([
            ("kernel", self.kernel.to_string()),
            ("blur", self.blur.dimensions().to_string()),
        ]);
        options.extend(self.transmittance.options());
        options
    }

    /// Nothing: passes do not know of each other.
    fn save_pass(&self, _: &Self::Pass, _: &mut Vec<u8>) -> Result<(), StateError> {
        Ok(())
    }
}
