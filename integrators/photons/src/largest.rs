//! The largest of what many threads have met.

use std::sync::atomic::{AtomicU32, Ordering};

/// The largest number that was reported, 0 if none was.
#[derive(Debug, Default)]
pub struct Largest(
    /// Bits of a number that is not negative: they are ordered as the numbers.
    AtomicU32,
);

impl Largest {
    /// Takes a number into account, one that is not negative.
    pub fn report(&self, number: f32) {
        if number.to_bits() > self.0.load(Ordering::Relaxed) {
            self.0.fetch_max(number.to_bits(), Ordering::Relaxed);
        }
    }

    /// The largest so far.
    pub fn get(&self) -> f32 {
        f32::from_bits(self.0.load(Ordering::Relaxed))
    }
}
