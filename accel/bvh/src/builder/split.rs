//! Where to split.

use super::{Item, TASK};
use crate::{LANES, LEAF};
use glam::Vec4;

/// Ends of the parts, in items, and how many parts there are.
pub(super) type Parts = ([usize; LANES], usize);

/// Up to eight parts of equal size, all but the last made of full leaves.
pub(super) fn evenly(items: &mut [Item]) -> Parts {
    let leaves = items.len().div_ceil(LEAF);
    let mut capacity = 1;
    while capacity * LANES < leaves {
        capacity *= LANES;
    }
    let count = leaves.div_ceil(capacity);
    let mut ends = [0; LANES];
    halve(items, 0, LEAF, &mut ends[..count]);
    (ends, count)
}

/// Sorts the items of a leaf into its blocks.
pub(super) fn into_blocks(items: &mut [Item]) {
    let count = items.len().div_ceil(LANES);
    halve(items, 0, LANES, &mut [0; LEAF / LANES][..count]);
}

/// Splits `items`, which start at `start`, into as many parts as there are `ends`, each but the
/// last a multiple of `unit`.
fn halve(items: &mut [Item], start: usize, unit: usize, ends: &mut [usize]) {
    if let [end] = ends {
        *end = start + items.len();
        return;
    }
    let units = items.len().div_ceil(unit);
    let at = (units * (ends.len() / 2)).div_ceil(ends.len()) * unit;
    select(items, at, spread(items).max_position());
    let (left, right) = items.split_at_mut(at);
    let (left_ends, right_ends) = ends.split_at_mut(ends.len() / 2);
    let parallel = at > TASK;
    let mut left = || halve(left, start, unit, left_ends);
    let mut right = || halve(right, start + at, unit, right_ends);
    if parallel {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}

/// How far keys lie apart.
fn spread(items: &[Item]) -> Vec4 {
    let (min, max) = items
        .iter()
        .map(|item| Vec4::from_array(item.key))
        .fold((Vec4::INFINITY, Vec4::NEG_INFINITY), |(min, max), key| {
            (min.min(key), max.max(key))
        });
    max - min
}

/// Puts the `at` items of smallest key along `axis` in front.
fn select(items: &mut [Item], at: usize, axis: usize) {
    items.select_nth_unstable_by(at, |a, b| a.key[axis].total_cmp(&b.key[axis]));
}

/// By the surface area heuristic.
pub(super) fn by_cost(items: &mut [Item]) -> Parts {
    evenly(items)
}
