//! A medium that is the same everywhere.

use crate::channels::{channel_pmf, check_coefficients, choose_channel, exponential, weight};
use crate::{MediumError, Phase};
use glam::Vec3;
use std::ops::ControlFlow;
use tyndall_core::{Coefficients, Collision, FreeFlight, Majorant, Medium, Ray, Sampler, Spectrum};

/// A homogeneous medium: closed forms, two random numbers a free flight, none a transmittance.
#[derive(Clone, Debug)]
pub struct Homogeneous<S> {
    coefficients: Coefficients<S>,
    phase: Phase,
}

impl<S: Spectrum> Homogeneous<S> {
    /// A medium of these coefficients, 1/scene unit, per channel.
    ///
    /// A channel that emits where its extinction is 0 is allowed (a thin flame). The radiance it
    /// gathers along a ray *without end* is infinite and is reported as infinite; bound such a
    /// medium by a surface, or give it some absorption.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Coefficients, Medium, Ray, Sampler};
    /// use tyndall_media::{Homogeneous, Phase};
    /// struct Half;
    /// impl Sampler for Half {
    ///     fn next_1d(&mut self) -> f32 {
    ///         0.5
    ///     }
    /// }
    /// let fog = Coefficients { sigma_a: 0.5_f32, sigma_s: 1.5, emission: 0.0 };
    /// let fog = Homogeneous::new(fog, Phase::Isotropic)?;
    /// let ray = Ray::new(Vec3::ZERO, Vec3::X);
    /// assert!((fog.transmittance(&ray.up_to(0.5), &mut Half) - (-1.0_f32).exp()).abs() < 1e-7);
    /// let flight = fog.sample_free_flight(&ray, 1.0, &mut Half);
    /// assert!((flight.collision.unwrap().t - 2.0_f32.ln() / 2.0).abs() < 1e-7);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    ///
    /// # Errors
    /// [`MediumError::Coefficient`] if one is negative or not finite.
    pub fn new(coefficients: Coefficients<S>, phase: Phase) -> Result<Self, MediumError> {
        check_coefficients(&coefficients)?;
        Ok(Self {
            coefficients,
            phase,
        })
    }

    /// Whether it emits.
    pub(crate) fn emits(&self) -> bool {
        !self.coefficients.emission.is_black()
    }

    /// Transmittance of the ray.
    #[inline]
    pub(crate) fn mean_transmittance(&self, ray: &Ray) -> S {
        self.optical_depth(ray.t_max).map(|tau| (-tau).exp())
    }

    /// σt·`distance`, with 0·∞ = 0.
    #[inline]
    fn optical_depth(&self, distance: f32) -> S {
        self.coefficients.sigma_t().map(|sigma_t| {
            if sigma_t == 0.0 {
                0.0
            } else {
                sigma_t * distance
            }
        })
    }
}

impl<S: Spectrum> Medium for Homogeneous<S> {
    type Spectrum = S;
    type Phase<'a> = &'a Phase;

    #[inline]
    fn coefficients(&self, _: Vec3) -> Coefficients<S> {
        self.coefficients
    }

    #[inline]
    fn phase(&self, _: Vec3) -> &Phase {
        &self.phase
    }

    #[inline]
    fn transmittance(&self, ray: &Ray, _: &mut impl Sampler) -> S {
        self.mean_transmittance(ray)
    }

    /// emission·(1 − e^{−σt·s})/σt over the length s of the ray.
    #[inline]
    fn emitted(&self, ray: &Ray, _: &mut impl Sampler) -> S {
        let sigma_t = self.coefficients.sigma_t();
        let tau = self.optical_depth(ray.t_max);
        S::from_channels(|c| match self.coefficients.emission.channel(c) {
            0.0 => 0.0,
            emission if tau.channel(c) == 0.0 => emission * ray.t_max,
            emission => emission * (-(-tau.channel(c)).exp_m1() / sigma_t.channel(c)),
        })
    }

    /// A channel is chosen with probability ∝ importance, t = −ln(1 − u)/σt of that channel; the
    /// weight is that of the mixture (single-sample MIS with the balance heuristic).
    #[inline]
    fn sample_free_flight(
        &self,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<S> {
        let pmf = channel_pmf(importance);
        let channel = if S::CHANNELS > 1 {
            choose_channel(pmf, sampler.next_1d())
        } else {
            0
        };
        let sigma_t = self.coefficients.sigma_t();
        let t = exponential(sampler) / sigma_t.channel(channel);
        // An extinction of 0 always passes (t is ∞, or NaN from 0/0), a tiny one may overflow.
        let collides = sigma_t.channel(channel) > 0.0 && t.min(f32::MAX) < ray.t_max;
        let (weight, collision) = if collides {
            let t = t.min(f32::MAX);
            let coefficients = self.coefficients;
            let weight = weight(sigma_t, self.optical_depth(t), pmf);
            (weight, Some(Collision { t, coefficients }))
        } else {
            let tau = self.optical_depth(ray.t_max);
            (weight(S::splat(1.0), tau, pmf), None)
        };
        FreeFlight { weight, collision }
    }

    #[inline]
    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: S) -> f32 {
        if !(0.0..ray.t_max).contains(&t) {
            return 0.0;
        }
        let transmittance = self.mean_transmittance(&ray.up_to(t));
        (channel_pmf(importance) * self.coefficients.sigma_t() * transmittance).sum()
    }

    #[inline]
    fn pmf_passing(&self, ray: &Ray, importance: S) -> f32 {
        (channel_pmf(importance) * self.mean_transmittance(ray)).sum()
    }

    fn majorants(&self, ray: &Ray, mut visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        let sigma_bar = self.coefficients.sigma_t().max_channel();
        if sigma_bar > 0.0 {
            // The only stretch: whether to go on after it does not matter.
            let _ = visit(Majorant {
                t_min: 0.0,
                t_max: ray.t_max,
                sigma_bar,
            });
        }
    }

    #[inline]
    fn homogeneous(&self) -> Option<Coefficients<S>> {
        Some(self.coefficients)
    }
}
