//! Delta and ratio tracking along majorants.

use crate::GridMedium;
use crate::channels::{channel_pmf, exponential};
use crate::field::{Field, Hint};
use crate::majorant::Cell;
use glam::Vec3;
use std::ops::ControlFlow::{self, Break, Continue};
use tyndall_core::{Collision, FreeFlight, Ray, Sampler, Spectrum};

/// Below this, a ratio-tracked transmittance plays Russian roulette.
const THIN: f32 = 0.05;
/// With this probability of going on.
const SURVIVAL: f32 = 0.25;

/// A place where light may have met something.
struct Tentative<'a> {
    t: f32,
    /// Of the collisions tried.
    rate: f32,
    cell: &'a Cell,
    /// ∫ of the smallest density of the cells dt, up to here.
    floor: f64,
}

/// Visits the points of a Poisson process of this rate. `left` is the distance to the next times
/// the rate, before and after; 0 if it is yet to be drawn.
///
/// Out of line, for most stretches have none, and are passed by whoever looks at `left` first.
#[inline(never)]
fn poisson<R: Sampler>(
    left: &mut f64,
    [enter, leave]: [f64; 2],
    rate: f32,
    sampler: &mut R,
    mut visit: impl FnMut(&mut R, f64) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let rate = f64::from(rate);
    let mut t = enter;
    loop {
        if *left > 0.0 {
            t += *left / rate;
            visit(sampler, t)?;
        }
        *left = f64::from(exponential(sampler));
        let depth = rate * (leave - t);
        if depth < *left {
            *left -= depth;
            return Continue(());
        }
    }
}

impl<S: Spectrum, D: Field<f32>> GridMedium<S, D> {
    /// Visits tentative collisions, a Poisson process of the rate that `rate` has for each cell; with
    /// `glow`, cells are fine where emission is uneven.
    /// Returns ∫ of the smallest density of each cell dt over the ray.
    ///
    /// Distances grow in `f64`: at a rate of 1e6 steps are below the spacing of `f32`.
    #[inline]
    fn tentative_collisions<R: Sampler>(
        &self,
        ray: &Ray,
        sampler: &mut R,
        (rate, glow): (impl Fn(&Cell) -> f32, bool),
        mut visit: impl FnMut(&mut R, Tentative<'_>) -> ControlFlow<()>,
    ) -> f64 {
        let (mut left, mut floor) = (0.0, 0.0);
        let _ = self.walk(ray, glow, |enter, leave, cell| {
            let rate = rate(cell);
            let least = f64::from(cell.density.min);
            let depth = f64::from(rate) * (leave - enter);
            if depth < left {
                left -= depth;
            } else {
                poisson(&mut left, [enter, leave], rate, sampler, |sampler, t| {
                    let tentative = Tentative {
                        t: t as f32,
                        rate,
                        cell,
                        floor: floor + least * (t - enter),
                    };
                    visit(sampler, tentative)
                })?;
            }
            floor += least * (leave - enter);
            Continue(())
        });
        floor
    }

    /// Residual ratio tracking (Novák et al. 2014, eq. 20): what the smallest density of each cell
    /// lets through is exact, and what is above it a product of 1 − (σt − σmin)/rate over tentative
    /// collisions, with Russian roulette once all channels are thin.
    pub(crate) fn ratio_track(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        let sigma_t = self.sigma_t();
        let most = sigma_t.max_channel();
        let rate = |cell: &Cell| most * (cell.density.max - cell.density.min);
        self.track_residual(ray, sampler, (rate, false), |_, _, _, _| {})
    }

    /// `visit` gets each tentative collision's point, density and rate, and the transmittance
    /// before it.
    #[inline]
    fn track_residual(
        &self,
        ray: &Ray,
        sampler: &mut impl Sampler,
        rate: (impl Fn(&Cell) -> f32, bool),
        mut visit: impl FnMut(Vec3, f32, f32, &dyn Fn() -> S),
    ) -> S {
        let sigma_t = self.sigma_t();
        let through = |floor: f64| match floor {
            0.0 => S::splat(1.0),
            _ => sigma_t.map(|s| (-s * floor as f32).exp()),
        };
        let mut hint = Hint::default();
        let mut residual = S::splat(1.0);
        let floor = self.tentative_collisions(ray, sampler, rate, |sampler, tentative| {
            let Tentative {
                t,
                rate,
                cell,
                floor,
            } = tentative;
            let p = ray.at(t);
            let density = self.density_at(p, &mut hint);
            visit(p, density, rate, &|| residual * through(floor));
            let above = density - cell.density.min;
            residual *= sigma_t.map(|sigma_t| (1.0 - sigma_t * above / rate).max(0.0));
            if residual.max_channel() >= THIN {
                return Continue(());
            }
            if !residual.is_black() && sampler.next_1d() < SURVIVAL {
                residual = residual / SURVIVAL;
                return Continue(());
            }
            residual = S::default();
            Break(())
        });
        residual * through(floor)
    }

    /// Σ emission/rate times the transmittance so far over the tentative collisions of ratio
    /// tracking: the mean of what is before them is Tr(t), hence the mean is ∫ Tr·emission dt.
    pub(crate) fn emission_track(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        let most = self.sigma_t().max_channel();
        let rate = |cell: &Cell| (most * (cell.density.max - cell.density.min)).max(cell.rate);
        let mut emitted = S::default();
        self.track_residual(
            ray,
            sampler,
            (rate, true),
            |p, density, rate, transmittance| {
                emitted += transmittance() * self.emission(p, density) / rate;
            },
        );
        emitted
    }

    /// Delta tracking with weights per channel: a tentative collision is real with probability
    /// Σ β σt / (σ̄ Σ β), where β is importance times the weight so far (the history-aware averages
    /// of Kutz et al. 2017, "Spectral and decomposition tracking", §5). Both outcomes keep Σ β, so
    /// the density of collisions is Σ pmf·σt·Tr and weights are bounded.
    pub(crate) fn delta_track(
        &self,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<S> {
        let pmf = channel_pmf(importance);
        let mut flight = FreeFlight {
            weight: pmf.map(|p| if p > 0.0 { 1.0 } else { 0.0 }),
            collision: None,
        };
        let sigma_t = self.sigma_t();
        let most = sigma_t.max_channel();
        let mut hint = Hint::default();
        let rate = |cell: &Cell| most * cell.density.max;
        self.tentative_collisions(
            ray,
            sampler,
            (rate, false),
            |sampler, Tentative { t, rate, .. }| {
                let p = ray.at(t);
                let density = self.density_at(p, &mut hint);
                let beta = pmf * flight.weight;
                let ratio = sigma_t.map(|sigma_t| (sigma_t * density / rate).min(1.0));
                let remainder = ratio.map(|r| 1.0 - r);
                let (real, null) = ((beta * ratio).sum(), (beta * remainder).sum());
                // Written so that neither outcome of probability 0 is ever chosen.
                if null <= 0.0 || sampler.next_1d() * (real + null) < real {
                    flight.weight *= ratio * ((real + null) / real);
                    let coefficients = self.coefficients_at(p, density);
                    flight.collision = Some(Collision { t, coefficients });
                    return Break(());
                }
                flight.weight *= remainder * ((real + null) / null);
                Continue(())
            },
        );
        flight
    }
}
