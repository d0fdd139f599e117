//! What light paths leave in media: beams, or photons where beams do not pay.

use crate::Extent;
use crate::width::Radii;
use std::f32::consts::FRAC_PI_2;
use std::ops::ControlFlow;
use tyndall_bvh::BeamShape;
use tyndall_core::{Coefficients, Media, Medium, MediumId, Ray, Sampler, Spectrum};
use tyndall_kd_tree::Photon;
use tyndall_photons::{Keep, collided};
use tyndall_walk::{Flight, Flights};

/// The longest beam, in scene units: its end is a place that a tree can hold.
const LONGEST: f32 = 1e17;

/// What a flight of light leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Left<S> {
    /// A beam, and the flux at its start; its transmittance follows, if there is no closed form.
    Beam(MediumId, BeamShape, S),
    /// How far one of the free flights along the last beam got, and the transmittance to what lies
    /// before that and behind the one that follows.
    Reached(f32, S),
    /// A photon where the flight collided, with the flux that scatters there.
    Point(MediumId, Photon<S>),
}

/// How beams are made of flights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rule {
    /// Whether any beams are wanted.
    pub(crate) beams: bool,
    /// How far they go.
    pub(crate) extent: Extent,
    /// Free flights that estimate the transmittance of a long one, where there is no closed form.
    pub(crate) flights: u32,
    pub(crate) radii: Radii,
}

impl Rule {
    /// Keeps what a flight leaves. Whether that is a beam or a photon depends on where the flight
    /// starts and where it goes, never on how far it gets: the split is unbiased.
    pub(crate) fn keep<H: Media>(
        &self,
        host: &H,
        flight: &Flight<H::Spectrum>,
        sampler: &mut impl Sampler,
        keep: &mut Keep<'_, H::Spectrum, Left<H::Spectrum>>,
    ) {
        let Some(medium) = host.medium(flight.medium) else {
            return;
        };
        if !self.beams || mean_free_path(medium, &flight.ray) <= FRAC_PI_2 * self.radii.most {
            if let Some(photon) = collided(flight) {
                keep.push(Left::Point(flight.medium, photon));
            }
            return;
        }
        let ray = &flight.ray;
        let beam = |length: f32, flux: H::Spectrum| {
            let length = length.min(LONGEST);
            let (radii, limits) = self.radii.of(flight.footprint.as_ref(), length);
            let shape = BeamShape {
                origin: ray.origin,
                direction: ray.direction,
                length,
                radii,
                limits,
            };
            Left::Beam(flight.medium, shape, flux)
        };
        let even = medium.homogeneous();
        match (self.extent, even) {
            (Extent::Short, _) => {
                let reached = flight.collision.map_or(ray.t_max, |c| c.t);
                keep.push(beam(reached, flight.end));
            }
            (Extent::Long, Some(coefficients)) => {
                let flown = Fading::new(coefficients).length(sampler.next_1d());
                if flown > 0.0 {
                    keep.push(beam(ray.t_max.min(flown), flight.start));
                }
            }
            (Extent::Long, None) => {
                let ray = ray.up_to(ray.t_max.min(matter_ends(medium, ray)));
                let mut room = Flights::default();
                room.fly(medium, &ray, self.flights, flight.start, sampler);
                let ends = room.ends();
                let farthest = ends.last().map_or(0.0, |(t, _)| t.min(ray.t_max));
                keep.push(beam(farthest, flight.start));
                for (t, transmittance) in ends {
                    keep.push(Left::Reached(*t, *transmittance));
                }
            }
        }
    }
}

/// Optical depth from which on a long beam is as long as a free flight.
const FULL: f32 = 3.0;

/// How long beams fade in a homogeneous medium.
///
/// They would be endless: nearly all of one, and of what the tree must find room for, would be too
/// dark to see. So each ends where a free flight does, but that it does not collide before an
/// optical depth of 3 (of the channel that is clearest, of those that scatter), and is as much
/// brighter behind that as fewer get there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fading<S> {
    sigma_t: S,
    /// Of the clearest channel; infinite if none scatters.
    clearest: f32,
    /// Where flights begin.
    full: f32,
}

impl<S: Spectrum> Fading<S> {
    pub(crate) fn new(coefficients: Coefficients<S>) -> Self {
        let sigma_t = coefficients.sigma_t();
        let least = |least: f32, c: usize| match coefficients.sigma_s.channel(c) {
            0.0 => least,
            _ => least.min(sigma_t.channel(c)),
        };
        let clearest = (0..S::CHANNELS).fold(f32::INFINITY, least);
        Self {
            sigma_t,
            clearest,
            full: FULL / clearest,
        }
    }

    /// Extinction of the clearest channel that scatters; infinite if none does.
    #[inline]
    pub(crate) fn clearest(&self) -> f32 {
        self.clearest
    }

    /// A length, for `u` in \[0, 1).
    fn length(&self, u: f32) -> f32 {
        self.full - (-u).ln_1p() / self.clearest
    }

    /// What arrives at a distance, over the flux at the start.
    #[inline]
    pub(crate) fn transmittance(&self, v: f32) -> S {
        S::from_channels(|c| (-self.depth(c, v)).exp())
    }

    /// The same as an optical depth, of one channel.
    #[inline]
    pub(crate) fn depth(&self, channel: usize, v: f32) -> f32 {
        let fewer = self.clearest * (v - self.full).max(0.0);
        self.sigma_t.channel(channel) * v - fewer
    }
}

/// The mean free path where light is likely to collide first: behind one of the majorant's.
fn mean_free_path<M: Medium>(medium: &M, ray: &Ray) -> f32 {
    if let Some(coefficients) = medium.homogeneous() {
        return coefficients.sigma_t().mean().recip();
    }
    let (mut depth, mut sigma) = (0.0, 0.0);
    medium.majorants(ray, |stretch| {
        if stretch.sigma_bar > 0.0 && stretch.t_max > stretch.t_min {
            depth += stretch.sigma_bar * (stretch.t_max - stretch.t_min);
            sigma = stretch.sigma_bar;
        }
        if depth < 1.0 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    sigma.recip()
}

/// Where the ray leaves the last of the medium.
fn matter_ends<M: Medium>(medium: &M, ray: &Ray) -> f32 {
    let mut end = 0.0_f32;
    medium.majorants(ray, |stretch| {
        if stretch.sigma_bar > 0.0 {
            end = end.max(stretch.t_max);
        }
        ControlFlow::Continue(())
    });
    end
}
