//! Direct light: at a vertex, and at a point sampled along a segment.

use crate::Densities;
use glam::Vec3;
use std::marker::PhantomData;
use tyndall_core::{
    Anchor, DirectSample, Geometry, LightDirect, Media, Medium, PathFrom, PhaseFunction, Sampler,
    Shading, Spectrum, SurfaceKind,
};
use tyndall_walk::{Collided, Connection, Line, LinePoint, Site, Vertex, power_heuristic};

/// Of the density of scattering: see [`competing`].
const RARE: f32 = 4.0;

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
    pub(crate) fn scattered(
        &self,
        line: &Line<'h, H>,
        collision: Option<(&Vertex<H>, H::Spectrum)>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let collided = collision.and_then(|(vertex, arriving)| match vertex.site {
            Site::Collision(coefficients) => Some(Collided {
                t: vertex.t,
                arriving,
                coefficients,
            }),
            Site::Surface(_) => None,
        });
        line.gather(collided, sampler, |point, sampler| {
            self.in_medium(point, sampler)
        })
    }

    /// Phase function times arriving light, weighted against scattering.
    fn in_medium(&self, point: LinePoint, sampler: &mut impl Sampler) -> H::Spectrum {
        let LinePoint {
            position,
            wo,
            medium: id,
            u,
        } = point;
        let (Some(direct), Some(medium)) =
            (self.host.sample_direct(position, u), self.host.medium(id))
        else {
            return H::Spectrum::default();
        };
        let phase = medium.phase(position);
        let value = phase.eval(wo, direct.wi);
        if value <= 0.0 {
            return H::Spectrum::default();
        }
        let weight = direct_weight(&direct, || phase.pdf_w(wo, direct.wi));
        if weight == 0.0 {
            return H::Spectrum::default();
        }
        let here = Anchor::Point(position);
        let visible =
            Connection::new(self.host, &here, &direct.target, id).transmittance(self.host, sampler);
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
