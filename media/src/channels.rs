//! Sampling one distance for all channels.

use crate::MediumError;
use tyndall_core::{Coefficients, Sampler, Spectrum};

/// Probabilities of the channels, in proportion to `importance`; uniform if it is black or not
/// finite.
#[inline]
pub(crate) fn channel_pmf<S: Spectrum>(importance: S) -> S {
    let largest = importance.max_channel();
    if !(largest > 0.0 && largest.is_finite()) {
        return S::splat(1.0 / S::CHANNELS as f32);
    }
    let relative = importance.map(|x| x.max(0.0) / largest);
    relative / relative.sum()
}

/// The channel that `u` in \[0, 1) chooses.
#[inline]
pub(crate) fn choose_channel<S: Spectrum>(pmf: S, u: f32) -> usize {
    let mut rest = u;
    let mut chosen = 0;
    for c in 0..S::CHANNELS {
        let p = pmf.channel(c);
        if p > 0.0 {
            chosen = c;
            if rest < p {
                break;
            }
        }
        rest -= p;
    }
    chosen
}

/// A distance in mean free paths: density e^{−τ}. Near 0 and 1 the 24 bits of a number are refined
/// by those of another, so that distances reach from 4e-15 to 33.
#[inline]
pub(crate) fn exponential(sampler: &mut impl Sampler) -> f32 {
    const EDGE: f32 = 1.0 / 1024.0;
    let u = sampler.next_1d();
    if (EDGE..1.0 - EDGE).contains(&u) {
        return -(1.0 - u).ln(); // 1 − u is exact
    }
    let fine = f64::from(u) + f64::from(sampler.next_1d()) / f64::from(1 << 24);
    -(-fine).ln_1p() as f32
}

/// The smallest of `values` among the channels where `pmf` is positive.
#[inline]
fn smallest_sampled<S: Spectrum>(values: S, pmf: S) -> f32 {
    (0..S::CHANNELS)
        .filter(|&c| pmf.channel(c) > 0.0)
        .map(|c| values.channel(c))
        .fold(f32::INFINITY, f32::min)
}

/// factor·e^{−τ} over its mean over the sampled channels, none of which has 0/0: the smallest
/// exponent of those is taken out first. 0 in channels that are not sampled.
#[inline]
pub(crate) fn weight<S: Spectrum>(factor: S, tau: S, pmf: S) -> S {
    let least = smallest_sampled(tau, pmf);
    let relative = S::from_channels(|c| {
        if pmf.channel(c) > 0.0 {
            factor.channel(c) * (least - tau.channel(c)).exp()
        } else {
            0.0
        }
    });
    relative / (relative * pmf).sum()
}

/// Checks that coefficients are finite, at least 0, and add to a finite extinction.
pub(crate) fn check_coefficients<S: Spectrum>(
    coefficients: &Coefficients<S>,
) -> Result<(), MediumError> {
    let fields = [
        ("sigma_a", coefficients.sigma_a),
        ("sigma_s", coefficients.sigma_s),
        ("emission", coefficients.emission),
        ("sigma_a + sigma_s", coefficients.sigma_t()),
    ];
    for (field, spectrum) in fields {
        for channel in 0..S::CHANNELS {
            let value = spectrum.channel(channel);
            if !(value.is_finite() && value >= 0.0) {
                return Err(MediumError::Coefficient {
                    field,
                    channel,
                    value,
                });
            }
        }
    }
    Ok(())
}
