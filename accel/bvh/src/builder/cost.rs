//! What splits cost: items in bins (Wald 2007, "On fast construction of SAH-based bounding volume
//! hierarchies"), along x, y, z and size.

use super::{Item, TASK};
use glam::Vec4;
use rayon::prelude::*;
use tyndall_core::Aabb;

const BINS: usize = 16;

/// Half the surface of a box; 0 for what is empty. In `f64`: areas of 1e18 squared add up.
pub(crate) fn area(bounds: Aabb) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let size = bounds.size().as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// The items of a range in bins along four axes.
pub(super) struct Bins([[(usize, Aabb); BINS]; 4]);

impl Bins {
    const EMPTY: Self = Self([[(0, Aabb::EMPTY); BINS]; 4]);

    pub(super) fn of(items: &[Item], bounds: &[Aabb]) -> Self {
        let keys = |item: &Item| Vec4::from_array(item.key);
        let (min, max) = items
            .par_iter()
            .with_min_len(TASK)
            .map(|item| (keys(item), keys(item)))
            .reduce(
                || (Vec4::INFINITY, Vec4::NEG_INFINITY),
                |a, b| (a.0.min(b.0), a.1.max(b.1)),
            );
        // Along an axis where keys are all the same, all are in one bin, and there is no plane.
        let range = max - min;
        let differ = range.cmpgt(Vec4::splat(BINS as f32 / f32::MAX));
        let scale = Vec4::select(differ, BINS as f32 / range, Vec4::ZERO);
        let fill = |mut bins: Self, item: &Item| {
            let bounds = bounds[item.index as usize];
            let place = ((keys(item) - min) * scale).to_array();
            for (axis, place) in bins.0.iter_mut().zip(place) {
                let bin = &mut axis[(place as usize).min(BINS - 1)];
                *bin = (bin.0 + 1, bin.1.union(bounds));
            }
            bins
        };
        if items.len() <= TASK {
            return items.iter().fold(Self::EMPTY, fill);
        }
        items
            .par_chunks(TASK)
            .map(|items| items.iter().fold(Self::EMPTY, fill))
            .reduce(|| Self::EMPTY, Self::merge)
    }

    fn merge(mut self, other: Self) -> Self {
        let bins = self.0.iter_mut().flatten();
        for (bin, other) in bins.zip(other.0.iter().flatten()) {
            *bin = (bin.0 + other.0, bin.1.union(other.1));
        }
        self
    }

    /// The box of all items.
    pub(super) fn whole(&self) -> Aabb {
        self.0[0]
            .iter()
            .fold(Aabb::EMPTY, |all, bin| all.union(bin.1))
    }

    /// The planes between bins that have items on both sides: items on the left, and the boxes of
    /// both sides.
    pub(super) fn planes(&self, axis: usize) -> impl Iterator<Item = (usize, Aabb, Aabb)> {
        let bins = &self.0[axis];
        let mut behind = [Aabb::EMPTY; BINS];
        for i in (1..BINS).rev() {
            behind[i - 1] = behind[i].union(bins[i].1);
        }
        let mut left = (0, Aabb::EMPTY);
        (0..BINS - 1)
            .map(move |i| {
                left = (left.0 + bins[i].0, left.1.union(bins[i].1));
                (left.0, left.1, behind[i])
            })
            .filter(|(_, left, right)| !left.is_empty() && !right.is_empty())
    }
}
