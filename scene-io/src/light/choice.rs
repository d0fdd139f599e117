//! A choice among many, in proportion to weights.

use super::{Light, Source, World};
use tyndall_core::Spectrum;

/// A discrete distribution.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// Running sums, the last being 1; empty if all weights are zero.
    cumulative: Vec<f64>,
}

impl Choice {
    /// In proportion to `weights`, finite and not negative.
    pub(super) fn new(weights: impl Iterator<Item = f64>) -> Self {
        let mut sum = 0.0;
        let sums = weights.map(|weight| {
            sum += weight;
            sum
        });
        let mut cumulative: Vec<_> = sums.collect();
        cumulative.iter_mut().for_each(|c| *c /= sum);
        if sum <= 0.0 {
            cumulative.clear();
        }
        Self { cumulative }
    }

    /// Index and probability; never one of weight zero.
    pub(super) fn sample(&self, u: f32) -> Option<(usize, f32)> {
        let i = self.cumulative.partition_point(|&c| c <= f64::from(u));
        (i < self.cumulative.len()).then(|| (i, self.pmf(i)))
    }

    /// Probability of `i`.
    pub(super) fn pmf(&self, i: usize) -> f32 {
        let below = i.checked_sub(1).map_or(0.0, |i| self.cumulative[i]);
        self.cumulative.get(i).map_or(0.0, |c| (c - below) as f32)
    }
}

/// How often to choose each light: in proportion to its power among those of its kind, at infinity
/// or in the scene, which share evenly. The power of light from infinity grows with the size of the
/// world: by power alone, a large ground would hide every lamp.
pub(super) fn weights<S: Spectrum>(lights: &[Light<S>], world: World) -> impl Iterator<Item = f64> {
    let kind = |light: &Light<S>| {
        usize::from(matches!(
            light.source,
            Source::Environment(_) | Source::Directional(_)
        ))
    };
    let mut totals = [0.0; 2];
    let mut shares = Vec::with_capacity(lights.len());
    for light in lights.iter() {
        let power = f64::from(light.power(world).mean());
        totals[kind(light)] += power;
        shares.push((power, kind(light)));
    }
    let share = move |(power, kind): (f64, usize)| match totals[kind] {
        0.0 => 0.0,
        total => power / total,
    };
    shares.into_iter().map(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chooses_in_proportion_and_never_what_has_no_weight() {
        let choice = Choice::new([0.0, 1.0, 0.0, 3.0, 0.0].into_iter());
        assert_eq!(
            [0, 1, 2, 3, 4].map(|i| choice.pmf(i)),
            [0.0, 0.25, 0.0, 0.75, 0.0]
        );
        assert_eq!(choice.sample(0.0), Some((1, 0.25)));
        assert_eq!(choice.sample(0.25), Some((3, 0.75)));
        assert_eq!(choice.sample(1.0_f32.next_down()), Some((3, 0.75)));
        assert_eq!(Choice::new([0.0].into_iter()).sample(0.5), None);
    }
}
