//! Sources of light, and the choice among them.
//!
//! A light is chosen with a probability in proportion to its power (the mean of its channels),
//! whatever the point that it is to light; light at infinity counts what falls on the world.

mod area;
mod beam;
mod choice;
mod directional;
mod environment;
mod point;
mod spot;

pub(crate) use area::Area;
pub(crate) use beam::Beam;
pub(crate) use directional::Directional;
pub(crate) use environment::{Environment, Sky};
pub(crate) use point::Point;
pub(crate) use spot::{Spot, cone_height, cone_power};

use crate::host::Hit;
use crate::spectrum::convert;
use choice::Choice;
use glam::Vec3;
use std::f32::consts::PI;
use tyndall_core::{
    Aabb, Anchor, DirectSample, EmissionPdf, EmissionSample, Frame, LightKind, MediumId, Ray,
    Spectrum, warp,
};
use tyndall_surface::{ShapeHit, Surfaces};

/// A source of light: all it sends is in proportion to its colour.
#[derive(Clone, Debug)]
pub(crate) struct Light<S> {
    /// See the kinds for what it is the colour of; of a textured surface the mean.
    pub(crate) colour: S,
    pub(crate) source: Source,
}

/// A kind of light; it emits what its colour says, here taken to be 1.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    Point(Point),
    Spot(Spot),
    Directional(Directional),
    Beam(Beam),
    Area(Area),
    Environment(Environment),
}

/// A sphere around everything.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World {
    center: Vec3,
    radius: f32,
}

impl World {
    pub(crate) fn around(bounds: Aabb) -> Self {
        if bounds.is_empty() {
            let center = Vec3::ZERO;
            return Self {
                center,
                radius: 1.0,
            };
        }
        // A little more, lest rounding leave a corner in the dark.
        let radius = 0.5 * bounds.size().length() * 1.001;
        Self {
            center: bounds.center(),
            radius: if radius > 0.0 { radius } else { 1.0 },
        }
    }

    fn disc_area(self) -> f32 {
        PI * self.radius * self.radius
    }

    /// A ray of unit direction `w` from a point of the disc that covers the world.
    fn ray_from_outside(self, w: Vec3, u: [f32; 2]) -> Ray {
        let across = Frame::around(w).to_world(warp::disk(u).extend(0.0));
        Ray::new(self.center + self.radius * (across - w), w)
    }
}

/// All lights of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Lights<S> {
    lights: Vec<Light<S>>,
    choice: Choice,
    /// Index of the light that primitive 0 of a shape is.
    first_of_shape: Vec<Option<usize>>,
    environment: Option<usize>,
    world: World,
    /// What lies outside of everything.
    ambient: MediumId,
}

impl<S: Spectrum> Lights<S> {
    /// `lights` with the primitives of a shape in order.
    pub(crate) fn new(lights: Vec<Light<S>>, world: World, ambient: MediumId) -> Self {
        let mut first_of_shape = Vec::new();
        for (i, light) in lights.iter().enumerate() {
            if let Source::Area(Area { shape, .. }) = light.source {
                let shape = shape as usize;
                first_of_shape.resize(first_of_shape.len().max(shape + 1), None);
                first_of_shape[shape].get_or_insert(i);
            }
        }
        let is_environment = |l: &Light<S>| matches!(l.source, Source::Environment(_));
        let environment = lights.iter().position(is_environment);
        Self {
            choice: Choice::new(choice::weights(&lights, world)),
            environment,
            lights,
            first_of_shape,
            world,
            ambient,
        }
    }

    /// Radiance from infinity, from the direction `w`.
    pub(crate) fn background(&self, w: Vec3) -> S {
        self.environment
            .map_or(S::default(), |i| self.lights[i].colour_from(w))
    }

    /// Every light and its power; the primitives of a shape in order.
    pub(crate) fn powers(&self) -> impl Iterator<Item = (&Source, S)> {
        let world = self.world;
        (self.lights.iter()).map(move |light| (&light.source, light.power(world)))
    }

    /// Sum of the powers, mean of the channels.
    pub(crate) fn power(&self) -> f32 {
        let powers = self.lights.iter().map(|l| l.power(self.world).mean());
        powers.sum()
    }

    pub(crate) fn sample_emission(
        &self,
        [u0, u1, u2, u3, u4, u5]: [f32; 6],
        surfaces: &Surfaces,
        radiance: impl Fn(&ShapeHit) -> S,
        locate: impl Fn(Vec3) -> MediumId,
    ) -> Option<EmissionSample<S, Hit>> {
        let (i, pmf) = self.choice.sample(u0)?;
        let (world, ambient) = (self.world, self.ambient);
        let light = &self.lights[i];
        let sample = match &light.source {
            Source::Point(light) => light.sample_emission([u1, u2]),
            Source::Spot(light) => light.sample_emission([u1, u2]),
            Source::Directional(light) => light.sample_emission([u1, u2], world, ambient),
            Source::Beam(light) => light.sample_emission([u1, u2]),
            Source::Area(light) => light.sample_emission([u1, u2, u3, u4], surfaces, locate),
            Source::Environment(light) => {
                light.sample_emission([u1, u2, u3, u4, u5], world, ambient)?
            }
        };
        let flux = self.colour(i, &sample.source, radiance) * (sample.flux / pmf);
        (!flux.is_black()).then_some(EmissionSample {
            source: sample.source,
            ray: sample.ray,
            flux,
            pdf: chosen(sample.pdf, pmf),
            cos_theta: sample.cos_theta,
            kind: sample.kind,
            medium: sample.medium,
        })
    }

    pub(crate) fn sample_direct(
        &self,
        from: Vec3,
        [u0, u1, u2, u3]: [f32; 4],
        surfaces: &Surfaces,
        radiance: impl Fn(&ShapeHit) -> S,
    ) -> Option<DirectSample<S, Hit>> {
        let (i, pmf) = self.choice.sample(u0)?;
        let light = &self.lights[i];
        let sample = match &light.source {
            Source::Point(light) => light.sample_direct(from),
            Source::Spot(light) => light.sample_direct(from),
            Source::Directional(light) => light.sample_direct(self.world),
            Source::Beam(light) => light.sample_direct(from)?,
            Source::Area(light) => light.sample_direct(from, [u1, u2], surfaces)?,
            Source::Environment(light) => light.sample_direct([u1, u2, u3], self.world)?,
        };
        let weight = self.colour(i, &sample.target, radiance) * (sample.weight / pmf);
        (weight.is_finite() && !weight.is_black()).then_some(DirectSample {
            target: sample.target,
            wi: sample.wi,
            weight,
            pdf_w: sample.pdf_w * pmf,
            emission: chosen(sample.emission, pmf),
            cos_theta: sample.cos_theta,
            kind: sample.kind,
        })
    }

    /// The colour of light `i` at a point of it; `radiance` is that of surfaces.
    fn colour(&self, i: usize, at: &Anchor<Hit>, radiance: impl Fn(&ShapeHit) -> S) -> S {
        match at {
            Anchor::Surface(hit) => radiance(&hit.shape),
            Anchor::Direction(w) => self.lights[i].colour_from(*w),
            Anchor::Point(_) => self.lights[i].colour,
        }
    }

    /// See [`tyndall_core::LightDirect::pivot`].
    pub(crate) fn pivot(&self, ray: &Ray, u: [f32; 4], surfaces: &Surfaces) -> Option<Vec3> {
        let (i, _) = self.choice.sample(u[0])?;
        match &self.lights[i].source {
            Source::Point(light) => Some(light.position),
            Source::Spot(light) => Some(light.position),
            Source::Beam(light) => Some(light.pivot(ray)),
            Source::Area(light) => Some(light.pivot([u[1], u[2]], surfaces)),
            Source::Directional(_) | Source::Environment(_) => None,
        }
    }

    /// The environment, and its index.
    fn environment(&self) -> Option<(&Environment, usize)> {
        let i = self.environment?;
        match &self.lights[i].source {
            Source::Environment(environment) => Some((environment, i)),
            _ => None,
        }
    }

    /// The light that a hit lies on, and its index.
    fn area_at(&self, hit: &Hit) -> Option<(&Area, usize)> {
        let i =
            (*self.first_of_shape.get(hit.shape.shape as usize)?)? + hit.shape.primitive as usize;
        match &self.lights[i].source {
            Source::Area(area) => Some((area, i)),
            _ => None,
        }
    }

    pub(crate) fn pdf_direct_w(&self, from: Vec3, to: &Anchor<Hit>, surfaces: &Surfaces) -> f32 {
        match to {
            Anchor::Point(_) => 0.0,
            Anchor::Direction(w) => {
                let environment = self.environment();
                environment.map_or(0.0, |(light, i)| self.choice.pmf(i) * light.pdf_w(*w))
            }
            Anchor::Surface(hit) => self.area_at(hit).map_or(0.0, |(_, i)| {
                self.choice.pmf(i) * surfaces.pdf_from_w(&hit.shape, from)
            }),
        }
    }

    pub(crate) fn pdf_emission(
        &self,
        at: &Anchor<Hit>,
        direction: Vec3,
        surfaces: &Surfaces,
    ) -> EmissionPdf {
        let pdf = match at {
            Anchor::Point(_) => None,
            Anchor::Direction(w) => {
                (self.environment()).map(|(light, i)| (light.pdf_emission(*w, self.world), i))
            }
            Anchor::Surface(hit) => self.area_at(hit).map(|(area, i)| {
                let normal = surfaces.surface(&hit.shape).geometric_normal;
                (area.pdf_emission(direction.dot(normal)), i)
            }),
        };
        pdf.map_or_else(EmissionPdf::default, |(pdf, i)| {
            chosen(pdf, self.choice.pmf(i))
        })
    }
}

impl<S: Spectrum> Light<S> {
    fn power(&self, world: World) -> S {
        let power = match &self.source {
            Source::Point(light) => light.power(),
            Source::Spot(light) => light.power(),
            Source::Directional(light) => light.power(world),
            Source::Beam(_) => 1.0,
            Source::Area(light) => light.power(),
            Source::Environment(light) => {
                return self.colour * convert::<S>(light.power(world));
            }
        };
        self.colour * power
    }

    /// The colour of light that arrives from the direction `w`.
    fn colour_from(&self, w: Vec3) -> S {
        match &self.source {
            Source::Environment(Environment::Image(sky)) => {
                self.colour * convert::<S>(sky.radiance(w))
            }
            _ => self.colour,
        }
    }

    /// The same light in other channels.
    pub(crate) fn map<T>(self, f: impl FnOnce(S) -> T) -> Light<T> {
        Light {
            colour: f(self.colour),
            source: self.source,
        }
    }
}

impl Source {
    /// Where it is, if it is somewhere.
    pub(crate) fn position(&self) -> Option<Vec3> {
        match self {
            Self::Point(light) => Some(light.position),
            Self::Spot(light) => Some(light.position),
            Self::Beam(light) => Some(light.position),
            Self::Directional(_) | Self::Area(_) | Self::Environment(_) => None,
        }
    }

    /// Whether it has no colours of its own.
    pub(crate) fn is_grey(&self) -> bool {
        match self {
            Self::Environment(Environment::Image(sky)) => sky.is_grey(),
            _ => true,
        }
    }

    /// Puts it into the medium that `locate` finds around it.
    pub(crate) fn immerse(&mut self, locate: impl Fn(Vec3) -> MediumId) {
        match self {
            Self::Point(light) => light.medium = locate(light.position),
            Self::Spot(light) => light.medium = locate(light.position),
            Self::Beam(light) => light.medium = locate(light.position),
            Self::Directional(_) | Self::Area(_) | Self::Environment(_) => {}
        }
    }
}

/// Light of this `irradiance` that no ray finds by chance.
fn unhittable(
    kind: LightKind,
    target: Anchor<Hit>,
    wi: Vec3,
    irradiance: f32,
    emission: EmissionPdf,
) -> DirectSample<f32, Hit> {
    DirectSample {
        target,
        wi,
        weight: irradiance,
        pdf_w: 0.0,
        emission,
        cos_theta: 1.0,
        kind,
    }
}

/// The probability of the choice counts with the position.
fn chosen(pdf: EmissionPdf, pmf: f32) -> EmissionPdf {
    EmissionPdf {
        pdf_a: pdf.pdf_a * pmf,
        pdf_w: pdf.pdf_w,
    }
}
