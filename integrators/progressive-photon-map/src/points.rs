//! The points at which a walk of sight gathers.

use crate::memory::Place;
use crate::reach::Room;
use std::marker::PhantomData;
use tyndall_core::{Geometry, HostTypes, Media, Sampler, Shading};
use tyndall_density::{Kernel, SurfacePoint};
use tyndall_photons::{Gather, Gathered, Incident, PhotonMaps, Search, Sight};
use tyndall_walk::{DirectLight, Event, Segment, Vertex, Walk};

/// The vertices of one walk.
pub(crate) struct Points<'p, H: HostTypes, D> {
    maps: &'p PhotonMaps<H::Spectrum>,
    kernel: Kernel,
    surfaces: Place<'p>,
    media: Place<'p>,
    room: Room,
    direct: PhantomData<D>,
}

impl<'p, H: HostTypes, D> Points<'p, H, D> {
    pub(crate) fn new(
        maps: &'p PhotonMaps<H::Spectrum>,
        kernel: Kernel,
        surfaces: Place<'p>,
        media: Place<'p>,
    ) -> Self {
        Self {
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

    fn collision(&mut self, medium: &H::Medium, vertex: &Vertex<H>) -> H::Spectrum {
        let Self { maps, room, .. } = self;
        let (position, wo) = (vertex.position, vertex.wo);
        let photons = maps.in_medium(vertex.medium);
        let radius = (self.media).radius(|reach| reach.around(position, photons.as_slice(), room));
        let gathered = match (photons, radius) {
            (Some(photons), Some(radius)) => Gather::new(Search::Within(radius), self.kernel)
                .medium(photons, position, wo, medium),
            _ => Gathered::default(),
        };
        self.media.found(gathered.photons);
        gathered.radiance
    }

    fn surface(&mut self, point: &SurfacePoint<'_, H>, light: Incident) -> H::Spectrum {
        let Self { maps, room, .. } = self;
        let photons = &maps.surfaces;
        let both = [&photons.caustic, &photons.diffuse];
        let Some(radius) =
            (self.surfaces).radius(|reach| reach.around(point.position(), &both, room))
        else {
            return H::Spectrum::default();
        };
        let mut gather = Gather::new(Search::Within(radius), self.kernel);
        let gathered = gather.incident(photons, point, light);
        self.surfaces.found(gathered.photons);
        gathered.radiance
    }
}
