//! A medium that thins out with height.

mod column;

use crate::channels::{channel_pmf, check_coefficients, choose_channel, exponential, weight};
use crate::{MediumError, Phase};
use column::Column;
use glam::{DVec3, Vec3};
use std::f64::consts::LN_2;
use std::ops::ControlFlow;
use tyndall_core::{Coefficients, Collision, FreeFlight, Majorant, Medium, Ray, Sampler, Spectrum};

/// The logarithm of what is zero in `f32`.
const EMPTY: f64 = -104.0;
/// What coefficients are capped at where the density grows on and on.
const LARGEST: f64 = 1e30;

/// An exponential atmosphere over a plane: coefficients that fall with height as e^{−h/H}.
///
/// h = (p − `origin`)·`up`, and H is the scale height, over which the density falls to 1/e. All
/// channels have this profile, so that in the coordinate ∫ density dt along a ray it is a
/// homogeneous medium: with s = `direction`·`up`/H and the density ρ₀ at the origin of the ray, that
/// is ρ₀·(1 − e^{−s·t})/s, and free flight, transmittance, emission and both probabilities are
/// closed forms; two random numbers a free flight, one if grey, none a transmittance.
///
/// # Extremes
/// Logarithms of densities in `f64` carry heights of any number of H, up to the rounding of the
/// `f32` positions: a height of 1e6 is known to 0.06. A ray that leads down ends in a collision, and
/// so does a horizontal one without end, at any height. Coefficients at a point are capped, in
/// proportion, where the largest reaches 1e30; the closed forms are not.
#[derive(Clone, Debug)]
pub struct Atmosphere<S> {
    origin: DVec3,
    /// Unit vector over the scale height.
    gradient: DVec3,
    coefficients: Coefficients<S>,
    phase: Phase,
    /// The logarithm of the density from which on coefficients are capped.
    cap: f64,
}

impl<S: Spectrum> Atmosphere<S> {
    /// An atmosphere of `coefficients` (1/scene unit) at the height of `origin`, which fall to 1/e
    /// every `scale_height` (scene units) along `up`, of any length.
    ///
    /// A channel that emits where its extinction is 0 is allowed; its radiance is infinite along
    /// rays without end that do not lead up, and is reported as infinite.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Coefficients, Medium, Ray, Sampler};
    /// use tyndall_media::{Atmosphere, Phase};
    /// # struct Never;
    /// # impl Sampler for Never {
    /// #     fn next_1d(&mut self) -> f32 {
    /// #         unreachable!()
    /// #     }
    /// # }
    /// let haze = Coefficients { sigma_a: 0.0_f32, sigma_s: 0.5, emission: 0.0 };
    /// let haze = Atmosphere::new(Vec3::ZERO, Vec3::Y, 2.0, haze, Phase::Isotropic)?;
    /// let zenith = Ray::new(Vec3::ZERO, Vec3::Y); // optical depth σt·H = 1
    /// assert!((haze.transmittance(&zenith, &mut Never) - (-1.0_f32).exp()).abs() < 1e-7);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    ///
    /// # Errors
    /// [`MediumError::Coefficient`] if one is negative or not finite; [`MediumError::ScaleHeight`]
    /// if it is not positive and finite; [`MediumError::Placement`] if `origin` is not finite, or
    /// `up` no direction.
    pub fn new(
        origin: Vec3,
        up: Vec3,
        scale_height: f32,
        coefficients: Coefficients<S>,
        phase: Phase,
    ) -> Result<Self, MediumError> {
        check_coefficients(&coefficients)?;
        if !(scale_height.is_finite() && scale_height > 0.0) {
            return Err(MediumError::ScaleHeight { scale_height });
        }
        let length = up.as_dvec3().length();
        let directed = up.is_finite() && length > 0.0;
        for (field, value, right) in [("origin", origin, origin.is_finite()), ("up", up, directed)]
        {
            if !right {
                return Err(MediumError::Placement { field, value });
            }
        }
        let sigma_t = coefficients.sigma_t().max_channel();
        let largest = sigma_t
            .max(coefficients.emission.max_channel())
            .max(f32::MIN_POSITIVE);
        Ok(Self {
            origin: origin.as_dvec3(),
            gradient: up.as_dvec3() / length / f64::from(scale_height),
            coefficients,
            phase,
            cap: (LARGEST / f64::from(largest)).ln().max(0.0),
        })
    }

    /// The density along a ray.
    #[inline]
    fn column(&self, ray: &Ray) -> Column {
        Column {
            start: -(ray.origin.as_dvec3() - self.origin).dot(self.gradient),
            slope: ray.direction.as_dvec3().dot(self.gradient),
        }
    }

    /// The coefficients where the density has this logarithm.
    #[inline]
    fn coefficients_at(&self, log_density: f64) -> Coefficients<S> {
        let Coefficients {
            sigma_a,
            sigma_s,
            emission,
        } = self.coefficients;
        let density = self.capped(log_density);
        let [sigma_a, sigma_s, emission] =
            [sigma_a, sigma_s, emission].map(|at_1| at_1.map(|x| (f64::from(x) * density) as f32));
        Coefficients {
            sigma_a,
            sigma_s,
            emission,
        }
    }

    /// A density that keeps coefficients finite.
    #[inline]
    fn capped(&self, log_density: f64) -> f64 {
        log_density.min(self.cap).exp()
    }

    /// σt·`mass`, with 0·∞ = 0.
    #[inline]
    fn optical_depth(&self, mass: f64) -> S {
        (self.coefficients.sigma_t()).map(|sigma_t| depth(sigma_t, mass) as f32)
    }

    /// Whether it emits.
    pub(crate) fn emits(&self) -> bool {
        !self.coefficients.emission.is_black()
    }

    /// Transmittance of the ray.
    #[inline]
    pub(crate) fn mean_transmittance(&self, ray: &Ray) -> S {
        let mass = self.column(ray).mass(ray.t_max.into());
        self.optical_depth(mass).map(|tau| (-tau).exp())
    }
}

/// With 0·∞ = 0.
#[inline]
fn depth(sigma_t: f32, mass: f64) -> f64 {
    if sigma_t == 0.0 {
        0.0
    } else {
        f64::from(sigma_t) * mass
    }
}

impl<S: Spectrum> Medium for Atmosphere<S> {
    type Spectrum = S;
    type Phase<'a> = &'a Phase;

    #[inline]
    fn coefficients(&self, p: Vec3) -> Coefficients<S> {
        self.coefficients_at(-(p.as_dvec3() - self.origin).dot(self.gradient))
    }

    #[inline]
    fn phase(&self, _: Vec3) -> &Phase {
        &self.phase
    }

    #[inline]
    fn transmittance(&self, ray: &Ray, _: &mut impl Sampler) -> S {
        self.mean_transmittance(ray)
    }

    /// emission·(1 − e^{−τ})/σt, with the coefficients at the origin of the atmosphere.
    fn emitted(&self, ray: &Ray, _: &mut impl Sampler) -> S {
        if !self.emits() {
            return S::default();
        }
        let Coefficients { emission, .. } = self.coefficients;
        let mass = self.column(ray).mass(ray.t_max.into());
        emission.zip(self.coefficients.sigma_t(), |emission, sigma_t| {
            let tau = depth(sigma_t, mass);
            let seen = match emission {
                0.0 => 0.0,
                _ if tau == 0.0 => mass,
                _ => -(-tau).exp_m1() / f64::from(sigma_t),
            };
            (f64::from(emission) * seen) as f32
        })
    }

    /// As in a homogeneous medium: a channel is chosen with probability ∝ importance, and the
    /// distance where −ln(1 − u)/σt of that channel lies before it; the weight is that of the
    /// mixture.
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
        let tau = f64::from(exponential(sampler));
        let chosen = sigma_t.channel(channel);
        let column = self.column(ray);
        let total = column.mass(ray.t_max.into());
        let mass = tau / f64::from(chosen);
        if chosen > 0.0 && mass < total {
            let t = (column.distance(mass) as f32).min(ray.t_max.next_down());
            let coefficients = self.coefficients_at(column.log_density(t.into()));
            // A channel of no extinction has no weight, and must not set the scale of the others'.
            let pmf = pmf.zip(sigma_t, |p, sigma_t| if sigma_t > 0.0 { p } else { 0.0 });
            return FreeFlight {
                weight: weight(sigma_t, self.optical_depth(mass), pmf),
                collision: Some(Collision { t, coefficients }),
            };
        }
        FreeFlight {
            weight: weight(S::splat(1.0), self.optical_depth(total), pmf),
            collision: None,
        }
    }

    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: S) -> f32 {
        if !(0.0..ray.t_max).contains(&t) {
            return 0.0;
        }
        let column = self.column(ray);
        let (density, mass) = (column.log_density(t.into()), column.mass(t.into()));
        let pdf_t = (self.coefficients.sigma_t()).map(|sigma_t| {
            // Together, for apart one overflows and the other underflows.
            let pdf_t = (f64::from(sigma_t).ln() + density - depth(sigma_t, mass)).exp();
            (pdf_t as f32).min(f32::MAX)
        });
        (channel_pmf(importance) * pdf_t).sum().min(f32::MAX)
    }

    fn pmf_passing(&self, ray: &Ray, importance: S) -> f32 {
        (channel_pmf(importance) * self.mean_transmittance(ray)).sum()
    }

    /// Stretches over which the density changes by a factor of 2, from where it is no longer 0 in
    /// `f32` to where it is capped: 300 at most.
    fn majorants(&self, ray: &Ray, mut visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        let column = self.column(ray);
        let sigma_t = self.coefficients.sigma_t().max_channel();
        let ([mut t, end], step) = (self.substance(ray), LN_2 / column.slope.abs());
        while t < end {
            let here = column.log_density(t.into());
            let step = match here - self.cap {
                capped if capped < 0.0 => step,
                _ if column.slope <= 0.0 => f64::INFINITY,
                capped => step + capped / column.slope,
            };
            let t_max = ((f64::from(t) + step) as f32).max(t.next_up()).min(end);
            let densest = here.max(column.log_density(t_max.into()));
            let sigma_bar = (f64::from(sigma_t) * self.capped(densest)) as f32;
            let stretch = Majorant {
                t_min: t,
                t_max,
                sigma_bar,
            };
            if sigma_bar > 0.0 && visit(stretch).is_break() {
                return;
            }
            t = t_max;
        }
    }

    #[inline]
    fn homogeneous(&self) -> Option<Coefficients<S>> {
        None
    }
}

impl<S: Spectrum> Atmosphere<S> {
    /// The part of a ray where the extinction is not 0 in `f32`.
    fn substance(&self, ray: &Ray) -> [f32; 2] {
        let column = self.column(ray);
        let sigma_t = self.coefficients.sigma_t().max_channel();
        let above = column.start + f64::from(sigma_t).ln() - EMPTY;
        // Infinite, or not a number, on a horizontal ray.
        let crossing = (above / column.slope.abs()) as f32;
        if column.slope < 0.0 {
            [(-crossing).max(0.0), ray.t_max]
        } else if above > 0.0 {
            [0.0, crossing.min(ray.t_max)]
        } else {
            [0.0, 0.0]
        }
    }
}
