//! Direct light: at a vertex, and at a point sampled along a segment.

use crate::Densities;
use glam::Vec3;
use std::marker::PhantomData;
use tyndall_core::{
    Anchor, Geometry, HostTypes, LightDirect, Media, Medium, MediumId, PathFrom, PhaseFunction,
    Ray, Sampler, Shading, Spectrum, SurfaceKind,
};
use tyndall_walk::equiangular::Equiangular;
use tyndall_walk::{Connection, Segment, Site, Vertex};

/// One segment in a medium with the light point that both of its distance samplings share:
/// conditional on that point their weights sum to one.
pub(crate) struct Line<'h, H: HostTypes> {
    medium: &'h H::Medium,
    id: MediumId,
    ray: Ray,
    /// What the walk carries into the segment, for the density of its free flight.
    importance: H::Spectrum,
    /// Names the light point.
    u: [f32; 4],
    /// `None` for light from infinity, which free flight finds alone.
    equiangular: Option<Equiangular>,
}

impl<'h, H: LightDirect> Line<'h, H> {
    pub(crate) fn new(
        host: &H,
        medium: &'h H::Medium,
        segment: &Segment<H>,
        importance: H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> Self {
        let u = sampler.next();
        Self {
            medium,
            id: segment.medium,
            ray: segment.ray,
            importance,
            u,
            equiangular: host
                .pivot(&segment.ray, u)
                .map(|p| Equiangular::new(&segment.ray, p)),
        }
    }

    /// Densities at distance `t` of free flight and of equiangular sampling.
    fn pdfs_t(&self, t: f32) -> (f32, f32) {
        match &self.equiangular {
            None => (1.0, 0.0),
            Some(e) => (
                self.medium.pdf_free_flight(&self.ray, t, self.importance),
                e.pdf_t(t),
            ),
        }
    }
}

/// Gathers direct light for one path.
pub(crate) struct Gather<'h, H, D> {
    host: &'h H,
    densities: PhantomData<D>,
}

impl<'h, H, D> Gather<'h, H, D>
where
    H: Geometry + Shading + Media + LightDirect,
    D: Densities<H>,
{
    pub(crate) fn new(host: &'h H) -> Self {
        Self {
            host,
            densities: PhantomData,
        }
    }

    /// Light from what ends the segment, towards its start; the walk turned into it at `last`,
    /// with density `pdf_w`, or `None` if no light sample could have found it.
    pub(crate) fn ahead(
        &self,
        last: Vec3,
        segment: &Segment<H>,
        pdf_w: Option<f32>,
    ) -> H::Spectrum {
        let direction = segment.ray.direction;
        let light = match &segment.hit {
            Some(hit) => self.host.emitted(hit, -direction),
            None => self.host.background(direction),
        };
        let Some(pdf_w) = pdf_w.filter(|_| !light.is_black()) else {
            return light;
        };
        let source = match &segment.hit {
            Some(hit) => Anchor::Surface(hit.clone()),
            None => Anchor::Direction(direction),
        };
        light * power_heuristic(pdf_w, D::direct_pdf_w(self.host, last, &source))
    }

    /// Light scattered towards the start of the line at an equiangular distance.
    pub(crate) fn along(&self, line: &Line<'h, H>, sampler: &mut impl Sampler) -> H::Spectrum {
        let Some(equiangular) = &line.equiangular else {
            return H::Spectrum::default();
        };
        let t = equiangular.sample(sampler.next_1d());
        let position = line.ray.at(t);
        let sigma_s = line.medium.coefficients(position).sigma_s;
        let (free_flight, pdf_t) = line.pdfs_t(t);
        if sigma_s.is_black() || pdf_t <= 0.0 {
            return H::Spectrum::default();
        }
        let light = self.in_medium(
            line.medium,
            line.id,
            position,
            -line.ray.direction,
            line.u,
            sampler,
        );
        if light.is_black() {
            return light;
        }
        let arriving = line.medium.transmittance(&line.ray.up_to(t), sampler);
        light * sigma_s * arriving * (power_heuristic(pdf_t, free_flight) / pdf_t)
    }

    /// Light scattered back at a vertex, per unit of throughput arriving there.
    pub(crate) fn at(
        &self,
        vertex: &Vertex<H>,
        line: Option<&Line<'h, H>>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        match (&vertex.site, line) {
            (Site::Surface(hit), _) => self.at_surface(vertex, hit, sampler),
            (Site::Collision(coefficients), Some(line)) => {
                let (free_flight, equiangular) = line.pdfs_t(vertex.t);
                let weight = power_heuristic(free_flight, equiangular);
                if weight == 0.0 {
                    return H::Spectrum::default();
                }
                let light = self.in_medium(
                    line.medium,
                    line.id,
                    vertex.position,
                    vertex.wo,
                    line.u,
                    sampler,
                );
                coefficients.albedo() * light * weight
            }
            (Site::Collision(_), None) => unreachable!("light collides only where it was gathered"),
        }
    }

    /// Phase function times arriving light, weighted against scattering.
    fn in_medium(
        &self,
        medium: &H::Medium,
        id: MediumId,
        position: Vec3,
        wo: Vec3,
        u: [f32; 4],
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let Some(direct) = self.host.sample_direct(position, u) else {
            return H::Spectrum::default();
        };
        let phase = medium.phase(position);
        let value = phase.eval(wo, direct.wi);
        if value <= 0.0 {
            return H::Spectrum::default();
        }
        let weight = match direct.pdf_w {
            0.0 => 1.0,
            pdf_w => power_heuristic(pdf_w, phase.pdf_w(wo, direct.wi)),
        };
        let visible = Connection::new(self.host, &Anchor::Point(position), &direct.target, id)
            .transmittance(self.host, sampler);
        direct.weight * visible * (value * weight)
    }

    fn at_surface(
        &self,
        vertex: &Vertex<H>,
        hit: &H::Hit,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        if self.host.surface_kind(hit) != SurfaceKind::Finite {
            return H::Spectrum::default();
        }
        let Some(direct) = self.host.sample_direct(vertex.position, sampler.next()) else {
            return H::Spectrum::default();
        };
        let cosine = self.host.surface(hit).shading_normal.dot(direct.wi).abs();
        let reflected = self
            .host
            .bsdf_eval(hit, vertex.wo, direct.wi, PathFrom::Sensor)
            * cosine;
        if reflected.is_black() {
            return reflected;
        }
        let weight = match direct.pdf_w {
            0.0 => 1.0,
            pdf_w => power_heuristic(pdf_w, D::bsdf_pdf_w(self.host, hit, vertex.wo, direct.wi)),
        };
        let medium = self.host.medium_across(hit, direct.wi, vertex.medium);
        let visible = Connection::new(self.host, &vertex.anchor(), &direct.target, medium)
            .transmittance(self.host, sampler);
        direct.weight * reflected * visible * weight
    }
}

/// p²/(p² + q²), the power heuristic with exponent 2 (Veach 1997, eq. 9.13): the weight of a sample
/// of density `p` that another technique finds with density `q`. 0 for p = 0.
fn power_heuristic(p: f32, q: f32) -> f32 {
    if p == 0.0 {
        return 0.0;
    }
    let ratio = q / p;
    1.0 / (1.0 + ratio * ratio)
}
