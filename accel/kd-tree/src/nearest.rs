//! Room for the k nearest.

/// A photon that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Where it is stored; see [`crate::Photons::get`].
    pub slot: u32,
    /// The square of its distance from the centre.
    pub distance_squared: f32,
}

/// Room for the k nearest photons of a query, reused from one to the next.
///
/// It keeps up to 2k candidates and drops all but the k nearest when it is full: on average the
/// cost a candidate does not grow with k. A query takes room for 2k candidates of 8 bytes, or as
/// many as there are photons if these are fewer, unless an earlier one has; it is never given back.
#[derive(Clone, Debug)]
pub struct Nearest {
    k: usize,
    found: Vec<Neighbour>,
}

impl Nearest {
    /// Room for `k` photons.
    pub fn new(k: usize) -> Self {
        Self {
            k,
            found: Vec::new(),
        }
    }

    /// How many are looked for.
    #[inline]
    pub fn k(&self) -> usize {
        self.k
    }

    /// What the last query found, at most k: the farthest is last, the others are in no order.
    #[inline]
    pub fn found(&self) -> &[Neighbour] {
        &self.found
    }

    /// The farthest that the last query found.
    #[inline]
    pub fn farthest(&self) -> Option<Neighbour> {
        self.found.last().copied()
    }

    /// Forgets the last query and makes room for one among so many photons.
    #[inline]
    pub(crate) fn begin(&mut self, photons: usize) {
        self.found.clear();
        self.found.reserve(self.capacity().min(photons));
    }

    /// Adds a candidate whose squared distance is below `limit`, and returns the limit for the next
    /// ones: lower if k nearer ones are known. `k` is not 0.
    #[inline]
    pub(crate) fn add(&mut self, candidate: Neighbour, limit: f32) -> f32 {
        self.found.push(candidate);
        if self.found.len() < self.capacity() {
            return limit;
        }
        self.keep(self.k);
        self.found[self.k - 1].distance_squared
    }

    /// Ends a query.
    #[inline]
    pub(crate) fn end(&mut self) {
        self.keep(self.k.min(self.found.len()));
    }

    #[inline]
    fn capacity(&self) -> usize {
        self.k.saturating_mul(2)
    }

    /// Keeps the `count` nearest, the farthest of them last.
    fn keep(&mut self, count: usize) {
        if count > 0 {
            // Bits of numbers that are not negative are ordered as the numbers.
            self.found
                .select_nth_unstable_by_key(count - 1, |n| n.distance_squared.to_bits());
        }
        self.found.truncate(count);
    }
}
