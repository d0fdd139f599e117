//! What a ray gathers of the beams that it passes.

use crate::beam::Fading;
use crate::estimators::{
    BeamBeam1D, BeamBeam2DBeam, BeamBeam2DRay, BeamBeam3D, BeamPoint2D, BeamPoint3D, Cone,
    Estimator, Meeting, Pair,
};
use crate::pass::LightBeams;
use crate::{Estimate, Extent};
use glam::Vec3;
use tyndall_bvh::Piece;
use tyndall_core::{Coefficients, Medium, PhaseFunction, Ray, Sampler, Spectrum};
use tyndall_density::{Kernel, Lines, exp_negative};
use tyndall_photons::{March, Transmittance};
use tyndall_walk::{DepthTable, Flights};

/// Sines of the angle between a ray and a beam: from the second on it is met in one dimension, up
/// to the first in two, and in between in both, by shares that sum to one.
const HANDOVER: [f64; 2] = [0.03, 0.1];

/// Beams that many a ray meets: room for them is made at once.
const MET: usize = 256;

/// How beams are gathered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules {
    pub(crate) estimate: Estimate,
    pub(crate) kernel: Kernel,
    /// How far beams of light and of sight go.
    pub(crate) light: Extent,
    pub(crate) sight: Extent,
    pub(crate) transmittance: Transmittance,
    pub(crate) march: March,
}

impl Rules {
    /// How fast beams of sight and of light fade where they are long and the medium is the same
    /// everywhere: by the extinction of the clearest channel that scatters.
    fn fading<S: Spectrum>(&self, even: Option<Coefficients<S>>) -> [f64; 2] {
        let clearest = even.map_or(0.0, |coefficients| Fading::new(coefficients).clearest());
        [self.sight, self.light].map(|extent| match extent {
            Extent::Long if clearest.is_finite() => clearest.into(),
            _ => 0.0,
        })
    }
}

/// Gathers beams. Room for what rays meet is reused from one to the next.
#[derive(Debug)]
pub(crate) struct BeamGather<S> {
    rules: Rules,
    met: Vec<Met>,
    /// Transmittance to what is met, of one channel.
    row: Vec<f32>,
    table: DepthTable<S>,
    flights: Flights<S>,
    /// Largest error of transmittance met.
    pub(crate) error: f32,
}

/// A beam that a ray meets.
#[derive(Clone, Copy, Debug)]
struct Met {
    beam: u32,
    t: f32,
    v: f32,
    weight: f32,
}

impl<S: Spectrum> BeamGather<S> {
    /// Room for nothing yet.
    pub(crate) fn new(rules: Rules) -> Self {
        Self {
            rules,
            met: Vec::new(),
            row: Vec::new(),
            table: DepthTable::default(),
            flights: Flights::default(),
            error: 0.0,
        }
    }

    /// Radiance that the medium scatters towards the origin of the ray, of all beams.
    pub(crate) fn along<M: Medium<Spectrum = S>>(
        &mut self,
        beams: &LightBeams<S>,
        medium: &M,
        ray: &Ray,
        carried: S,
        sampler: &mut impl Sampler,
    ) -> S {
        match self.rules.estimate {
            Estimate::BeamPoint2D => {
                self.march::<BeamPoint2D, M>(beams, medium, ray, carried, sampler)
            }
            Estimate::BeamPoint3D => {
                self.march::<BeamPoint3D, M>(beams, medium, ray, carried, sampler)
            }
            Estimate::BeamBeam2DRay => {
                self.cross::<BeamBeam2DRay, M>(beams, medium, ray, carried, sampler)
            }
            Estimate::BeamBeam2DBeam => {
                self.cross::<BeamBeam2DBeam, M>(beams, medium, ray, carried, sampler)
            }
            Estimate::BeamBeam3D => {
                self.cross::<BeamBeam3D, M>(beams, medium, ray, carried, sampler)
            }
            _ => self.cross::<BeamBeam1D, M>(beams, medium, ray, carried, sampler),
        }
    }

    /// Of estimators whose query is the whole ray.
    fn cross<E: Estimator, M: Medium<Spectrum = S>>(
        &mut self,
        beams: &LightBeams<S>,
        medium: &M,
        ray: &Ray,
        carried: S,
        sampler: &mut impl Sampler,
    ) -> S {
        let Self { rules, met, .. } = self;
        let sigma_t = rules.fading(medium.homogeneous());
        met.clear();
        met.reserve(MET);
        beams.tree.near(ray, |piece| {
            let shape = beams.tree.beam(piece.beam);
            let lines = Lines::new(ray, shape.origin, shape.direction);
            let pair = pair(&lines, ray, beams, piece, rules.kernel, sigma_t);
            let mut meet = |meeting: Option<Meeting>, share: f64| {
                met.extend(meeting.map(|Meeting { t, v, weight }| Met {
                    beam: piece.beam as u32,
                    t: t as f32,
                    v: v as f32,
                    weight: (weight * share) as f32,
                }));
            };
            if E::BLUR > 1 {
                return meet(E::meet(&pair, sampler.next()), 1.0);
            }
            let share = handed_over(lines.sin_theta());
            if share < 1.0 {
                meet(E::meet(&pair, [0.0; 2]), 1.0 - share);
            }
            if share > 0.0 {
                meet(BeamBeam2DRay::meet(&pair, sampler.next()), share);
            }
        });
        if let (Some(coefficients), Extent::Long) = (medium.homogeneous(), rules.sight) {
            return self.sum_even(beams, medium, coefficients, ray);
        }
        let Some(farthest) = met.iter().map(|met| met.t).reduce(f32::max) else {
            return S::default();
        };
        self.sum(
            beams,
            medium,
            &ray.up_to(farthest.min(ray.t_max)),
            carried,
            sampler,
        )
    }

    /// Σ σs p Φ Tr_e Tr_b · weight over what was met along the ray.
    fn sum<M: Medium<Spectrum = S>>(
        &mut self,
        beams: &LightBeams<S>,
        medium: &M,
        ray: &Ray,
        carried: S,
        sampler: &mut impl Sampler,
    ) -> S {
        let Self {
            rules,
            met,
            table,
            flights,
            error,
            ..
        } = self;
        let even = medium.homogeneous();
        let sight = Sight::new(rules, medium, ray, carried, sampler, table, flights, error);
        let wo = -ray.direction;
        let scattered = |met: &Met| {
            let place = ray.at(met.t);
            let arriving = arriving(rules, even, beams, met);
            let scattered = scatter(
                medium,
                even,
                place,
                wo,
                beams.tree.beam(met.beam as usize).direction,
            );
            scattered * arriving * sight.transmittance(met.t) * met.weight
        };
        met.iter().map(scattered).sum()
    }

    /// The same where the medium is the same everywhere: both transmittances are one exponential,
    /// and all of a channel are taken at once.
    fn sum_even<M: Medium<Spectrum = S>>(
        &mut self,
        beams: &LightBeams<S>,
        medium: &M,
        coefficients: Coefficients<S>,
        ray: &Ray,
    ) -> S {
        let Self {
            rules, met, row, ..
        } = self;
        let (wo, phase) = (-ray.direction, medium.phase(ray.origin));
        let mut scale = coefficients.sigma_s;
        if phase.is_isotropic() {
            scale *= phase.eval(wo, wo);
        } else {
            for met in met.iter_mut() {
                let direction = beams.tree.beam(met.beam as usize).direction;
                met.weight *= phase.eval(wo, -direction);
            }
        }
        let fading = (rules.light == Extent::Long).then(|| Fading::new(coefficients));
        let sigma_t = coefficients.sigma_t();
        let weigh = |c: usize, row: &mut Vec<f32>| {
            let sigma_t = sigma_t.channel(c);
            row.clear();
            row.extend(met.iter().map(|met| {
                let of_light = fading.map_or(0.0, |fading| fading.depth(c, met.v));
                // Less than 0 only where a channel scatters nothing.
                depth(sigma_t, met.t) + of_light.max(0.0)
            }));
            exp_negative(row);
        };
        let flux = |met: &Met| beams.flux(met.beam as usize, met.v) * met.weight;
        if (1..S::CHANNELS).all(|c| sigma_t.channel(c) == sigma_t.channel(0)) {
            weigh(0, row);
            let arriving = met.iter().zip(row).map(|(met, tr)| flux(met) * *tr);
            return scale * arriving.sum::<S>();
        }
        let of_channel = |c: usize| {
            weigh(c, row);
            let arriving = met.iter().zip(row.iter());
            arriving.map(|(met, tr)| flux(met).channel(c) * tr).sum()
        };
        scale * S::from_channels(of_channel)
    }

    /// Of estimators whose query is a point.
    fn march<E: Estimator, M: Medium<Spectrum = S>>(
        &mut self,
        beams: &LightBeams<S>,
        medium: &M,
        ray: &Ray,
        carried: S,
        sampler: &mut impl Sampler,
    ) -> S {
        let rules = self.rules;
        let even = medium.homogeneous();
        let sigma_t = rules.fading(even);
        let u: [f32; 2] = sampler.next();
        let mut turn = 0.0_f32;
        rules.march.integrate(medium, ray, carried, sampler, |t| {
            let here = Ray::new(ray.at(t), ray.direction).up_to(0.0);
            let mut sum = S::default();
            beams.tree.around(here.origin, |piece| {
                let shape = beams.tree.beam(piece.beam);
                let lines = Lines::new(&here, shape.origin, shape.direction);
                let pair = pair(&lines, &here, beams, piece, rules.kernel, sigma_t);
                // Each place is uniform; one random number spreads over all.
                turn = (turn + 0.618_034).fract();
                let u = u.map(|u| (u + turn).fract());
                if let Some(Meeting { v, weight, .. }) = E::meet(&pair, u) {
                    let met = Met {
                        beam: piece.beam as u32,
                        t: 0.0,
                        v: v as f32,
                        weight: weight as f32,
                    };
                    let arriving = arriving(&rules, even, beams, &met);
                    let wo = -ray.direction;
                    let scattered = scatter(medium, even, here.origin, wo, shape.direction);
                    sum += scattered * arriving * met.weight;
                }
            });
            sum
        })
    }
}

/// What two-dimensional blur takes of a beam at an angle of this sine.
fn handed_over(sin_theta: f64) -> f64 {
    let [low, high] = HANDOVER;
    if sin_theta >= high {
        return 0.0;
    }
    let x = ((high - sin_theta) / (high - low)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

fn pair<'a, S>(
    lines: &'a Lines,
    ray: &Ray,
    beams: &LightBeams<S>,
    piece: Piece,
    kernel: Kernel,
    sigma_t: [f64; 2],
) -> Pair<'a> {
    let shape = beams.tree.beam(piece.beam);
    let [start, end] = shape.radii.map(f64::from);
    Pair {
        lines,
        t_max: f64::from(ray.t_max),
        piece: [piece.start, piece.end].map(f64::from),
        cone: Cone {
            start,
            growth: (end - start) / f64::from(shape.length),
            limits: shape.limits.map(f64::from),
        },
        kernel,
        sigma_t,
    }
}

/// Flux that arrives where a beam is met.
fn arriving<S: Spectrum>(
    rules: &Rules,
    even: Option<Coefficients<S>>,
    beams: &LightBeams<S>,
    met: &Met,
) -> S {
    let flux = beams.flux(met.beam as usize, met.v);
    match even {
        Some(coefficients) if rules.light == Extent::Long => {
            flux * Fading::new(coefficients).transmittance(met.v)
        }
        _ => flux,
    }
}

/// σd, 0 where nothing is met however far.
fn depth(sigma: f32, distance: f32) -> f32 {
    if sigma == 0.0 { 0.0 } else { sigma * distance }
}

/// σs p at a place, for light that travels in `direction`.
fn scatter<M: Medium>(
    medium: &M,
    even: Option<Coefficients<M::Spectrum>>,
    place: Vec3,
    wo: Vec3,
    direction: Vec3,
) -> M::Spectrum {
    let coefficients = even.unwrap_or_else(|| medium.coefficients(place));
    coefficients.sigma_s * medium.phase(place).eval(wo, -direction)
}

/// Transmittance of a ray of sight.
enum Sight<'a, S> {
    Table(&'a DepthTable<S>),
    Flights(&'a Flights<S>),
}

impl<'a, S: Spectrum> Sight<'a, S> {
    #[allow(clippy::too_many_arguments)]
    fn new<M: Medium<Spectrum = S>>(
        rules: &Rules,
        medium: &M,
        ray: &Ray,
        carried: S,
        sampler: &mut impl Sampler,
        table: &'a mut DepthTable<S>,
        flights: &'a mut Flights<S>,
        error: &mut f32,
    ) -> Self {
        let count = match (rules.sight, rules.transmittance) {
            (Extent::Short, ..) => 1,
            (Extent::Long, Transmittance::Table { max_error }) => {
                *error = error.max(table.measure(medium, ray, max_error));
                return Self::Table(table);
            }
            (Extent::Long, Transmittance::Tracking { flights }) => flights,
        };
        flights.fly(medium, ray, count, carried, sampler);
        Self::Flights(flights)
    }

    fn transmittance(&self, t: f32) -> S {
        match self {
            Self::Table(table) => table.depth(t).map(|depth| (-depth).exp()),
            Self::Flights(flights) => flights.transmittance(t),
        }
    }
}
