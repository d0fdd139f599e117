//! The walk of sight.

use crate::Pass;
use crate::gather::BeamGather;
use crate::pass::Points;
use std::marker::PhantomData;
use tyndall_core::{Geometry, LightEmission, Media, Sampler, Shading};
use tyndall_density::SurfacePoint;
use tyndall_photons::{AlongRay, Gather, Incident, March, Sight};
use tyndall_walk::{DirectLight, Event, Segment, Vertex, Walk};

/// What is gathered along one walk of sight.
pub(crate) struct Gathering<'p, H: Geometry, D> {
    pub(crate) host: &'p H,
    pub(crate) pass: &'p Pass<H::Spectrum>,
    pub(crate) march: March,
    pub(crate) beams: BeamGather<H::Spectrum>,
    pub(crate) discs: AlongRay<H::Spectrum>,
    pub(crate) points: Gather,
    pub(crate) surfaces: Gather,
    pub(crate) direct: PhantomData<D>,
}

impl<H, D> Sight<H> for Gathering<'_, H, D>
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
        let light = self.pass.media.get(&segment.medium.0);
        if let (Some(medium), Some(light)) = (self.host.medium(segment.medium), light) {
            let (ray, carried) = (&segment.ray, walk.throughput);
            if let Some(beams) = &light.beams {
                radiance += self.beams.along(beams, medium, ray, carried, sampler);
            }
            radiance += match &light.points {
                None => H::Spectrum::default(),
                Some(Points::Along(discs)) => {
                    self.discs.gather(discs, medium, ray, carried, sampler)
                }
                Some(Points::Marched(photons)) => {
                    let points = &mut self.points;
                    self.march.integrate(medium, ray, carried, sampler, |t| {
                        let wo = -ray.direction;
                        points.medium(photons, ray.at(t), wo, medium).radiance
                    })
                }
            };
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
