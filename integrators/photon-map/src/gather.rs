//! What is gathered along a walk of sight.

use crate::PhotonMap;
use glam::Vec3;
use std::marker::PhantomData;
use tyndall_core::{Geometry, Media, Medium, MediumId, PhaseFunction, Sampler, Shading, Spectrum};
use tyndall_density::SurfacePoint;
use tyndall_photons::{Gather, Incident, PhotonMaps, Sight};
use tyndall_walk::{DirectLight, Event, Segment, Site, Vertex, Walk};

/// The photons of a pass, and how they are gathered.
pub(crate) struct Gathering<'p, H: Geometry + Shading + Media, D> {
    host: &'p H,
    options: &'p PhotonMap<D>,
    maps: &'p PhotonMaps<H::Spectrum>,
    gather: Gather,
    direct: PhantomData<D>,
}

impl<'p, H: Geometry + Shading + Media, D: DirectLight<H>> Gathering<'p, H, D> {
    pub(crate) fn new(
        host: &'p H,
        options: &'p PhotonMap<D>,
        maps: &'p PhotonMaps<H::Spectrum>,
    ) -> Self {
        Self {
            host,
            options,
            maps,
            gather: Gather::new(options.search(), options.kernel),
            direct: PhantomData,
        }
    }

    /// Radiance per scene unit that the medium at `position` scatters towards `wo` of the light that
    /// photons bring.
    fn in_scattered(
        &mut self,
        medium: &H::Medium,
        id: MediumId,
        position: Vec3,
        wo: Vec3,
    ) -> H::Spectrum {
        match self.maps.in_medium(id) {
            Some(photons) => (self.gather.medium(photons, position, wo, medium)).radiance,
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

    /// What is scattered there per scene unit over σt, the density of collisions.
    fn collision(&mut self, vertex: &Vertex<H>, sampler: &mut impl Sampler) -> H::Spectrum {
        let (Site::Collision(coefficients), Some(medium)) =
            (&vertex.site, self.host.medium(vertex.medium))
        else {
            return H::Spectrum::default();
        };
        let (position, wo, albedo) = (vertex.position, vertex.wo, coefficients.albedo());
        let scattered = self.in_scattered(medium, vertex.medium, position, wo);
        let phase = medium.phase(position);
        let direct = D::scattered(
            self.host,
            &vertex.anchor(),
            position,
            |_| vertex.medium,
            |wi| albedo * phase.eval(wo, wi),
            sampler,
        );
        // A channel that does not collide here carries nothing here.
        let over = |scattered, sigma_t| {
            if sigma_t > 0.0 {
                scattered / sigma_t
            } else {
                0.0
            }
        };
        direct + scattered.zip(coefficients.sigma_t(), over)
    }

    fn surface(&mut self, point: &SurfacePoint<'_, H>, light: Incident) -> H::Spectrum {
        let Self { maps, gather, .. } = self;
        let caustic = gather.surface(&maps.caustic, point, true).radiance;
        match light {
            Incident::Unscattered => caustic,
            Incident::All => caustic + gather.surface(&maps.diffuse, point, false).radiance,
        }
    }

    fn final_gather(&self) -> u32 {
        self.options.final_gather
    }
}
