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
        let start = |part: usize| if part == 0 { 0 } else { ends[part - 1] };
        // The larger number where areas are the same: points in a row have none.
        let rank = |part| (areas[part], ends[part] - start(part));
        let largest = (0..count).fold(0, |a, b| if rank(b) > rank(a) { b } else { a });
        let start = start(largest);
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
/// count is rounded to full leaves, so that the areas are those of the plane nearby. Of planes that
/// cost the same, the one nearest to the middle.
fn cheapest(items: &[Item], bounds: &[Aabb]) -> (usize, usize, [f64; 2]) {
    let bins = Bins::of(items, bounds);
    let leaves = items.len().div_ceil(LEAF);
    let mut best = (f64::INFINITY, usize::MAX);
    // There is no plane if all items have the same keys: any half will do.
    let mut found = (0, leaves / 2 * LEAF, [area(bins.whole()); 2]);
    for axis in 0..4 {
        for (count, left, right) in bins.planes(axis) {
            let before = ((count + LEAF / 2) / LEAF).clamp(1, leaves - 1);
            let behind = leaves - before;
            let (left, right) = (area(left), area(right));
            let cost = left * before as f64 + right * behind as f64;
            let rank = (cost, before.abs_diff(behind));
            if rank < best {
                best = rank;
                found = (axis, before * LEAF, [left, right]);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// No box of points in a row has a surface, so that all splits cost the same.
    #[test]
    fn points_in_a_row_are_split_by_number() {
        let points: Vec<_> = (0..64 * LEAF)
            .map(|i| Aabb::of_points([Vec3::X * i as f32]))
            .collect();
        let item = |i: usize| Item {
            key: [2.0 * i as f32, 0.0, 0.0, 0.0],
            index: i as u32,
        };
        let mut items: Vec<_> = (0..points.len()).map(item).collect();
        let (ends, count) = by_cost(&mut items, &points);
        assert_eq!(count, LANES);
        assert_eq!(
            ends,
            [8, 16, 24, 32, 40, 48, 56, 64].map(|leaves| leaves * LEAF)
        );
    }
}
