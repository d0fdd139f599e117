//! The walk of sight that photon methods share.

use glam::Vec3;
use tyndall_core::{
    Geometry, Media, Medium, PhaseFunction, Sampler, SensorRay, Shading, Spectrum, SurfaceKind,
};
use tyndall_density::SurfacePoint;
use tyndall_walk::{DirectLight, Event, Segment, Site, Vertex, Walk};

/// What a method estimates along a walk of sight.
pub trait Sight<H: Geometry + Shading> {
    /// Who finds the light that nothing has scattered.
    type Direct: DirectLight<H>;

    /// The radiance that the medium of a segment scatters towards its start, per unit of what the
    /// walk carries into it, and how the walk goes on from there. `spread` is whether the walk has
    /// been scattered into one of many directions before.
    fn segment(
        &mut self,
        walk: &mut Walk<'_, H>,
        segment: Segment<H>,
        spread: bool,
        sampler: &mut impl Sampler,
    ) -> (H::Spectrum, Event<H>);

    /// The radiance scattered where the walk collided, per unit of what it carried there. The walk
    /// ends here.
    fn collision(&mut self, vertex: &Vertex<H>, sampler: &mut impl Sampler) -> H::Spectrum;

    /// The radiance that a surface scatters back of the light that photons bring.
    fn surface(&mut self, point: &SurfacePoint<'_, H>, light: Incident) -> H::Spectrum;

    /// Walks that find the light scattered before, where the first surface scatters into many
    /// directions: final gathering. None if that light is gathered there.
    fn final_gather(&self) -> u32 {
        0
    }
}

/// Which light a surface gathers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Incident {
    /// All that arrives; but of what was scattered before, no directions that are
    /// [sharp](SurfacePoint::is_sharp).
    All,
    /// Only what was not scattered before: walks find the rest.
    Unscattered,
}

/// The radiance that arrives along `start`.
///
/// The walk goes on through specular surfaces, and ends where a surface or a medium scatters into
/// many directions: there photons are gathered. Of a surface that is nearly specular, it goes on in
/// the sharp directions, for light that was scattered before; light that was not is gathered in
/// all directions, for no walk could find the lights that cannot be hit.
pub fn radiance<H: Geometry + Shading + Media>(
    host: &H,
    start: &SensorRay<H::Spectrum>,
    sight: &mut impl Sight<H>,
    sampler: &mut impl Sampler,
) -> H::Spectrum {
    let state = State {
        spread: false,
        walks: sight.final_gather(),
    };
    follow(host, Walk::from_sensor(host, start), state, sight, sampler)
}

/// What a medium scatters where a walk of sight collided, per unit of what the walk carried there:
/// light that `D` samples, and of that which photons bring what `gather` finds. It returns radiance
/// per scene unit; what a walk carries has the density of collisions, σt, in it.
pub fn collided<H: Geometry + Shading + Media, D: DirectLight<H>>(
    host: &H,
    vertex: &Vertex<H>,
    sampler: &mut impl Sampler,
    gather: impl FnOnce(&H::Medium) -> H::Spectrum,
) -> H::Spectrum {
    let (Site::Collision(coefficients), Some(medium)) = (&vertex.site, host.medium(vertex.medium))
    else {
        return H::Spectrum::default();
    };
    let (phase, albedo) = (medium.phase(vertex.position), coefficients.albedo());
    let direct = D::scattered(
        host,
        &vertex.anchor(),
        vertex.position,
        |_| vertex.medium,
        |wi| albedo * phase.eval(vertex.wo, wi),
        sampler,
    );
    // A channel that does not collide here carries nothing here.
    let per_collision = |radiance, sigma_t| match sigma_t {
        0.0 => 0.0,
        sigma_t => radiance / sigma_t,
    };
    direct + gather(medium).zip(coefficients.sigma_t(), per_collision)
}

/// Where a walk of sight stands.
#[derive(Clone, Copy)]
struct State {
    /// Whether it has been scattered into one of many directions.
    spread: bool,
    /// Walks that gather at the first surface that does so.
    walks: u32,
}

/// The radiance that `walk` finds, times what it carries.
fn follow<'h, H: Geometry + Shading + Media, V: Sight<H>>(
    host: &'h H,
    mut walk: Walk<'h, H>,
    State { mut spread, walks }: State,
    sight: &mut V,
    sampler: &mut impl Sampler,
) -> H::Spectrum {
    let mut radiance = H::Spectrum::default();
    while !walk.throughput.is_black() {
        let segment = walk.segment();
        let (carried, direction) = (walk.throughput, segment.ray.direction);
        if let Some(medium) = host.medium(segment.medium).filter(|_| !spread) {
            radiance += carried * medium.emitted(&segment.ray, sampler);
        }
        let (scattered, event) = sight.segment(&mut walk, segment, spread, sampler);
        radiance += carried * scattered;
        if !spread {
            radiance += walk.throughput * emitted(host, &event, direction);
        }
        let vertex = match event {
            Event::Interface(_) => continue,
            Event::Escape(_) => break,
            Event::Scattering(vertex) => vertex,
        };
        let Site::Surface(hit) = &vertex.site else {
            radiance += walk.throughput * sight.collision(&vertex, sampler);
            break;
        };
        if host.surface_kind(hit) != SurfaceKind::Finite {
            match walk.scatter(&vertex, sampler) {
                Some(_) => continue,
                None => break,
            }
        }
        let point = SurfacePoint::new(host, hit, vertex.wo);
        let gathers = !spread && walks > 0;
        let light = if gathers {
            Incident::Unscattered
        } else {
            Incident::All
        };
        let direct = V::Direct::scattered(
            host,
            &vertex.anchor(),
            vertex.position,
            |wi| host.medium_across(hit, wi, vertex.medium),
            |wi| point.scattered(wi),
            sampler,
        );
        radiance += walk.throughput * (direct + sight.surface(&point, light));
        if gathers {
            for _ in 0..walks {
                let mut onward = walk.clone();
                if let Some(scattered) = onward.scatter(&vertex, sampler) {
                    // Behind a mirror-like coat it may gather again: by one walk, not by as many.
                    let state = State {
                        spread: scattered.pdf_w.is_some(),
                        walks: 1,
                    };
                    radiance += follow(host, onward, state, sight, sampler) / walks as f32;
                }
            }
            break;
        }
        match walk.scatter(&vertex, sampler) {
            Some(scattered) if scattered.pdf_w.is_none() => {}
            Some(scattered) if point.is_sharp(scattered.wi) => spread = true,
            Some(_) | None => break,
        }
    }
    radiance
}

/// What the end of a segment emits, seen along `direction`.
fn emitted<H: Shading>(host: &H, event: &Event<H>, direction: Vec3) -> H::Spectrum {
    match event {
        Event::Interface(hit) => host.emitted(hit, -direction),
        Event::Escape(direction) => host.background(*direction),
        Event::Scattering(vertex) => match &vertex.site {
            Site::Surface(hit) => host.emitted(hit, -direction),
            Site::Collision(_) => H::Spectrum::default(),
        },
    }
}
