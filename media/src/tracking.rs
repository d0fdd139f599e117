//! Delta and ratio tracking along majorants.

use crate::GridMedium;
use crate::channels::{channel_pmf, exponential};
use glam::Vec3;
use std::ops::ControlFlow::{self, Break, Continue};
use tyndall_core::{Collision, FreeFlight, Medium, Ray, Sampler, Spectrum};

/// Below this, a ratio-tracked transmittance plays Russian roulette.
const THIN: f32 = 0.05;
/// With this probability of going on.
const SURVIVAL: f32 = 0.25;

impl<S: Spectrum> GridMedium<S> {
    /// Visits tentative collisions, a Poisson process of rate σ̄, with distance and σ̄.
    ///
    /// Distances grow in `f64`: at σ̄ = 1e6 steps are below the spacing of `f32`.
    #[inline]
    fn tentative_collisions<R: Sampler>(
        &self,
        ray: &Ray,
        sampler: &mut R,
        mut visit: impl FnMut(&mut R, f32, f32) -> ControlFlow<()>,
    ) {
        let mut depth = None;
        let _ = self.majorant_grid().walk(ray, |enter, leave, cell| {
            let rate = f64::from(cell.sigma_bar);
            let mut t = enter;
            loop {
                let left = *depth.get_or_insert_with(|| f64::from(exponential(sampler)));
                let next = t + left / rate;
                if next >= leave {
                    depth = Some((left - rate * (leave - t)).max(0.0));
                    return Continue(());
                }
                t = next;
                depth = None;
                visit(sampler, t as f32, cell.sigma_bar)?;
            }
        });
    }

    /// The product of 1 − σt/σ̄ over the tentative collisions (ratio tracking: Novák et al. 2014,
    /// eq. 12), with Russian roulette once all channels are thin. `visit` gets each collision's
    /// point and σ̄, and the product before it.
    pub(crate) fn ratio_track(
        &self,
        ray: &Ray,
        sampler: &mut impl Sampler,
        mut visit: impl FnMut(Vec3, f32, S),
    ) -> S {
        let mut transmittance = S::splat(1.0);
        self.tentative_collisions(ray, sampler, |sampler, t, sigma_bar| {
            let p = ray.at(t);
            visit(p, sigma_bar, transmittance);
            transmittance *= self
                .extinction(p)
                .map(|sigma_t| (1.0 - sigma_t / sigma_bar).max(0.0));
            if transmittance.max_channel() >= THIN {
                return Continue(());
            }
            if !transmittance.is_black() && sampler.next_1d() < SURVIVAL {
                transmittance = transmittance / SURVIVAL;
                return Continue(());
            }
            transmittance = S::default();
            Break(())
        });
        transmittance
    }

    /// Σ emission/σ̄ times the transmittance so far over the tentative collisions of ratio
    /// tracking: they come at rate σ̄ and the product before them has mean Tr(t), hence the mean
    /// is ∫ Tr·emission dt. It needs a majorant, not an extinction, where the medium emits.
    pub(crate) fn emission_track(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        let mut emitted = S::default();
        self.ratio_track(ray, sampler, |p, sigma_bar, transmittance| {
            emitted += transmittance * self.emission(p) / sigma_bar;
        });
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
        self.tentative_collisions(ray, sampler, |sampler, t, sigma_bar| {
            let p = ray.at(t);
            let beta = pmf * flight.weight;
            let ratio = self
                .extinction(p)
                .map(|sigma_t| (sigma_t / sigma_bar).min(1.0));
            let remainder = ratio.map(|r| 1.0 - r);
            let (real, null) = ((beta * ratio).sum(), (beta * remainder).sum());
            // Written so that neither outcome of probability 0 is ever chosen.
            if null <= 0.0 || sampler.next_1d() * (real + null) < real {
                flight.weight *= ratio * ((real + null) / real);
                let coefficients = self.coefficients(p);
                flight.collision = Some(Collision { t, coefficients });
                return Break(());
            }
            flight.weight *= remainder * ((real + null) / null);
            Continue(())
        });
        flight
    }
}
