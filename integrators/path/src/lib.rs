//! Volumetric path tracing: the unbiased arbiter of all other methods.
//!
//! Walks start at the sensor. At every surface light is sampled directly; along every segment in a
//! medium it is gathered at a point sampled by free flight or at one sampled by the inverse squared
//! distance to a light; what glows at the end of a segment counts as well, attenuated, but for light
//! from infinity, which is left to the walks that escape. Multiple
//! importance sampling with the power heuristic (Veach 1997, §9.2) weights what more than one
//! technique can find. Light from infinity is sampled directly only where it is much brighter than
//! what scattering would find by itself.
//!
//! # Needs of the host
//! [`Geometry`], [`Shading`], [`Media`], [`LightDirect`], and a [`Sensor`](tyndall_core::Sensor) to
//! drive it. [`Path::new`] weights by densities and needs [`ShadingPdf`](tyndall_core::ShadingPdf)
//! and [`LightPdf`](tyndall_core::LightPdf) too; [`Path::with_unhittable_lights`] does not, for
//! hosts that sample only lights that no ray can hit.
//!
//! # Bias and variance
//! Unbiased, whatever the medium: homogeneous or not, chromatic, emitting, anisotropic, of any
//! albedo, behind null surfaces. A [`Path::max_depth`] leaves out longer paths: that is a bias, and
//! the host should say so beside the picture. Russian roulette is none.
//!
//! # What it does not handle well
//! Small lights behind specular surfaces (caustics of a point light through glass are *not found*,
//! and are black); long forward-peaked multiple scattering converges slowly. The sun or a sky seen
//! through what absorbs more than it scatters is found by the few flights that pass.
//!
//! # Cost
//! One ray a segment, one connection a segment in media, one connection a surface. Linear in
//! samples; error falls with their square root.
//!
//! # References
//! - Eric Veach (1997), "Robust Monte Carlo Methods for Light Transport Simulation".
//! - Christopher Kulla, Marcos Fajardo (2012), "Importance Sampling Techniques for Path Tracing in
//!   Participating Media". Deviation: the pivot is the very point that direct sampling chooses, and
//!   the weights are per light point rather than per light.
//! - Ondřej Karlík et al. (2019), "MIS Compensation: Optimizing Sampling Techniques in Multiple
//!   Importance Sampling". Deviation: compensated for each direction by the density of scattering.
//! - Peter Kutz et al. (2017), "Spectral and Decomposition Tracking for Rendering Heterogeneous
//!   Volumes": free flight for the mixture of channels that the walk still carries.
#![forbid(unsafe_code)]

mod densities;
mod gather;

pub use densities::{Densities, Mis, UnhittableLights};

use gather::Gather;
use std::marker::PhantomData;
use tyndall_core::{
    Geometry, Integrator, LightDirect, Media, Medium, PassContext, PassError, Sampler, SensorRay,
    Shading, Spectrum, Streams,
};
use tyndall_walk::{Event, Line, Site, Walk};

/// How often light may scatter *in media* between the light and the sensor; surfaces count apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scattering {
    /// Never: media absorb and emit. All that a purely absorbing medium requires.
    None,
    /// Once at the most: all that a thin medium, or one of low albedo, requires.
    Single,
    /// As often as it does.
    #[default]
    Multiple,
}

/// The path tracer. `D` says where the densities for multiple importance sampling come from.
#[derive(Clone, Copy, Debug)]
pub struct Path<D = Mis> {
    max_depth: Option<u32>,
    scattering: Scattering,
    densities: PhantomData<D>,
}

impl Path<Mis> {
    /// Unlimited depth, multiple scattering, weighted by the host's densities.
    pub fn new() -> Self {
        Self::default()
    }
}

impl Path<UnhittableLights> {
    /// For hosts whose `sample_direct` returns only lights that no ray can hit (its samples have
    /// `pdf_w` 0): nothing is found twice, and no densities are needed.
    pub fn with_unhittable_lights() -> Self {
        Self::default()
    }
}

impl<D> Default for Path<D> {
    fn default() -> Self {
        Self {
            max_depth: None,
            scattering: Scattering::default(),
            densities: PhantomData,
        }
    }
}

impl<D> Path<D> {
    /// Leaves out paths of more than `scatterings` scatterings, at surfaces and in media. 0 shows
    /// emission alone, 1 direct light. `None` leaves out nothing.
    #[must_use]
    pub fn max_depth(self, scatterings: impl Into<Option<u32>>) -> Self {
        Self {
            max_depth: scatterings.into(),
            ..self
        }
    }

    /// Restricts scattering in media.
    #[must_use]
    pub fn scattering(self, scattering: Scattering) -> Self {
        Self { scattering, ..self }
    }

    /// Whether a walk may scatter once more.
    fn may_scatter(&self, depth: u32) -> bool {
        self.max_depth.is_none_or(|max| depth < max)
    }

    /// Whether it may do so in a medium.
    fn may_collide(&self, depth: u32, collisions: u32) -> bool {
        self.may_scatter(depth)
            && match self.scattering {
                Scattering::None => false,
                Scattering::Single => collisions == 0,
                Scattering::Multiple => true,
            }
    }
}

impl<H, D> Integrator<H> for Path<D>
where
    H: Geometry + Shading + Media + LightDirect,
    D: Densities<H>,
{
    type Pass = ();
    type Pixel = ();

    fn begin_pass<R: Streams>(
        &self,
        _: &H,
        _: &PassContext<'_, R>,
        _: Option<()>,
    ) -> Result<(), PassError> {
        Ok(())
    }

    fn options(&self) -> Vec<(&'static str, String)> {
        let depth = self.max_depth;
        let depth = depth.map_or("unlimited".into(), |depth| depth.to_string());
        let scattering = match self.scattering {
            Scattering::None => "none",
            Scattering::Single => "single",
            Scattering::Multiple => "multiple",
        };
        vec![("max_depth", depth), ("scattering", scattering.into())]
    }

    fn estimate(
        &self,
        host: &H,
        (): &(),
        (): &mut (),
        start: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let gather = Gather::<H, D>::new(host);
        let mut radiance = H::Spectrum::default();
        let mut walk = Walk::from_sensor(host, start);
        let mut last = start.ray.origin;
        let mut pdf_w = None;
        while !walk.throughput.is_black() {
            let segment = walk.segment();
            let carried = walk.throughput;
            let medium = host.medium(segment.medium);
            if let Some(medium) = medium {
                radiance += carried * medium.emitted(&segment.ray, sampler);
            }
            // What a surface at the end sends, a lamp maybe, is attenuated rather than found by those
            // flights that get there. What comes from infinity is mostly as bright as what the medium
            // scatters, and with flights that show one or the other the sum is even.
            let direction = segment.ray.direction;
            if let Some(hit) = &segment.hit {
                let ahead = gather.ahead(last, Some(hit), direction, pdf_w);
                if !ahead.is_black() {
                    let arriving = medium.map(|medium| medium.transmittance(&segment.ray, sampler));
                    radiance += carried * ahead * arriving.unwrap_or(H::Spectrum::splat(1.0));
                }
            }
            let collides = self.may_collide(walk.depth, walk.collisions);
            let line = medium
                .filter(|_| collides)
                .map(|medium| Line::new(host, medium, &segment, carried, sampler));
            let event = if collides {
                walk.fly(segment, sampler)
            } else {
                walk.transmit(segment, sampler)
            };
            if let Some(line) = &line {
                let collision = match &event {
                    Event::Scattering(vertex) if vertex.is_collision() => {
                        Some((vertex, walk.throughput))
                    }
                    _ => None,
                };
                radiance += gather.scattered(line, collision, sampler);
            }
            match event {
                Event::Interface(_) => {}
                Event::Escape(direction) => {
                    radiance += walk.throughput * gather.ahead(last, None, direction, pdf_w);
                    break;
                }
                Event::Scattering(vertex) => {
                    if !self.may_scatter(walk.depth) {
                        break;
                    }
                    if let Site::Surface(hit) = &vertex.site {
                        radiance += walk.throughput * gather.at_surface(&vertex, hit, sampler);
                    }
                    last = vertex.position;
                    match walk.scatter(&vertex, sampler) {
                        Some(scattered) => pdf_w = scattered.pdf_w,
                        None => break,
                    }
                }
            }
        }
        radiance
    }
}
