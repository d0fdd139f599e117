//! Transmittance to all photons of a ray, by free flights.

use tyndall_core::{Medium, Ray, Sampler, Spectrum};

/// Free flights along a ray: an unbiased estimate of its transmittance, to all distances at once.
///
/// A free flight weighs σt·Tr over the density of its distance d if it collides, and Tr over the
/// probability of passing if it does not. Over n flights,
///
/// ```text
/// T(t) = (1/n) Σ weight·[passed, or d > t]
/// ```
///
/// has for any t up to the end s of the ray, and in every channel, the mean
/// ∫ₜˢ σt Tr dt' + Tr(s) = Tr(t), since σt Tr is −dTr/dt: whatever the density is, one for all
/// channels included. Grey media have weights of 1, and T is the share of flights that get farther,
/// as in the progressive deep shadow maps of Jarosz et al. (2011), "Progressive Photon Beams", §5.1.
#[derive(Clone, Debug)]
pub struct Flights<S> {
    /// How far they got, ascending, and their weight over their number; then the sum of the weights
    /// from there on. The last is one that got infinitely far and weighs nothing.
    ends: Vec<(f32, S)>,
}

// Not derived: that would ask the same of `S`.
impl<S> Default for Flights<S> {
    fn default() -> Self {
        Self { ends: Vec::new() }
    }
}

impl<S: Spectrum> Flights<S> {
    /// Flies `count` times. `importance` is that of [`Medium::sample_free_flight`].
    pub fn fly<M: Medium<Spectrum = S>>(
        &mut self,
        medium: &M,
        ray: &Ray,
        count: u32,
        importance: S,
        sampler: &mut impl Sampler,
    ) {
        self.ends.clear();
        for _ in 0..count {
            let flight = medium.sample_free_flight(ray, importance, sampler);
            let distance = flight.collision.map_or(f32::INFINITY, |c| c.t);
            self.ends.push((distance, flight.weight / count as f32));
        }
        self.ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.ends.push((f32::INFINITY, S::default()));
        let mut sum = S::default();
        for (_, weight) in self.ends.iter_mut().rev() {
            sum += *weight;
            *weight = sum;
        }
    }

    /// How far the flights got, ascending (infinity, if through), each with the estimate for what
    /// is nearer than that and farther than those before.
    pub fn ends(&self) -> &[(f32, S)] {
        &self.ends[..self.ends.len().saturating_sub(1)]
    }

    /// The estimate for `t`.
    ///
    /// # Panics
    /// No flights were made.
    #[inline]
    pub fn transmittance(&self, t: f32) -> S {
        let shorter = self.ends.partition_point(|(distance, _)| *distance <= t);
        self.ends[shorter.min(self.ends.len() - 1)].1
    }

    /// Whether all channels are the same.
    #[inline]
    pub fn is_grey(&self) -> bool {
        S::CHANNELS == 1 || self.ends.iter().all(|(_, w)| *w == S::splat(w.channel(0)))
    }
}
