//! Named random streams.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tyndall_core::{Domain, Sampler, Streams};

/// The streams of one pass: xoshiro256++ (Blackman & Vigna 2021), whose 256 bits of state are a
/// chain of hashes of the name, so that no two names share a state.
#[derive(Clone, Copy, Debug)]
pub struct PassStreams {
    seed: u64,
    pass: u64,
}

impl PassStreams {
    /// The streams of pass `pass` of a render with this seed.
    pub fn new(seed: u64, pass: u64) -> Self {
        Self { seed, pass }
    }
}

impl Streams for PassStreams {
    type Sampler = Generator;

    #[inline]
    fn sampler(&self, domain: Domain, index: u64) -> Generator {
        let mut state = [0; 32];
        let mut hash = 0;
        let name = [self.seed, self.pass, u64::from(domain.0), index];
        for (word, part) in state.chunks_exact_mut(8).zip(name) {
            hash = mix(hash ^ part);
            word.copy_from_slice(&hash.to_le_bytes());
        }
        Generator(Xoshiro256PlusPlus::from_seed(state))
    }
}

/// The finaliser of SplitMix64 (Steele, Lea & Flood 2014) after a step of its sequence.
#[inline]
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// One stream.
#[derive(Clone, Debug)]
pub struct Generator(Xoshiro256PlusPlus);

impl Sampler for Generator {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        // The 24 highest bits: every multiple of 2⁻²⁴ below 1.
        (self.0.next_u64() >> 40) as f32 * (1.0 / (1 << 24) as f32)
    }
}
