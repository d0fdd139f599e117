//! Direct light: at a vertex, and at a point sampled along a segment.

use crate::Densities;
use glam::Vec3;
use std::marker::PhantomData;
use tyndall_core::{
    Anchor, DirectSample, Geometry, HostTypes, LightDirect, Media, Medium, MediumId, PathFrom,
    PhaseFunction, Ray, Sampler, Shading, Spectrum, SurfaceKind,
};
use tyndall_walk::equiangular::Equiangular;
use tyndall_walk::{Connection, Segment, Site, Vertex};

/// Of the density of scattering: see [`competing`].
const RARE: f32 = 4.0;

/// One segment in a medium with the light point that both of its distance samplings share:
/// conditional on that point their weights sum to one.
pub(crate) struct Line<'h, H: HostTypes> {
    medium: &'h H::Medium,
    id: MediumId,
    ray: Ray,
    /// What the walk carries into the segment.
    carried: H::Spectrum,
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
        carried: H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> Self {
        let u = sampler.next();
        Self {
            medium,
            id: segment.medium,
            ray: segment.ray,
            carried,
            u,
            equiangular: host
                .pivot(&segment.ray, u)
                .map(|p| Equiangular::new(&segment.ray, p)),
        }
    }

    /// The probability with which to gather at the equiangular distance `t` rather than at the
    /// collision: by the contributions to be expected, if σs·Tr is as the density of free flight
    /// and 1/d² as the other. Phase function and shadows are not known yet, which the limits allow
    /// for.
    fn preference(&self, t: f32, collision: f32) -> f32 {
        let [(free_flight, pdf_t), (flown, other)] = [t, collision].map(|t| self.pdfs_t(t));
        let here = power_heuristic(pdf_t, free_flight) * free_flight;
        let there = power_heuristic(flown, other) * other;
        let share = here / (here + there);
        if share.is_finite() {
            share.clamp(0.1, 0.9)
        } else {
            0.5
        }
    }

    /// Densities at distance `t` of free flight and of equiangular sampling.
    fn pdfs_t(&self, t: f32) -> (f32, f32) {
        match &self.equiangular {
            None => (1.0, 0.0),
            Some(e) => (
                self.medium.pdf_free_flight(&self.ray, t, self.carried),
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

    /// Light that arrives against a direction, from what is hit or from infinity; the walk turned into
    /// it at `last`, with density `pdf_w`, or `None` if no light sample could have found it.
    pub(crate) fn ahead(
        &self,
        last: Vec3,
        hit: Option<&H::Hit>,
        direction: Vec3,
        pdf_w: Option<f32>,
    ) -> H::Spectrum {
        let (light, source) = match hit {
            Some(hit) => {
                let light = self.host.emitted(hit, -direction);
                (light, Anchor::Surface(hit.clone()))
            }
            None => (
                self.host.background(direction),
                Anchor::Direction(direction),
            ),
        };
        match pdf_w.filter(|_| !light.is_black()) {
            Some(pdf_w) => {
                let direct = D::direct_pdf_w(self.host, last, &source);
                light * power_heuristic(pdf_w, competing(&source, direct, pdf_w))
            }
            None => light,
        }
    }

    /// Light that the medium scatters towards the start of the line, after a flight along it;
    /// `collision` is where that met the medium, and what it carried there.
    ///
    /// Two points are there to gather at, each at the cost of a connection: the equiangular one
    /// and the collision. Where both are, one is chosen by what it promises: the noise that this
    /// adds is cheaper than a second connection.
    pub(crate) fn scattered(
        &self,
        line: &Line<'h, H>,
        collision: Option<(&Vertex<H>, H::Spectrum)>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let t = (line.equiangular.as_ref()).map(|e| e.sample(sampler.next_1d()));
        match (t, collision) {
            (None, None) => H::Spectrum::default(),
            (Some(t), None) => self.along(line, t, sampler),
            (None, Some((vertex, carried))) => carried * self.at_collision(line, vertex, sampler),
            (Some(t), Some((vertex, carried))) => {
                let pmf = line.preference(t, vertex.t);
                if sampler.next_1d() < pmf {
                    self.along(line, t, sampler) / pmf
                } else {
                    carried * self.at_collision(line, vertex, sampler) / (1.0 - pmf)
                }
            }
        }
    }

    /// Light scattered at the equiangular distance `t`.
    fn along(&self, line: &Line<'h, H>, t: f32, sampler: &mut impl Sampler) -> H::Spectrum {
        let position = line.ray.at(t);
        let sigma_s = line.medium.coefficients(position).sigma_s;
        let (free_flight, pdf_t) = line.pdfs_t(t);
        if sigma_s.is_black() || pdf_t <= 0.0 {
            return H::Spectrum::default();
        }
        let light = self.in_medium(line, position, sampler);
        if light.is_black() {
            return light;
        }
        let arriving = line.medium.transmittance(&line.ray.up_to(t), sampler);
        let weight = power_heuristic(pdf_t, free_flight) / pdf_t;
        line.carried * light * sigma_s * arriving * weight
    }

    /// Light scattered where the flight collided, per unit of throughput arriving there.
    fn at_collision(
        &self,
        line: &Line<'h, H>,
        vertex: &Vertex<H>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let (free_flight, equiangular) = line.pdfs_t(vertex.t);
        let weight = power_heuristic(free_flight, equiangular);
        let Site::Collision(coefficients) = &vertex.site else {
            return H::Spectrum::default();
        };
        if weight == 0.0 {
            return H::Spectrum::default();
        }
        coefficients.albedo() * self.in_medium(line, vertex.position, sampler) * weight
    }

    /// Phase function times arriving light, weighted against scattering.
    fn in_medium(
        &self,
        line: &Line<'h, H>,
        position: Vec3,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let Some(direct) = self.host.sample_direct(position, line.u) else {
            return H::Spectrum::default();
        };
        let wo = -line.ray.direction;
        let phase = line.medium.phase(position);
        let value = phase.eval(wo, direct.wi);
        if value <= 0.0 {
            return H::Spectrum::default();
        }
        let weight = direct_weight(&direct, || phase.pdf_w(wo, direct.wi));
        if weight == 0.0 {
            return H::Spectrum::default();
        }
        let here = Anchor::Point(position);
        let visible = Connection::new(self.host, &here, &direct.target, line.id)
            .transmittance(self.host, sampler);
        direct.weight * visible * (value * weight)
    }

    /// Light that a surface scatters back, per unit of throughput arriving there.
    pub(crate) fn at_surface(
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
        let weight = direct_weight(&direct, || {
            D::bsdf_pdf_w(self.host, hit, vertex.wo, direct.wi)
        });
        if weight == 0.0 {
            return H::Spectrum::default();
        }
        let medium = self.host.medium_across(hit, direct.wi, vertex.medium);
        let visible = Connection::new(self.host, &vertex.anchor(), &direct.target, medium)
            .transmittance(self.host, sampler);
        direct.weight * reflected * visible * weight
    }
}

/// The weight of a light sample, which scattering may find with the density that is asked for.
fn direct_weight<S, Hit>(sample: &DirectSample<S, Hit>, scattering: impl Fn() -> f32) -> f32 {
    if sample.pdf_w == 0.0 {
        return 1.0;
    }
    let scattering = scattering();
    let direct = competing(&sample.target, sample.pdf_w, scattering);
    power_heuristic(direct, scattering)
}

/// The density that the weight of a light sample takes for it, where scattering finds the same light
/// with density `scattering`. What comes from infinity is found by flights that go on anyhow, from
/// the same points; a connection pays in directions that are much rarer among those: it is left
/// the excess over [`RARE`] times their density (Karlík et al. 2019, "MIS Compensation: Optimizing
/// Sampling Techniques in Multiple Importance Sampling", for each direction instead of the mean).
/// A sky without a bright spot then costs no connection.
fn competing<Hit>(light: &Anchor<Hit>, direct: f32, scattering: f32) -> f32 {
    match light {
        Anchor::Direction(_) => (direct - RARE * scattering).max(0.0),
        Anchor::Point(_) | Anchor::Surface(_) => direct,
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
