//! What is gathered along a walk of sight.

use crate::{Pass, PhotonMap};
use glam::Vec3;
use std::marker::PhantomData;
use tyndall_core::{Geometry, Media, MediumId, Sampler, Shading};
use tyndall_density::SurfacePoint;
use tyndall_photons::{Gather, Incident, PhotonMaps, Sight, collided};
use tyndall_walk::{DirectLight, Event, Segment, Vertex, Walk};

/// The photons of a pass, and how they are gathered.
pub(crate) struct Gathering<'p, H: Geometry + Shading + Media, D> {
    host: &'p H,
    options: &'p PhotonMap<D>,
    maps: &'p PhotonMaps<H::Spectrum>,
    surfaces: Gather,
    media: Gather,
    direct: PhantomData<D>,
}

impl<'p, H: Geometry + Shading + Media, D: DirectLight<H>> Gathering<'p, H, D> {
    pub(crate) fn new(host: &'p H, options: &'p PhotonMap<D>, pass: &'p Pass<H::Spectrum>) -> Self {
        Self {
            host,
            options,
            maps: &pass.maps,
            surfaces: Gather::new(pass.surfaces, options.kernel),
            media: Gather::new(pass.media, options.kernel),
            direct: PhantomData,
        }
    }

    /// Radiance per scene unit that the medium at `position` scatters towards `wo` of the light
    /// that photons bring.
    fn in_scattered(
        &mut self,
        medium: &H::Medium,
        id: MediumId,
        position: Vec3,
        wo: Vec3,
    ) -> H::Spectrum {
        match self.maps.in_medium(id) {
            Some(photons) => (self.media.medium(photons, position, wo, medium)).radiance,
            None => H::Spectrum::default(),
        }
    }
}

impl<H: Geometry + Shading + Media, D: DirectLight<H>> Sight<H> for Gathering<'_, H, D> {
    type Direct = D;

    /// Marches; but of walks that were spread each flies to one collision, for there are many.
    fn segment(
        &mut self,
        walk: &mut Walk<'_, H>,
        segment: Segment<H>,
        spread: bool,
        sampler: &mut impl Sampler,
    ) -> (H::Spectrum, Event<H>) {
        if spread {
            return (H::Spectrum::default(), walk.fly(segment, sampler));
        }
        let Some(medium) = self.host.medium(segment.medium) else {
            return (H::Spectrum::default(), walk.transmit(segment, sampler));
        };
        let (ray, id) = (segment.ray, segment.medium);
        let march = self.options.march;
        let scattered = march.integrate(medium, &ray, walk.throughput, sampler, |t, _| {
            self.in_scattered(medium, id, ray.at(t), -ray.direction)
        });
        let direct = D::along(self.host, &segment, walk.throughput, sampler);
        (scattered + direct, walk.transmit(segment, sampler))
    }

    fn collision(&mut self, vertex: &Vertex<H>, sampler: &mut impl Sampler) -> H::Spectrum {
        let (id, position, wo) = (vertex.medium, vertex.position, vertex.wo);
        collided::<H, D>(self.host, vertex, sampler, |medium| {
            self.in_scattered(medium, id, position, wo)
        })
    }

    fn surface(&mut self, point: &SurfacePoint<'_, H>, light: Incident) -> H::Spectrum {
        let photons = self.maps.surfaces();
        self.surfaces.incident(photons, point, light).radiance
    }

    fn final_gather(&self) -> u32 {
        self.options.final_gather
    }
}
