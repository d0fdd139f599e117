//! The statistics of progressive photon mapping.

use crate::Shrinkage;

/// What a place remembers of the photons found near it: its radius and how many it has kept.
///
/// Hachisuka, Ogaki & Jensen (2008), "Progressive Photon Mapping"; Hachisuka & Jensen (2009),
/// "Stochastic Progressive Photon Mapping", where the place is a pixel and each pass estimates at
/// another point. With N photons kept and M found in a pass,
///
/// ```text
/// N' = N + α M,   r'ᵈ = r ᵈ N'/(N + M)
/// ```
///
/// # The flux need not be stored
/// The paper keeps the flux found, τ' = (τ + φ) r'ᵈ/rᵈ with φ that of the pass, and estimates
/// Lᵢ = τᵢ/(c rᵢᵈ i P) after i passes of P paths (c = π on surfaces). Put the first into the second:
///
/// ```text
/// i Lᵢ = (τᵢ₋₁ + φᵢ)/(c rᵢ₋₁ᵈ P) = (i − 1) Lᵢ₋₁ + φᵢ/(c rᵢ₋₁ᵈ P)
/// ```
///
/// So the paper's estimate *is* the plain mean over passes of each pass's own estimate with the
/// radius before its update, which is what a film does. It also holds for any other kernel.
///
/// ```
/// use tyndall_density::{Dimension, Shrinkage, Statistics};
/// let mut pixel = Statistics::new(2.0);
/// let half = Shrinkage::new(Dimension::Two, 0.5)?;
/// pixel.update(8.0, half); // of the first photons half are kept
/// assert_eq!(pixel.count, 4.0);
/// assert_eq!(pixel.radius, 2.0f64.sqrt());
/// # Ok::<(), tyndall_density::ScheduleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// r, in scene units or over a starting radius. In `f64`, since late passes shrink it by less
    /// than `f32` resolves.
    pub radius: f64,
    /// N, a fraction of those found.
    pub count: f64,
}

impl Statistics {
    /// A place that has found nothing yet.
    pub fn new(radius: f64) -> Self {
        Self { radius, count: 0.0 }
    }

    /// Takes in a pass that found `found` photons (M) within the radius. If it found none, or no
    /// finite number, nothing changes.
    pub fn update(&mut self, found: f64, shrinkage: Shrinkage) {
        if !(found > 0.0 && found.is_finite()) {
            return;
        }
        let kept = self.count + shrinkage.alpha() * found;
        let ratio = kept / (self.count + found);
        self.radius *= ratio.powf(1.0 / f64::from(shrinkage.dimension().number()));
        self.count = kept;
    }
}
