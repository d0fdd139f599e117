//! Photon beams: light paths kept as the segments that they fly, not only as the points where they
//! collide.
//!
//! A ray of sight takes every beam that it passes within the beam's radius, where the two are
//! closest; blur is over one dimension only, across both. With Φ the flux at the start of a beam, w
//! its direction, t and v the distances along ray and beam, d between them, θ the angle,
//!
//! ```text
//! L = Σ σs p(wo, −w) Φ Tr(t) Tr(v) K₁(d, r) / sin θ
//! ```
//!
//! All other choices of data, query and blur are there too: [`Estimate`], and [`estimators`] for
//! how each decides where a ray and a beam meet. Surfaces gather the photons on them, straight and
//! through specular surfaces.
//!
//! ```
//! use tyndall_photon_beams::{Estimate, PhotonBeams};
//! let method = PhotonBeams::new().paths(20_000).beam_radius(0.05);
//! let other = method.estimator(Estimate::BeamBeam2DRay);
//! # let _ = other;
//! ```
//!
//! # Needs of the host
//! [`Geometry`], [`Shading`], [`Media`] and [`LightEmission`], and a
//! [`Sensor`](tyndall_core::Sensor) to drive it. [`PhotonBeams::sampling_lights`] needs
//! [`LightDirect`](tyndall_core::LightDirect) too.
//!
//! # Bias and variance
//! A radius blurs light over it, in one dimension ∝ r², and ∝ r within it of the boundary of a
//! medium. With the default α the squared error falls fastest with passes. Beams that are met at an
//! angle of sine below 0.1 are handed over to two dimensions, all of them below 0.03.
//!
//! Where the mean free path is no longer than πr/2, photons are the better estimator, and are kept
//! instead: whether a flight leaves a beam or a photon depends on where it starts and goes, never
//! on how far it gets, so that the split is unbiased.
//!
//! # Widths
//! All beams have one radius, or each its own, linear along it: by photon differentials
//! ([`PhotonBeams::beam_differentials`]), narrow where lenses focus light and wide where it fans out,
//! or by the nearest ends of others ([`PhotonBeams::beam_nearest`]). It is that where they are met.
//! The least and the most of it shrink from pass to pass as one radius does.
//!
//! # What it does not handle
//! Beams are round: of light that a lens focuses to a line, differentials give the area, not the axes.
//!
//! # Cost
//! Linear in light paths; a ray costs what it meets, and the pieces of beams near to it. A beam of
//! three channels takes 56 bytes and 33 to 36 a piece, of which it has 12 at most on the mean; in
//! media that vary 16 more for each flight along it. [`Pass::bytes`] tells.
//!
//! # References
//! - Wojciech Jarosz, Derek Nowrouzezahrai, Iman Sadeghi, Henrik Wann Jensen (2011a), "A
//!   Comprehensive Theory of Volumetric Radiance Estimation Using Photon Points and Beams".
//!   Deviation: what is left to integrate over after a meeting is sampled at one place, so that all
//!   estimators are right in any medium.
//! - Wojciech Jarosz, Derek Nowrouzezahrai, Robert Thomas, Peter-Pike Sloan, Matthias Zwicker
//!   (2011b), "Progressive Photon Beams".
//! - Jaroslav Křivánek et al. (2014), "Unifying Points, Beams, and Paths in Volumetric Light
//!   Transport Simulation": long and short beams.
#![forbid(unsafe_code)]

mod beam;
pub mod estimators;
mod extent;
mod gather;
mod pass;
mod sight;
mod width;

pub use extent::Extent;
pub use pass::Pass;
pub use tyndall_density::{Estimate, Kernel};
pub use tyndall_photons::Transmittance;
pub use tyndall_walk::{ByPhotons, BySampling};

use beam::Rule;
use gather::{BeamGather, Rules};
use sight::Gathering;
use std::marker::PhantomData;
use tyndall_core::{
    Aabb, Figure, Geometry, Integrator, LightEmission, Media, PassContext, PassError, Sampler,
    SensorRay, Shading, StateError, Streams,
};
use tyndall_density::{Dimension, RADII};
use tyndall_photons::{
    AlongRay, Emission, Gather, March, Progress, Reach, Start, Traced, ensure, radiance,
};
use tyndall_walk::DirectLight;
use width::Width;

/// Photon beams. `D` says who finds light that nothing has scattered before.
#[derive(Clone, Copy, Debug)]
pub struct PhotonBeams<D = ByPhotons> {
    emission: Emission,
    progress: Progress,
    estimate: Estimate,
    light: Extent,
    sight: Extent,
    beam_radius: Option<f32>,
    width: Width,
    flights: u32,
    volume: Reach,
    surfaces: Reach,
    kernel: Kernel,
    transmittance: Transmittance,
    march: March,
    direct: PhantomData<D>,
}

impl PhotonBeams<ByPhotons> {
    /// Photons and beams bring all light.
    pub fn new() -> Self {
        Self::default()
    }
}

impl PhotonBeams<BySampling> {
    /// Light that arrives straight from its source is sampled, at surfaces and at one point of
    /// every segment in a medium.
    pub fn sampling_lights() -> Self {
        Self::default()
    }
}

impl<D> Default for PhotonBeams<D> {
    fn default() -> Self {
        Self {
            emission: Emission {
                paths: 10_000,
                ..Emission::default()
            },
            progress: Progress {
                starting_paths: 10_000,
                alpha: None,
            },
            estimate: Estimate::default(),
            light: Extent::Long,
            sight: Extent::Long,
            beam_radius: None,
            width: Width::default(),
            flights: 4,
            volume: Reach::nearest(30),
            surfaces: Reach::nearest(50),
            kernel: Kernel::default(),
            transmittance: Transmittance::default(),
            march: March {
                step: 0.5,
                min_steps: 8,
            },
            direct: PhantomData,
        }
    }
}

impl<D> PhotonBeams<D> {
    /// Light paths a pass; 10,000 by default. Radii do not depend on it.
    #[must_use]
    pub fn paths(mut self, paths: u64) -> Self {
        self.emission.paths = paths;
        self
    }

    /// Bytes that photons and beams may take at any time of a pass; 4 GiB by default.
    #[must_use]
    pub fn max_bytes(mut self, bytes: u64) -> Self {
        self.emission.max_bytes = bytes;
        self
    }

    /// The light paths for which radii at the start are meant; 10,000 by default.
    #[must_use]
    pub fn starting_paths(mut self, paths: u64) -> Self {
        self.progress.starting_paths = paths;
        self
    }

    /// How light in media is kept, asked for and blurred; [`Estimate::BeamBeam1D`] by default.
    #[must_use]
    pub fn estimator(mut self, estimate: Estimate) -> Self {
        self.estimate = estimate;
        self
    }

    /// How far beams of light go; [`Extent::Long`] by default.
    #[must_use]
    pub fn light_beams(mut self, extent: Extent) -> Self {
        self.light = extent;
        self
    }

    /// How far beams of sight go; [`Extent::Long`] by default.
    #[must_use]
    pub fn sight_beams(mut self, extent: Extent) -> Self {
        self.sight = extent;
        self
    }

    /// The radius of beams at the start, in scene units; the largest, where it is not the same for
    /// all. Without it, a two-hundredth of the diagonal of the host's bounds; it must be given if they
    /// are infinite or empty.
    #[must_use]
    pub fn beam_radius(mut self, radius: f32) -> Self {
        self.beam_radius = Some(radius);
        self
    }

    /// Radii by photon differentials (Schjøth et al. 2007): so many times that of the disc which holds
    /// the light of one path of [`PhotonBeams::starting_paths`], wherever along the beam it is met.
    /// Beams fan out with the light and narrow where specular surfaces focus it, down to a 32nd of
    /// [`PhotonBeams::beam_radius`]. What was scattered into many directions has that radius.
    #[must_use]
    pub fn beam_differentials(mut self, scale: f32) -> Self {
        self.width = Width::Differentials(scale);
        self
    }

    /// Radii that at both ends of a beam reach to the so many-th nearest end of others, and are
    /// linear between; at least 2, of beams of [`PhotonBeams::starting_paths`]. They are a 32nd of
    /// [`PhotonBeams::beam_radius`] at least.
    #[must_use]
    pub fn beam_nearest(mut self, ends: usize) -> Self {
        self.width = Width::Nearest(ends);
        self
    }

    /// Free flights, at least 1, that estimate the transmittance of a long beam of light in media
    /// that are not the same everywhere; 4 by default.
    #[must_use]
    pub fn light_flights(mut self, flights: u32) -> Self {
        self.flights = flights;
        self
    }

    /// The radius of a photon in a medium, where no beams are kept, reaches to its so many-th nearest
    /// other among those of [`PhotonBeams::starting_paths`]; 30 by default.
    #[must_use]
    pub fn nearest(mut self, photons: usize) -> Self {
        self.volume.start = Start::Nearest(photons);
        self
    }

    /// But it is not larger than this at the start, in scene units: see [`Reach::max_radius`].
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

    /// As [`PhotonBeams::nearest`] around points of surfaces; 50 by default.
    #[must_use]
    pub fn surface_nearest(mut self, photons: usize) -> Self {
        self.surfaces.start = Start::Nearest(photons);
        self
    }

    /// As [`PhotonBeams::max_radius`] on surfaces.
    #[must_use]
    pub fn surface_max_radius(mut self, radius: f32) -> Self {
        self.surfaces.max_radius = Some(radius);
        self
    }

    /// As [`PhotonBeams::radius`] on surfaces.
    #[must_use]
    pub fn surface_radius(mut self, radius: f32) -> Self {
        self.surfaces.start = Start::Radius(radius);
        self
    }

    /// The kernel; [`Kernel::Epanechnikov`] by default.
    #[must_use]
    pub fn kernel(mut self, kernel: Kernel) -> Self {
        self.kernel = kernel;
        self
    }

    /// How the transmittance of rays of sight is found where the medium is not the same everywhere.
    #[must_use]
    pub fn transmittance(mut self, transmittance: Transmittance) -> Self {
        self.transmittance = transmittance;
        self
    }

    /// How fast radii shrink from pass to pass, see [`Shrinkage`](tyndall_density::Shrinkage): in
    /// (0, 1], and 1 keeps them. Without it each kind has its best, 4/(4 + d): 0.8 for beams blurred
    /// in one dimension, 2/3 for those in more, for points and for surfaces.
    #[must_use]
    pub fn alpha(mut self, alpha: f64) -> Self {
        self.progress.alpha = Some(alpha);
        self
    }

    /// Of beams, over which the radii of passes are.
    fn starting_radius(&self, bounds: Aabb) -> Result<f32, PassError> {
        let diagonal = (bounds.max - bounds.min).length();
        let radius = self.beam_radius.unwrap_or(diagonal / 200.0);
        ensure(
            !self.estimate.takes_beams() || RADII.contains(&radius),
            || {
                let why = match self.beam_radius {
                    None => "is not given, and the scene has no extent to take it from".to_owned(),
                    Some(radius) => format!("is {radius}"),
                };
                format!("`beam_radius` {why}: name one in 1e-12 to 1e12 scene units")
            },
        )?;
        Ok(radius)
    }

    fn dimension(&self) -> Dimension {
        match self.estimate {
            Estimate::BeamBeam1D => Dimension::One,
            _ => Dimension::Two,
        }
    }
}

impl<H, D> Integrator<H> for PhotonBeams<D>
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
        self.march.check()?;
        ensure(self.flights > 0, || {
            "`light_flights` is 0; give 1 at least".to_owned()
        })?;
        let (two, bounds) = (Dimension::Two, host.bounds());
        let beams = self
            .progress
            .share(self.dimension(), self.emission, cx.pass)?;
        let share = self.progress.share(two, self.emission, cx.pass)?;
        let volume = (self.volume).in_pass("", Dimension::Three, share, bounds)?;
        let surfaces = self.surfaces.in_pass("surface_", two, share, bounds)?;
        let most = self.starting_radius(bounds)? * beams.radius;
        let starting_paths = self.progress.starting_paths;
        let radii = (self.width).in_pass(most, beams.radius, starting_paths, beams.paths)?;
        let rule = Rule {
            beams: self.estimate.takes_beams(),
            extent: self.light,
            flights: self.flights,
            radii,
        };
        let paths = (self.emission.light_paths(cx)).footprints(radii.by_footprints());
        let traced =
            Traced::trace::<H, D, R>(host, paths, self.emission, |flight, sampler, keep| {
                rule.keep(host, flight, sampler, keep);
            })?;
        Pass::build(
            self.emission,
            traced,
            self.estimate,
            [surfaces, volume],
            radii,
            beams.radius,
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
        let rules = Rules {
            estimate: self.estimate,
            kernel: self.kernel,
            light: self.light,
            sight: self.sight,
            transmittance: self.transmittance,
            march: self.march,
        };
        let mut gathering = Gathering::<H, D> {
            host,
            pass,
            march: self.march,
            beams: BeamGather::new(rules),
            discs: AlongRay::new(self.kernel, self.transmittance),
            points: Gather::new(pass.volume, self.kernel),
            surfaces: Gather::new(pass.search, self.kernel),
            direct: PhantomData,
        };
        let radiance = radiance(host, ray, &mut gathering, sampler);
        (pass.error).report(gathering.beams.error.max(gathering.discs.error));
        radiance
    }

    fn figures(&self, pass: &Self::Pass) -> Vec<Figure> {
        pass.figures(self.emission)
    }

    fn options(&self) -> Vec<(&'static str, String)> {
        let mut options = self.emission.options(D::BY_PHOTONS);
        options.push(("starting_paths", self.progress.starting_paths.to_string()));
        options.extend(
            self.progress
                .alpha
                .map(|alpha| ("alpha", alpha.to_string())),
        );
        options.extend([
            ("estimator", self.estimate.to_string()),
            ("light_beams", self.light.to_string()),
            ("sight_beams", self.sight.to_string()),
            ("light_flights", self.flights.to_string()),
            ("kernel", self.kernel.to_string()),
        ]);
        let radius = self
            .beam_radius
            .map(|radius| ("beam_radius", radius.to_string()));
        options.extend(radius);
        options.extend(match self.width {
            Width::Fixed => None,
            Width::Differentials(scale) => Some(("beam_differentials", scale.to_string())),
            Width::Nearest(ends) => Some(("beam_nearest", ends.to_string())),
        });
        options.extend(self.volume.options(["radius", "nearest", "max_radius"]));
        let surfaces = ["surface_radius", "surface_nearest", "surface_max_radius"];
        options.extend(self.surfaces.options(surfaces));
        options.extend(self.transmittance.options());
        options
    }

    /// Nothing: passes do not know of each other.
    fn save_pass(&self, _: &Self::Pass, _: &mut Vec<u8>) -> Result<(), StateError> {
        Ok(())
    }
}
