//! Where to split.

use super::cost::{Bins, area};
use super::{Item, TASK};
use crate::{LANES, LEAF};
use glam::Vec4;
use tyndall_core::Aabb;

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

/// Up to eight parts, all but the last made of full leaves: the part of the largest surface is
/// split where rays are expected to pay least, again and again.
pub(super) fn by_cost(items: &mut [Item], bounds: &[Aabb]) -> Parts {
    let mut ends = [0; LANES];
    // The area of each part; of leaves, which are not split, none.
    let mut areas = [0.0; LANES];
    (ends[0], areas[0]) = (items.len(), f64::INFINITY);
    let mut count = 1;
    while count < LANES {
        let largest = (0..count).fold(0, |a, b| if areas[b] > areas[a] { b } else { a });
        let start = if largest == 0 { 0 } else { ends[largest - 1] };
        let part = &mut items[start..ends[largest]];
        if part.len() <= LEAF {
            break;
        }
        let (axis, at, of_sides) = cheapest(part, bounds);
        select(part, at, axis);
        let sizes = [at, part.len() - at];
        ends.copy_within(largest..count, largest + 1);
        areas.copy_within(largest..count, largest + 1);
        ends[largest] = start + at;
        for side in 0..2 {
            areas[largest + side] = if sizes[side] > LEAF {
                of_sides[side]
            } else {
                -1.0
            };
        }
        count += 1;
    }
    (ends, count)
}

/// Where to split: the axis, how many items are on the left, and the areas of both sides. The
/// count is rounded to full leaves, so that the areas are those of the plane nearby.
fn cheapest(items: &[Item], bounds: &[Aabb]) -> (usize, usize, [f64; 2]) {
    let bins = Bins::of(items, bounds);
    let leaves = items.len().div_ceil(LEAF);
    let round = |count: usize| ((count + LEAF / 2) / LEAF).clamp(1, leaves - 1);
    let mut best = f64::INFINITY;
    let whole = bins.whole();
    let mut found = (
        spread(items).max_position(),
        round(items.len() / 2) * LEAF,
        [area(whole); 2],
    );
    for axis in 0..4 {
        for (count, left, right) in bins.planes(axis) {
            let (left, right) = (area(left), area(right));
            let cost = left * round(count) as f64 + right * (leaves - round(count)) as f64;
            if cost < best {
                best = cost;
                found = (axis, round(count) * LEAF, [left, right]);
            }
        }
    }
    found
}
