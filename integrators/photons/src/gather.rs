//! What is gathered at points of surfaces and media.

use crate::{Incident, Search, SurfacePhotons};
use glam::Vec3;
use tyndall_core::{Geometry, Medium, Shading};
use tyndall_density::{Kernel, SurfacePoint, in_scattered};
use tyndall_kd_tree::{Nearest, Photons};

/// An estimate, and how many photons are behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gathered<S> {
    /// Radiance; of media per scene unit.
    pub radiance: S,
    /// Photons taken.
    pub photons: u32,
}

/// Estimates densities of photons around points.
#[derive(Debug)]
pub struct Gather {
    search: Search,
    kernel: Kernel,
    room: Nearest,
}

impl Gather {
    /// Room for its searches is allocated by the first.
    pub fn new(search: Search, kernel: Kernel) -> Self {
        Self {
            search,
            kernel,
            room: Nearest::new(0),
        }
    }

    /// What a surface gathers of all photons on surfaces.
    pub fn incident<H: Geometry + Shading>(
        &mut self,
        photons: &SurfacePhotons<H::Spectrum>,
        point: &SurfacePoint<'_, H>,
        light: Incident,
    ) -> Gathered<H::Spectrum> {
        let mut gathered = self.surface(&photons.caustic, point, true);
        if light == Incident::All {
            let scattered = self.surface(&photons.diffuse, point, false);
            gathered.radiance += scattered.radiance;
            gathered.photons += scattered.photons;
        }
        gathered
    }

    /// Radiance that a surface scatters back of the photons on it:
    /// Σ f(wo, wi) |wi·nₛ|/|wi·n| Φ K₂ (Jensen 1996, eq. 4, with a kernel), over those in a flat disc
    /// around the point; of those that arrive from [sharp](SurfacePoint::is_sharp) directions only if
    /// `sharp`.
    pub fn surface<H: Geometry + Shading>(
        &mut self,
        photons: &Photons<H::Spectrum>,
        point: &SurfacePoint<'_, H>,
        sharp: bool,
    ) -> Gathered<H::Spectrum> {
        let mut gathered = Gathered::default();
        let center = point.position();
        let Self {
            search,
            kernel,
            room,
        } = self;
        search.visit(photons, center, room, |slot, distance_squared, radius| {
            if !point.is_near(photons.position(slot) - center, radius) {
                return;
            }
            let (direction, flux) = (photons.direction(slot), photons.flux(slot));
            let radiance = if sharp {
                point.radiance(direction, flux)
            } else {
                point.smooth_radiance(direction, flux)
            };
            gathered.photons += 1;
            gathered.radiance += radiance * kernel.weight_2d(distance_squared, radius);
        });
        gathered
    }

    /// Radiance per scene unit that a medium scatters along `wo` of its `photons`: Σ p(wo, wi) αΦ K₃
    /// (Jensen & Christensen 1998, the volume radiance estimate, with a kernel), over those in a ball around the point.
    pub fn medium<M: Medium>(
        &mut self,
        photons: &Photons<M::Spectrum>,
        position: Vec3,
        wo: Vec3,
        medium: &M,
    ) -> Gathered<M::Spectrum> {
        let mut gathered = Gathered::default();
        let phase = medium.phase(position);
        let Self {
            search,
            kernel,
            room,
        } = self;
        search.visit(photons, position, room, |slot, distance_squared, radius| {
            gathered.photons += 1;
            let scattered = in_scattered(&phase, wo, photons.direction(slot), photons.flux(slot));
            gathered.radiance += scattered * kernel.weight_3d(distance_squared, radius);
        });
        gathered
    }
}
