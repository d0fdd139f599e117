//! Several media in the same place.

use crate::channels::{channel_pmf, check_coefficients};
use crate::{AnyMedium, AnyPhase, MediumError};
use glam::Vec3;
use std::ops::ControlFlow;
use tyndall_core::{Coefficients, Collision, FreeFlight, Majorant, Medium, Ray, Sampler, Spectrum};

/// Media that fill the same place: a cloud in haze, two plumes of smoke. Their coefficients add.
///
/// # Free flights
/// The media race: each flies up to the nearest collision so far, with the importance that the
/// weights of those before leave, and the weights multiply. What the first let through to the
/// collision of the second has the mean of its transmittance there, so that a collision of any has
/// the weight of its σt times the transmittance of all, whatever the colours; and as none changes
/// Σ importance·weight, all together do not, hence the density of distances is Σ pmf·σt·Tr of the
/// sum. Every medium is sampled by its own method, closed forms before tracking, as they shorten
/// the way of the rest.
///
/// # Emission
/// What a medium emits up to the first collision of a race among the *others*, times the weight of
/// that race: the others reach beyond t with a mean weight of their transmittance to t. Unbiased,
/// and it costs a free flight through the others for each medium that emits.
///
/// # Phase function
/// The phase functions mix in proportion to σs at the point. A phase function is one number for
/// all channels, so that the proportion is that of the channels' *means* of σs: exact where the σs
/// of the media have one colour or where one of them scatters; elsewhere every channel of the light
/// that is scattered has the right power and the angular distribution of their mean. The media may
/// scatter red and blue to the same directions where one would scatter its red forward; the mean
/// over the channels of σs times phase function is right in every direction.
///
/// # Probabilities
/// Those of the sum, exact if those of all the media are.
#[derive(Clone, Debug)]
pub struct Overlap<S> {
    /// At least one.
    parts: Vec<AnyMedium<S>>,
}

impl<S: Spectrum> Overlap<S> {
    /// All `parts` together.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Coefficients, Medium};
    /// use tyndall_media::{AnyMedium, Homogeneous, Overlap, Phase};
    /// let fog = |sigma_s| {
    ///     let fog = Coefficients { sigma_a: 0.5_f32, sigma_s, emission: 0.0 };
    ///     Homogeneous::new(fog, Phase::Isotropic).map(AnyMedium::Homogeneous)
    /// };
    /// let both = Overlap::new(vec![fog(1.0)?, fog(2.0)?])?;
    /// assert_eq!(both.coefficients(Vec3::ZERO).sigma_t(), 4.0);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    ///
    /// # Errors
    /// [`MediumError::NoMedia`] if there is none; [`MediumError::Coefficient`] if those of the
    /// homogeneous ones overflow together.
    pub fn new(mut parts: Vec<AnyMedium<S>>) -> Result<Self, MediumError> {
        if parts.is_empty() {
            return Err(MediumError::NoMedia);
        }
        let constant = parts.iter().filter_map(Medium::homogeneous);
        check_coefficients(&constant.fold(Coefficients::default(), add))?;
        parts.sort_by_key(AnyMedium::is_tracked);
        Ok(Self { parts })
    }

    /// The media.
    pub fn parts(&self) -> &[AnyMedium<S>] {
        &self.parts
    }

    /// Whether any of them does.
    pub(crate) fn emits(&self) -> bool {
        self.parts.iter().any(AnyMedium::emits)
    }

    /// What all let through, where they track about.
    pub(crate) fn mean_transmittance(&self, ray: &Ray) -> S {
        let each = self.parts.iter().map(|part| part.mean_transmittance(ray));
        each.fold(S::splat(1.0), |product, one| product * one)
    }

    /// The weight, and the first collision with the index of the medium it is in, of a race among
    /// all but one.
    fn race(
        &self,
        ray: &Ray,
        importance: S,
        but: Option<usize>,
        sampler: &mut impl Sampler,
    ) -> (S, Option<(usize, Collision<S>)>) {
        let pmf = channel_pmf(importance);
        let mut weight = pmf.map(|p| if p > 0.0 { 1.0 } else { 0.0 });
        let (mut ray, mut first) = (*ray, None);
        for (index, part) in self.parts.iter().enumerate() {
            if Some(index) == but {
                continue;
            }
            let flight = part.sample_free_flight(&ray, pmf * weight, sampler);
            weight *= flight.weight;
            if let Some(collision) = flight.collision {
                ray = ray.up_to(collision.t);
                first = Some((index, collision));
            }
        }
        (weight, first)
    }
}

fn add<S: Spectrum>(a: Coefficients<S>, b: Coefficients<S>) -> Coefficients<S> {
    Coefficients {
        sigma_a: a.sigma_a + b.sigma_a,
        sigma_s: a.sigma_s + b.sigma_s,
        emission: a.emission + b.emission,
    }
}

impl<S: Spectrum> Medium for Overlap<S> {
    type Spectrum = S;
    type Phase<'a> = AnyPhase<'a>;

    fn coefficients(&self, p: Vec3) -> Coefficients<S> {
        let each = self.parts.iter().map(|part| part.coefficients(p));
        each.fold(Coefficients::default(), add)
    }

    fn phase(&self, p: Vec3) -> AnyPhase<'_> {
        AnyPhase::mix(self.parts.iter().map(|part| {
            let sigma_s = part.coefficients(p).sigma_s.mean();
            (sigma_s, part.phase(p))
        }))
    }

    /// The product of theirs, which are independent.
    fn transmittance(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        let mut transmittance = S::splat(1.0);
        for part in &self.parts {
            transmittance *= part.transmittance(ray, sampler);
            if transmittance.is_black() {
                break;
            }
        }
        transmittance
    }

    fn emitted(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        let mut emitted = S::default();
        for (index, part) in self.parts.iter().enumerate() {
            if part.emits() {
                let (weight, first) = self.race(ray, S::splat(1.0), Some(index), sampler);
                let end = first.map_or(ray.t_max, |(_, collision)| collision.t);
                let glow = part.emitted(&ray.up_to(end), sampler);
                // A glow without end may be infinite.
                emitted += weight.zip(glow, |w, glow| if w == 0.0 { 0.0 } else { w * glow });
            }
        }
        emitted
    }

    fn sample_free_flight(
        &self,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<S> {
        let (weight, first) = self.race(ray, importance, None, sampler);
        let collision = first.map(|(index, Collision { t, coefficients })| {
            // The medium it is in knows them even where rounding moves the point out of its box.
            let others = self.parts.iter().enumerate().filter(|&(i, _)| i != index);
            let others = others.map(|(_, part)| part.coefficients(ray.at(t)));
            let coefficients = others.fold(coefficients, add);
            Collision { t, coefficients }
        });
        FreeFlight { weight, collision }
    }

    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: S) -> f32 {
        if !(0.0..ray.t_max).contains(&t) {
            return 0.0;
        }
        let sigma_t = self.coefficients(ray.at(t)).sigma_t();
        let transmittance = self.mean_transmittance(&ray.up_to(t));
        (channel_pmf(importance) * sigma_t * transmittance).sum()
    }

    fn pmf_passing(&self, ray: &Ray, importance: S) -> f32 {
        (channel_pmf(importance) * self.mean_transmittance(ray)).sum()
    }

    /// The sums of theirs; a new stretch wherever one of theirs begins or ends.
    fn majorants(&self, ray: &Ray, mut visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        let mut lists: Vec<_> = (self.parts.iter())
            .map(|part| part.stretches(ray).into_iter().peekable())
            .collect();
        let mut t_min = 0.0;
        loop {
            let (mut t_max, mut sigma_bar) = (None, 0.0);
            for list in &mut lists {
                while list.next_if(|stretch| stretch.t_max <= t_min).is_some() {}
                let Some(stretch) = list.peek() else {
                    continue;
                };
                let next = if stretch.t_min <= t_min {
                    sigma_bar += stretch.sigma_bar;
                    stretch.t_max
                } else {
                    stretch.t_min
                };
                t_max = Some(t_max.map_or(next, |t_max: f32| t_max.min(next)));
            }
            let Some(t_max) = t_max else {
                return;
            };
            let stretch = Majorant {
                t_min,
                t_max,
                sigma_bar,
            };
            if sigma_bar > 0.0 && visit(stretch).is_break() {
                return;
            }
            t_min = t_max;
        }
    }

    fn homogeneous(&self) -> Option<Coefficients<S>> {
        let mut each = self.parts.iter().map(Medium::homogeneous);
        each.try_fold(Coefficients::default(), |sum, one| Some(add(sum, one?)))
    }
}
