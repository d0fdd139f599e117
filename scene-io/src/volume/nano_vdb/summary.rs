//! What a node states of the active voxels below it.

use glam::IVec3;
use tyndall_core::Spectrum;

/// Number, box, extremes and moments of active voxels. What is ordered and averaged is the value
/// itself, or the square of a vector's length, as NanoVDB does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summary<T> {
    pub(super) voxels: u64,
    /// First and last voxel.
    pub(super) bounds: Option<[IVec3; 2]>,
    extremes: Option<[(f64, T); 2]>,
    mean: f64,
    /// Sum of squared distances from the mean.
    squares: f64,
}

impl<T: Spectrum> Summary<T> {
    /// Of no voxel.
    pub(super) fn new() -> Self {
        Self {
            voxels: 0,
            bounds: None,
            extremes: None,
            mean: 0.0,
            squares: 0.0,
        }
    }

    /// Of `edge`³ voxels of one value, from `origin` on.
    pub(super) fn cube(origin: IVec3, edge: i32, value: T) -> Self {
        let measure = match T::CHANNELS {
            1 => f64::from(value.channel(0)),
            n => (0..n).map(|c| f64::from(value.channel(c)).powi(2)).sum(),
        };
        Self {
            voxels: u64::from(edge.unsigned_abs()).pow(3),
            bounds: Some([origin, origin + (edge - 1)]),
            extremes: Some([(measure, value); 2]),
            mean: measure,
            squares: 0.0,
        }
    }

    /// Counts other voxels (Chan, Golub, LeVeque 1979, eq. 2.1).
    pub(super) fn add(&mut self, other: &Self) {
        if other.voxels == 0 {
            return;
        }
        let (n, m) = (self.voxels as f64, other.voxels as f64);
        let delta = other.mean - self.mean;
        self.mean += delta * (m / (n + m));
        self.squares += other.squares + delta * delta * (n * m / (n + m));
        self.voxels += other.voxels;
        self.bounds = join(self.bounds, other.bounds, |a, b| {
            [a[0].min(b[0]), a[1].max(b[1])]
        });
        self.extremes = join(self.extremes, other.extremes, |a, b| {
            let smaller = if b[0].0 < a[0].0 { b[0] } else { a[0] };
            let larger = if b[1].0 > a[1].0 { b[1] } else { a[1] };
            [smaller, larger]
        });
    }

    /// The smallest and the largest value.
    pub(super) fn extremes(&self) -> Option<[T; 2]> {
        self.extremes
            .map(|extremes| extremes.map(|(_, value)| value))
    }

    /// Mean and standard deviation, of all voxels and not of a sample.
    pub(super) fn moments(&self) -> [f32; 2] {
        let variance = self.squares / self.voxels.max(1) as f64;
        [self.mean as f32, variance.sqrt() as f32]
    }
}

fn join<A>(a: Option<A>, b: Option<A>, both: impl FnOnce(A, A) -> A) -> Option<A> {
    match (a, b) {
        (Some(a), Some(b)) => Some(both(a, b)),
        (a, b) => a.or(b),
    }
}
