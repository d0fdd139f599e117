//! The points at which a walk of sight gathers.

use crate::memory::Place;
use crate::reach::Room;
use std::marker::PhantomData;
use tyndall_core::{Geometry, HostTypes, Media, Medium, PhaseFunction, Sampler, Shading, Spectrum};
use tyndall_density::{Kernel, SurfacePoint};
use tyndall_photons::{Gather, Gathered, Incident, PhotonMaps, Search, Sight};
use tyndall_walk::{DirectLight, Event, Segment, Site, Vertex, Walk};

/// The vertices of one walk.
pub(crate) struct Points<'p, H: HostTypes, D> {
    host: &'p H,
    maps: &'p PhotonMaps<H::Spectrum>,
    kernel: Kernel,
    surfaces: Place<'p>,
    media: Place<'p>,
    room: Room,
    direct: PhantomData<D>,
}

impl<'p, H: HostTypes, D> Points<'p, H, D> {
    pub(crate) fn new(
        host: &'p H,
        maps: &'p PhotonMaps<H::Spectrum>,
        kernel: Kernel,
        surfaces: Place<'p>,
        media: Place<'p>,
    ) -> Self {
        Self {
            host,
            maps,
            kernel,
            surfaces,
            media,
            room: Room::new(),
            direct: PhantomData,
        }
    }

    /// Ends the pass for the pixel.
    pub(crate) fn remember(self) {
        self.surfaces.remember();
        self.media.remember();
    }
}

impl<H, D> Sight<H> for Points<'_, H, D>
where
    H: Geometry + Shading + Media,
    D: DirectLight<H>,
{
    type Direct = D;

    /// Flies: what the medium scatters is gathered at the collision.
    fn segment(
        &mut self,
        walk: &mut Walk<'_, H>,
        segment: Segment<H>,
        _: bool,
        sampler: &mut impl Sampler,
    ) -> (H::Spectrum, Event<H>) {
        (H::Spectrum::default(), walk.fly(segment, sampler))
    }

    /// Photons tell the radiance scattered per scene unit; what the walk carries has the density of
    /// collisions, σt, in it.
    fn collision(&mut self, vertex: &Vertex<H>, sampler: &mut impl Sampler) -> H::Spectrum {
        let (Site::Collision(coefficients), Some(medium)) =
            (&vertex.site, self.host.medium(vertex.medium))
        else {
            return H::Spectrum::default();
        };
        let (position, wo) = (vertex.position, vertex.wo);
        let phase = medium.phase(position);
        let albedo = coefficients.albedo();
        let direct = D::scattered(
            self.host,
            &vertex.anchor(),
            position,
            |_| vertex.medium,
            |wi| albedo * phase.eval(wo, wi),
            sampler,
        );
        let Self { maps, room, .. } = self;
        let photons = maps.in_medium(vertex.medium);
        let Some(radius) =
            (self.media).radius(|reach| reach.around(position, photons.as_slice(), room))
        else {
            return direct;
        };
        let gathered = photons.map_or_else(Gathered::default, |photons| {
            Gather::new(Search::Within(radius), self.kernel).medium(photons, position, wo, medium)
        });
        self.media.found(gathered.photons);
        let per_collision = |radiance, sigma_t| match sigma_t {
            0.0 => 0.0, // the walk carries nothing in this channel
            sigma_t => radiance / sigma_t,
        };
        direct + (gathered.radiance).zip(coefficients.sigma_t(), per_collision)
    }

    fn surface(&mut self, point: &SurfacePoint<'_, H>, _: Incident) -> H::Spectrum {
        let Self { maps, room, .. } = self;
        let both = [&maps.caustic, &maps.diffuse];
        let Some(radius) =
            (self.surfaces).radius(|reach| reach.around(point.position(), &both, room))
        else {
            return H::Spectrum::default();
        };
        let mut gather = Gather::new(Search::Within(radius), self.kernel);
        let caustic = gather.surface(&maps.caustic, point, true);
        let diffuse = gather.surface(&maps.diffuse, point, false);
        self.surfaces.found(caustic.photons);
        self.surfaces.found(diffuse.photons);
        caustic.radiance + diffuse.radiance
    }
}
