//! What is gathered along a walk of sight.

use crate::{Pass, PhotonMap};
use std::marker::PhantomData;
use tyndall_core::{Geometry, Media, Sampler, Shading};
use tyndall_density::SurfacePoint;
use tyndall_photons::{Gather, Incident, PhotonMaps, Sight};
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
        let Self {
            host,
            maps,
            media: gather,
            ..
        } = self;
        let (ray, id) = (&segment.ray, segment.medium);
        let mut radiance = D::along(*host, &segment, walk.throughput, sampler);
        if let (Some(medium), Some(photons)) = (host.medium(id), maps.in_medium(id)) {
            let march = self.options.march;
            radiance += march.integrate(medium, ray, walk.throughput, sampler, |t| {
                let gathered = gather.medium(photons, ray.at(t), -ray.direction, medium);
                gathered.radiance
            });
        }
        (radiance, walk.transmit(segment, sampler))
    }

    fn collision(&mut self, medium: &H::Medium, vertex: &Vertex<H>) -> H::Spectrum {
        let Some(photons) = self.maps.in_medium(vertex.medium) else {
            return H::Spectrum::default();
        };
        let gathered = (self.media).medium(photons, vertex.position, vertex.wo, medium);
        gathered.radiance
    }

    fn surface(&mut self, point: &SurfacePoint<'_, H>, light: Incident) -> H::Spectrum {
        let photons = &self.maps.surfaces;
        self.surfaces.incident(photons, point, light).radiance
    }

    fn final_gather(&self) -> u32 {
        self.options.final_gather
    }
}
