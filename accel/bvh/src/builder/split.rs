//! Where to split.

use super::{Item, TASK};
use crate::LANES;
use glam::Vec3;
use tyndall_core::Aabb;

/// Ends of the parts, in items, and how many parts there are.
pub(crate) type Parts = ([usize; LANES], usize);

/// Up to eight parts of equal size, all but the last made of full blocks and, above the lowest
/// nodes, of full nodes.
pub(crate) fn evenly(items: &mut [Item]) -> Parts {
    let blocks = items.len().div_ceil(LANES);
    let mut capacity = 1;
    while capacity * LANES < blocks {
        capacity *= LANES;
    }
    let count = blocks.div_ceil(capacity);
    let mut ends = [0; LANES];
    halve(items, 0, capacity.min(LANES), &mut ends[..count]);
    (ends, count)
}

/// Splits `items`, which start at `start`, into as many parts as there are `ends`, each a
/// multiple of `unit` blocks.
fn halve(items: &mut [Item], start: usize, unit: usize, ends: &mut [usize]) {
    if let [end] = ends {
        *end = start + items.len();
        return;
    }
    let blocks = items.len().div_ceil(LANES);
    let left = (blocks * (ends.len() / 2)).div_ceil(ends.len());
    let at = left.next_multiple_of(unit) * LANES;
    let axis = widest(centers(items).size());
    select(items, at, |item| center(item)[axis]);
    let (left, right) = items.split_at_mut(at);
    let (left_ends, right_ends) = ends.split_at_mut(ends.len() / 2);
    let in_parallel = at > TASK;
    let mut left = || halve(left, start, unit, left_ends);
    let mut right = || halve(right, start + at, unit, right_ends);
    if in_parallel {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}

/// Twice the centre.
fn center(item: &Item) -> Vec3 {
    item.bounds.min + item.bounds.max
}

fn centers(items: &[Item]) -> Aabb {
    Aabb::of_points(items.iter().map(center))
}

fn widest(size: Vec3) -> usize {
    size.max_position()
}

/// Puts the `at` items of smallest key in front.
fn select(items: &mut [Item], at: usize, key: impl Fn(&Item) -> f32) {
    if at < items.len() {
        items.select_nth_unstable_by(at, |a, b| key(a).total_cmp(&key(b)));
    }
}

/// By the surface area heuristic.
pub(crate) fn by_cost(items: &mut [Item]) -> Parts {
    evenly(items)
}
