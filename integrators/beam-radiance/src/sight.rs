//! The walk of sight.

use crate::Pass;
use std::marker::PhantomData;
use tyndall_core::{Geometry, LightEmission, Media, Sampler, Shading};
use tyndall_density::SurfacePoint;
use tyndall_photons::{AlongRay, Gather, Incident, Sight};
use tyndall_walk::{DirectLight, Event, Segment, Vertex, Walk};

/// What is gathered along one walk of sight.
pub(crate) struct Beams<'p, H: Geometry, D> {
    pub(crate) host: &'p H,
    pub(crate) pass: &'p Pass<H::Spectrum>,
    pub(crate) media: AlongRay<H::Spectrum>,
    pub(crate) surfaces: Gather,
    pub(crate) direct: PhantomData<D>,
}

impl<H, D> Sight<H> for Beams<'_, H, D>
where
    H: Geometry + Shading + Media + LightEmission,
    D: DirectLight<H>,
{
    type Direct = D;

    fn segment(
        &mut self,
        walk: &mut Walk<'_, H>,
        segment: Segment<H>,
        _: bool,
        sampler: &mut impl Sampler,
    ) -> (H::Spectrum, Event<H>) {
        let mut radiance = H::Spectrum::default();
        if let Some(medium) = self.host.medium(segment.medium) {
            let (ray, carried) = (&segment.ray, walk.throughput);
            if let Some(photons) = self.pass.photons_in(segment.medium) {
                radiance += self.media.gather(photons, medium, ray, carried, sampler);
            }
        }
        radiance += D::along(self.host, &segment, walk.throughput, sampler);
        (radiance, walk.transmit(segment, sampler))
    }

    /// Segments are gathered whole and crossed: no walk collides.
    fn collision(&mut self, _: &H::Medium, _: &Vertex<H>) -> H::Spectrum {
        H::Spectrum::default()
    }

    fn surface(&mut self, point: &SurfacePoint<'_, H>, light: Incident) -> H::Spectrum {
        let photons = &self.pass.surfaces;
        self.surfaces.incident(photons, point, light).radiance
    }
}
