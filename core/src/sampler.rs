//! Random numbers.

/// A source of numbers in \[0, 1), independent or of low discrepancy.
pub trait Sampler {
    /// The next number, in \[0, 1).
    fn next_1d(&mut self) -> f32;

    /// The next point of the unit cube.
    #[inline]
    fn next<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| self.next_1d())
    }
}

/// Names a family of random streams.
///
/// A stream is named by (seed, pass, domain, index) and never cloned, which makes a picture the
/// same to the bit on any number of threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Domain(pub u32);

impl Domain {
    /// One stream a pixel: `index` is its number, row by row.
    pub const SENSOR: Self = Self(0);
    /// One stream a light path: `index` is the number of the path.
    pub const LIGHT: Self = Self(1);
    /// What builds a structure between the two.
    pub const STRUCTURE: Self = Self(2);
    /// What a host measures beside the picture, as the features of a denoiser: one stream a pixel.
    pub const FEATURES: Self = Self(3);
}

/// The random streams of one pass.
pub trait Streams: Sync {
    /// What a stream is.
    type Sampler: Sampler;

    /// The stream of this name; the same name gives the same numbers.
    fn sampler(&self, domain: Domain, index: u64) -> Self::Sampler;
}
