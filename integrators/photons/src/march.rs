//! Ray marching: the integral of a source of light along a segment of sight.

use crate::ensure;
use std::ops::ControlFlow;
use tyndall_core::{Majorant, Medium, PassError, Ray, Sampler, Spectrum};

/// Transmittance below which a channel plays Russian roulette: it goes on with this one, or ends.
const LITTLE: f32 = 0.1;

/// Steps from which a march may end at any, though it has lost nothing: with loose majorants, or a
/// clear channel in a medium without end, it would take too many. So many times as far, it has gone
/// on with a probability of one over their square.
const PATIENCE: f32 = 1000.0;

/// How a ray is marched: in steps of bounded optical depth, one jittered point in each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct March {
    /// Largest optical depth of a step, of the majorant.
    pub step: f32,
    /// Fewest steps on a segment that holds anything.
    pub min_steps: u32,
}

impl March {
    /// Refuses steps that would not end.
    ///
    /// # Errors
    /// [`PassError::Unsupported`].
    pub fn check(self) -> Result<(), PassError> {
        let Self { step, min_steps } = self;
        ensure(step > 0.0 && step < f32::INFINITY, || {
            format!("`step` is {step}: name an optical depth more than 0, and finite")
        })?;
        ensure(min_steps > 0, || {
            "`min_steps` is 0: take at least 1 step through a medium".to_owned()
        })
    }

    /// An unbiased estimate of ∫ Tr(t) `source`(t) dt over the ray, of the channels that `carried`
    /// has. `source` is asked at distances along the ray, in their order.
    ///
    /// Points are stratified in the optical depth of the majorant, one in each step: none lie where
    /// there is no substance. A channel that has lost nine tenths plays Russian roulette before
    /// each step, so that opaque and infinite segments end. The channels of a homogeneous medium
    /// are known: one that does not scatter is not marched for, and once the denser ones have ended
    /// the steps are those of the others.
    pub fn integrate<M: Medium, T: Sampler>(
        self,
        medium: &M,
        ray: &Ray,
        carried: M::Spectrum,
        sampler: &mut T,
        source: impl FnMut(f32) -> M::Spectrum,
    ) -> M::Spectrum {
        let mut depth = 0.0;
        medium.majorants(ray, |stretch| {
            depth += depth_of(stretch);
            ControlFlow::Continue(())
        });
        let live = |carried: f32, sigma_s: f32| f32::from(carried != 0.0 && sigma_s > 0.0);
        let coefficients = medium.homogeneous();
        let mut walker = Walker {
            march: self,
            medium,
            ray,
            sigma_t: coefficients.map(|c| c.sigma_t()),
            depth,
            transmittance: match coefficients {
                Some(coefficients) => carried.zip(coefficients.sigma_s, live),
                None => carried.map(|carried| live(carried, 1.0)),
            },
            reached: 0.0,
            steps: 0.0,
            next: Next::Step,
            ahead: 0.0,
            steps_per_depth: 0.0,
            sampler,
            source,
            sum: M::Spectrum::default(),
        };
        if depth > 0.0 {
            medium.majorants(ray, |stretch| walker.cross(stretch));
        }
        walker.sum
    }
}

/// Optical depth of the majorant.
fn depth_of(stretch: Majorant) -> f64 {
    if stretch.sigma_bar > 0.0 {
        f64::from(stretch.sigma_bar) * (f64::from(stretch.t_max) - f64::from(stretch.t_min))
    } else {
        0.0
    }
}

/// What comes next on the way, `ahead` steps from here.
#[derive(Clone, Copy)]
enum Next {
    /// The start of a step.
    Step,
    /// Its point; the step ends so many steps behind it.
    Point { behind: f64 },
}

/// A march in progress.
struct Walker<'a, M: Medium, T, F> {
    march: March,
    medium: &'a M,
    ray: &'a Ray,
    /// Of a homogeneous medium.
    sigma_t: Option<M::Spectrum>,
    /// Of the whole ray, by the majorant.
    depth: f64,
    /// To the last point; 0 in channels that have ended.
    transmittance: M::Spectrum,
    /// Distance of the last point.
    reached: f64,
    /// Begun so far.
    steps: f32,
    next: Next,
    ahead: f64,
    steps_per_depth: f64,
    sampler: &'a mut T,
    source: F,
    sum: M::Spectrum,
}

impl<M: Medium, T: Sampler, F: FnMut(f32) -> M::Spectrum> Walker<'_, M, T, F> {
    /// Goes through a stretch, taking its points.
    fn cross(&mut self, stretch: Majorant) -> ControlFlow<()> {
        if depth_of(stretch) <= 0.0 {
            return ControlFlow::Continue(());
        }
        let (mut t, end) = (f64::from(stretch.t_min), f64::from(stretch.t_max));
        loop {
            if let Next::Step = self.next
                && self.ahead == 0.0
            {
                self.begin_step()?;
            }
            let steps_per_unit = f64::from(stretch.sigma_bar) * self.steps_per_depth;
            let to_end = (end - t) * steps_per_unit;
            if self.ahead >= to_end {
                self.ahead -= to_end;
                return ControlFlow::Continue(());
            }
            t += self.ahead / steps_per_unit;
            self.ahead = match self.next {
                Next::Step => 0.0,
                Next::Point { behind } => {
                    self.take(t, 1.0 / steps_per_unit)?;
                    self.next = Next::Step;
                    behind
                }
            };
        }
    }

    /// Plays Russian roulette, and chooses the length of the step and the point in it.
    fn begin_step(&mut self) -> ControlFlow<()> {
        self.steps += 1.0;
        if self.steps > PATIENCE {
            let survival = 1.0 - 2.0 / self.steps;
            if self.sampler.next_1d() >= survival {
                return ControlFlow::Break(());
            }
            self.transmittance = self.transmittance / survival;
        }
        let chance = LITTLE * self.sampler.next_1d();
        self.transmittance = self.transmittance.map(|t| match t {
            t if t >= LITTLE => t,
            t if t > chance => LITTLE,
            _ => 0.0,
        });
        if self.transmittance.is_black() {
            return ControlFlow::Break(());
        }
        self.steps_per_depth = self.steps_per_depth();
        let point = f64::from(self.sampler.next_1d());
        self.ahead = point;
        self.next = Next::Point {
            behind: 1.0 - point,
        };
        ControlFlow::Continue(())
    }

    /// Steps in a unit of optical depth of the majorant: a whole number on the ray.
    fn steps_per_depth(&self) -> f64 {
        let share = self.sigma_t.map_or(1.0, |sigma_t| {
            let live = sigma_t.zip(self.transmittance, |s, t| if t > 0.0 { s } else { 0.0 });
            f64::from(live.max_channel()) / f64::from(sigma_t.max_channel())
        });
        let per_depth = share / f64::from(self.march.step);
        let steps = (self.depth * per_depth).ceil();
        if steps.is_finite() {
            steps.max(f64::from(self.march.min_steps)) / self.depth
        } else {
            per_depth
        }
    }

    /// Adds the point at `t`, which stands for `length` of the ray.
    fn take(&mut self, t: f64, length: f64) -> ControlFlow<()> {
        let between = Ray {
            origin: self.ray.at(self.reached as f32),
            direction: self.ray.direction,
            t_max: (t - self.reached) as f32,
        };
        self.transmittance *= self.medium.transmittance(&between, self.sampler);
        self.reached = t;
        if self.transmittance.is_black() {
            return ControlFlow::Break(());
        }
        let source = (self.source)(t as f32);
        self.sum += self.transmittance * source * length as f32;
        ControlFlow::Continue(())
    }
}
