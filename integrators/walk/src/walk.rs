//! The random walk, from the sensor or from a light.

use crate::footprint::Beside;
use glam::Vec3;
use tyndall_core::{
    Anchor, Coefficients, Collision, EmissionSample, Geometry, HostTypes, Media, Medium, MediumId,
    PathFrom, PhaseFunction, Ray, Sampler, SensorRay, Shading, Spectrum, SurfaceKind,
};

/// A walk in progress: a ray that has not yet met anything, and what it carries.
///
/// ```text
/// loop {
///     let segment = walk.segment();           // up to the next surface
///     match walk.fly(segment, sampler) {      // or no further than a collision
///         Event::Scattering(vertex) => …      // gather, then walk.scatter(&vertex, …) or stop
///         Event::Interface(hit) => …          // a null surface: the walk is already behind it
///         Event::Escape(direction) => break,
///     }
/// }
/// ```
pub struct Walk<'h, H: HostTypes> {
    pub(crate) host: &'h H,
    from: PathFrom,
    ray: Ray,
    medium: MediumId,
    /// From the sensor: radiance at the start per radiance along the current ray. From a light:
    /// flux along the current ray, in W.
    pub throughput: H::Spectrum,
    /// Scatterings so far, at surfaces and in media; null surfaces do not count.
    pub depth: u32,
    /// Scatterings in media so far.
    pub collisions: u32,
    /// Largest channel at the start.
    start: f32,
    /// What refraction has divided the throughput of a walk of sight by.
    eta_squared: f32,
    /// Of a walk of light that nothing has scattered into many directions, if they are asked for.
    pub(crate) beside: Option<Box<Beside>>,
}

/// A stretch of a walk inside one medium, up to the next surface or to infinity.
pub struct Segment<H: HostTypes> {
    /// `t_max` is the distance of the surface.
    pub ray: Ray,
    /// What fills it.
    pub medium: MediumId,
    /// What ends it.
    pub hit: Option<H::Hit>,
}

/// Where light scatters.
pub struct Vertex<H: HostTypes> {
    /// Position.
    pub position: Vec3,
    /// Unit vector back to where the walk came from.
    pub wo: Vec3,
    /// Distance from where the segment began.
    pub t: f32,
    /// The medium in which the walk arrived.
    pub medium: MediumId,
    /// What is there.
    pub site: Site<H>,
}

/// What is at a vertex.
pub enum Site<H: HostTypes> {
    /// A collision with the medium.
    Collision(Coefficients<H::Spectrum>),
    /// A surface.
    Surface(H::Hit),
}

// Not derived, for that would ask the host to be `Clone` too.
impl<H: HostTypes> Clone for Walk<'_, H> {
    fn clone(&self) -> Self {
        Self {
            beside: self.beside.clone(),
            ..*self
        }
    }
}

impl<H: HostTypes> Vertex<H> {
    /// Whether it is in a medium.
    pub fn is_collision(&self) -> bool {
        matches!(self.site, Site::Collision(_))
    }

    /// The vertex as an end of connections.
    pub fn anchor(&self) -> Anchor<H::Hit> {
        match &self.site {
            Site::Collision(_) => Anchor::Point(self.position),
            Site::Surface(hit) => Anchor::Surface(hit.clone()),
        }
    }
}

/// How a segment ended.
pub enum Event<H: HostTypes> {
    /// At a collision or a surface that scatters.
    Scattering(Vertex<H>),
    /// At a null surface, which may emit: the walk continues behind it.
    Interface(H::Hit),
    /// Nowhere: the walk left the scene in this direction.
    Escape(Vec3),
}

impl<H: HostTypes> Event<H> {
    /// The collision, if it is one.
    pub(crate) fn collision(&self) -> Option<Collision<H::Spectrum>> {
        match self {
            Self::Scattering(Vertex {
                t,
                site: Site::Collision(coefficients),
                ..
            }) => Some(Collision {
                t: *t,
                coefficients: *coefficients,
            }),
            _ => None,
        }
    }
}

/// How a walk left a vertex.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Scattered {
    /// Density per steradian of the new direction; `None` if it was discrete.
    pub pdf_w: Option<f32>,
    /// The new direction, away from the vertex.
    pub wi: Vec3,
    /// Index of refraction on the side of `wi` over that on the side of `wo`.
    pub eta: f32,
    /// Probability of having survived Russian roulette.
    pub survival: f32,
}

/// Scatterings before Russian roulette begins.
const ROULETTE_FROM: u32 = 3;
/// Scatterings from which a walk that has lost nothing may end too: where nothing absorbs and
/// nothing escapes it would last for ever. Any earlier, the variance of white media a hundred mean
/// free paths thick would be infinite.
const ENDLESS: u32 = 100_000;
/// Its probability of survival from there on.
const ENDLESS_SURVIVAL: f32 = 0.9999;

impl<'h, H: Geometry + Shading + Media> Walk<'h, H> {
    /// A walk of sight, of throughput one.
    pub fn from_sensor(host: &'h H, start: &SensorRay<H::Spectrum>) -> Self {
        Self::new(
            host,
            PathFrom::Sensor,
            start.ray,
            start.medium,
            H::Spectrum::splat(1.0),
        )
    }

    /// A walk of light that carries the flux of `start`.
    pub fn from_light(host: &'h H, start: &EmissionSample<H::Spectrum, H::Hit>) -> Self {
        Self::new(host, PathFrom::Light, start.ray, start.medium, start.flux)
    }

    fn new(
        host: &'h H,
        from: PathFrom,
        ray: Ray,
        medium: MediumId,
        throughput: H::Spectrum,
    ) -> Self {
        Self {
            host,
            from,
            ray,
            medium,
            throughput,
            depth: 0,
            collisions: 0,
            start: throughput.max_channel(),
            eta_squared: 1.0,
            beside: None,
        }
    }

    /// What lies ahead in the current medium.
    pub fn segment(&self) -> Segment<H> {
        let hit = self.host.intersect(&self.ray, self.medium);
        Segment {
            ray: self
                .ray
                .up_to(hit.as_ref().map_or(f32::INFINITY, |(t, _)| *t)),
            medium: self.medium,
            hit: hit.map(|(_, hit)| hit),
        }
    }

    /// Flies along the segment until light meets the medium or the segment ends. At a collision
    /// the throughput is what *arrives*, before the albedo.
    pub fn fly(&mut self, segment: Segment<H>, sampler: &mut impl Sampler) -> Event<H> {
        if let Some(medium) = self.host.medium(segment.medium) {
            let flight = medium.sample_free_flight(&segment.ray, self.throughput, sampler);
            self.throughput *= flight.weight;
            if let Some(collision) = flight.collision {
                return Event::Scattering(Vertex {
                    position: segment.ray.at(collision.t),
                    wo: -segment.ray.direction,
                    t: collision.t,
                    medium: segment.medium,
                    site: Site::Collision(collision.coefficients),
                });
            }
        }
        self.reach(segment)
    }

    /// Goes to the end of the segment: the medium attenuates and does not scatter.
    pub fn transmit(&mut self, segment: Segment<H>, sampler: &mut impl Sampler) -> Event<H> {
        if let Some(medium) = self.host.medium(segment.medium) {
            self.throughput *= medium.transmittance(&segment.ray, sampler);
        }
        self.reach(segment)
    }

    fn reach(&mut self, segment: Segment<H>) -> Event<H> {
        let Segment { ray, medium, hit } = segment;
        let Some(hit) = hit else {
            return Event::Escape(ray.direction);
        };
        if self.host.surface_kind(&hit) == SurfaceKind::Null {
            self.take_along(medium, |host, hit, direction| {
                (host.surface_kind(hit) == SurfaceKind::Null)
                    .then(|| host.spawn(&Anchor::Surface(hit.clone()), direction))
            });
            self.medium = self.host.medium_across(&hit, ray.direction, medium);
            let here = Anchor::Surface(hit.clone());
            self.ray = self.host.spawn(&here, ray.direction);
            return Event::Interface(hit);
        }
        Event::Scattering(Vertex {
            position: self.host.surface(&hit).position,
            wo: -ray.direction,
            t: ray.t_max,
            medium,
            site: Site::Surface(hit),
        })
    }

    /// Leaves the vertex in a sampled direction; `None` if the walk ends here, by absorption or by
    /// Russian roulette.
    pub fn scatter(&mut self, vertex: &Vertex<H>, sampler: &mut impl Sampler) -> Option<Scattered> {
        let (pdf_w, eta) = match &vertex.site {
            Site::Collision(coefficients) => {
                let medium = self.host.medium(vertex.medium)?;
                let phase = medium
                    .phase(vertex.position)
                    .sample(vertex.wo, sampler.next());
                self.throughput *= coefficients.albedo() * phase.weight;
                self.collisions += 1;
                self.beside = None;
                self.ray = self.host.spawn(&Anchor::Point(vertex.position), phase.wi);
                (Some(phase.pdf_w), 1.0)
            }
            Site::Surface(hit) => {
                let (u, from) = (sampler.next(), self.from);
                let sample = self.host.bsdf_sample(hit, vertex.wo, u, from)?;
                self.take_along(vertex.medium, |host, hit, direction| {
                    let beside = host.bsdf_sample(hit, -direction, u, from)?;
                    let alike = sample.delta && beside.delta && beside.eta == sample.eta;
                    alike.then(|| host.spawn(&Anchor::Surface(hit.clone()), beside.wi))
                });
                self.throughput *= sample.weight;
                self.eta_squared *= sample.eta * sample.eta;
                self.medium = self.host.medium_across(hit, sample.wi, vertex.medium);
                self.ray = self.host.spawn(&vertex.anchor(), sample.wi);
                ((!sample.delta).then_some(sample.pdf_w), sample.eta)
            }
        };
        self.depth += 1;
        Some(Scattered {
            pdf_w,
            wi: self.ray.direction,
            eta,
            survival: self.survive(sampler)?,
        })
    }

    /// Sends the rays beside the walk on, from a surface that it has reached.
    fn take_along(&mut self, medium: MediumId, onward: impl Fn(&H, &H::Hit, Vec3) -> Option<Ray>) {
        if let Some(beside) = self.beside.take() {
            let host = self.host;
            let sent = beside.through(host, medium, |hit, direction| onward(host, hit, direction));
            self.beside = sent.map(Box::new);
        }
    }

    /// Russian roulette on the throughput relative to the start: the probability of having
    /// survived, or `None`. A walk that carries nothing ends.
    fn survive(&mut self, sampler: &mut impl Sampler) -> Option<f32> {
        let carried = self.throughput.max_channel();
        if carried <= 0.0 {
            return None;
        }
        if self.depth < ROULETTE_FROM {
            return Some(1.0);
        }
        let scaling = match self.from {
            PathFrom::Sensor => self.eta_squared,
            PathFrom::Light => 1.0,
        };
        let cap = if self.depth < ENDLESS {
            1.0
        } else {
            ENDLESS_SURVIVAL
        };
        let survival = (carried * scaling / self.start).min(cap);
        if survival < 1.0 {
            if sampler.next_1d() >= survival {
                return None;
            }
            self.throughput = self.throughput / survival;
        }
        Some(survival)
    }
}
