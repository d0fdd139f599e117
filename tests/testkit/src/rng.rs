//! Random numbers for tests.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tyndall_core::Sampler;

/// Independent uniform numbers of 24 bits from Xoshiro256++ (Blackman & Vigna 2021).
#[derive(Clone, Debug)]
pub struct TestSampler(Xoshiro256PlusPlus);

/// The sampler of a seed: the same seed gives the same numbers on every machine.
///
/// ```
/// use tyndall_core::Sampler;
/// let [a, b] = tyndall_testkit::rng(7).next();
/// assert!((0.0..1.0).contains(&a) && a != b);
/// assert_eq!(tyndall_testkit::rng(7).next_1d(), a);
/// ```
pub fn rng(seed: u64) -> TestSampler {
    TestSampler(Xoshiro256PlusPlus::seed_from_u64(seed))
}

impl Sampler for TestSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        const STEP: f32 = 1.0 / (1 << 24) as f32;
        (self.0.next_u64() >> 40) as f32 * STEP
    }
}
