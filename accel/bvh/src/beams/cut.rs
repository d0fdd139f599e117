//! The builder: space is cut, and beams with it, until few pieces are in each leaf.
//!
//! A ray comes near a beam in proportion to its length, but meets boxes in proportion to their
//! surface: of beams that go anywhere, it is shown the fewest if all pieces that cross a small box
//! are in one leaf, and end at its faces. So boxes are halved, along the axis that pays most, and
//! what lies across the plane is cut there.

use super::leaf::{Block, Leaf, Part};
use super::{BeamShape, STEPS, Segment, segment};
use crate::builder::{LEVELS_BY_COST, TASK};
use crate::node::{Child, Node};
use crate::{LANES, LEAF};
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::Aabb;

/// Pieces a beam, on the mean, at most; two thirds of them are made where beams go anywhere. With half
/// or twice as many, rays through 66,000 beams take 1.2 and 0.8 of the time, builds 0.7 and 1.3, and
/// memory is 0.65 and 1.4 of what it is.
const PIECES: usize = 16;
/// Pieces of a leaf that is not worth another cut.
const FEW: usize = 40;
/// A cut leaves so much of the tests at most.
const WORTH: f32 = 0.9;

/// What is built.
#[derive(Default)]
pub(super) struct Grown {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) blocks: Vec<Block>,
}

/// A tree over all beams that can be met.
pub(super) fn grow(shapes: &[BeamShape]) -> Grown {
    let items = |(index, shape): (usize, &BeamShape)| {
        let part = Part {
            beam: index as u32,
            numbers: [0, STEPS],
        };
        shape.has_volume().then(|| Item::new(shapes, part))
    };
    let items: Vec<_> = shapes.par_iter().enumerate().filter_map(items).collect();
    let mut grown = Grown::default();
    if !items.is_empty() {
        let spare = (PIECES - 1) * items.len();
        Builder { shapes }.grow(Set::new(items, spare), 0, &mut grown);
    }
    grown
}

/// A piece while it is sorted.
#[derive(Clone, Copy)]
struct Item {
    ends: [Vec3; 2],
    radius: f32,
    part: Part,
}

impl Item {
    fn new(shapes: &[BeamShape], part: Part) -> Self {
        let Segment { ends, radius } = segment(&shapes[part.beam as usize], part.numbers);
        Self {
            ends: ends.map(|end| end.as_vec3()),
            radius: radius as f32,
            part,
        }
    }

    /// The box of its ends.
    fn bounds(&self) -> Aabb {
        let [a, b] = self.ends;
        Aabb {
            min: a.min(b),
            max: a.max(b),
        }
    }

    /// The longest edge of its box.
    fn size(&self) -> f32 {
        (self.ends[1] - self.ends[0]).abs().max_element() + 2.0 * self.radius
    }

    /// What pieces of a block should have alike: their middle, where they go, and their radius.
    fn keys(&self) -> [f32; KEYS] {
        let [a, b] = self.ends;
        let along = b - a;
        let along = if along.element_sum() < 0.0 {
            -along
        } else {
            along
        };
        let [x, y, z] = (a + b).to_array();
        let [u, v, w] = along.to_array();
        [x, y, z, u, v, w, 2.0 * self.radius]
    }
}

const KEYS: usize = 7;

/// Pieces that are to be in one subtree.
struct Set {
    items: Vec<Item>,
    /// How many more there may be.
    spare: usize,
    /// The box of all ends.
    bounds: Aabb,
    radius: f32,
    size: f32,
}

/// Half the surface of a box that holds all within a radius; 0 if it is empty.
fn area(bounds: Aabb, radius: f32) -> f32 {
    if bounds.is_empty() {
        return 0.0;
    }
    let [x, y, z] = (bounds.size() + 2.0 * radius).to_array();
    x * y + y * z + z * x
}

/// How a set can be parted.
#[derive(Clone, Copy)]
enum Cut {
    /// Along an axis, at a place; pieces may lie on both sides.
    Plane(usize, f32),
    /// Pieces up to a size from larger ones.
    Size(f32),
}

impl Set {
    fn new(items: Vec<Item>, spare: usize) -> Self {
        let mut set = Self {
            items,
            spare,
            bounds: Aabb::EMPTY,
            radius: 0.0,
            size: 0.0,
        };
        for item in &set.items {
            set.bounds = set.bounds.union(item.bounds());
            set.radius = set.radius.max(item.radius);
            set.size = set.size.max(item.size());
        }
        set
    }

    /// Tests that a ray has to expect.
    fn cost(&self) -> f32 {
        area(self.bounds, self.radius) * self.items.len() as f32
    }

    /// The cut that leaves the least cost, if it is worth it.
    fn best(&self) -> Option<Cut> {
        let center = self.bounds.center();
        let (mut left, mut right) = ([0_u32; 3], [0_u32; 3]);
        let (mut few, mut small, mut thin) = (0, Aabb::EMPTY, 0.0_f32);
        let middling = 0.25 * self.size;
        for item in &self.items {
            let Aabb { min, max } = item.bounds();
            for axis in 0..3 {
                left[axis] += u32::from(min[axis] < center[axis]);
                right[axis] += u32::from(max[axis] > center[axis]);
            }
            if item.size() <= middling {
                few += 1;
                small = small.union(item.bounds());
                thin = thin.max(item.radius);
            }
        }
        let count = self.items.len();
        let mut best = (WORTH * self.cost(), None);
        let mut offer = |cost: f32, cut: Cut| {
            if cost < best.0 {
                best = (cost, Some(cut));
            }
        };
        for axis in 0..3 {
            let [low, high] = [left[axis] as usize, right[axis] as usize];
            if low.min(high) == 0 || (low + high).saturating_sub(count) > self.spare {
                continue;
            }
            let mut half = self.bounds;
            half.max[axis] = center[axis];
            let cost = area(half, self.radius) * (low + high) as f32;
            offer(cost, Cut::Plane(axis, center[axis]));
        }
        if (1..count).contains(&few) {
            let rest = area(self.bounds, self.radius) * (count - few) as f32;
            offer(area(small, thin) * few as f32 + rest, Cut::Size(middling));
        }
        best.1
    }

    /// Two sets, or nothing where all would be on one side.
    fn cut(self, shapes: &[BeamShape], cut: Cut) -> [Self; 2] {
        let (mut low, mut high) = (Vec::new(), Vec::new());
        let count = self.items.len();
        for item in self.items {
            match cut {
                Cut::Size(size) if item.size() <= size => low.push(item),
                Cut::Size(_) => high.push(item),
                Cut::Plane(axis, place) => {
                    let [a, b] = item.ends.map(|end| end[axis]);
                    if a.max(b) <= place {
                        low.push(item);
                    } else if a.min(b) >= place {
                        high.push(item);
                    } else if let Some([first, second]) = halves(shapes, &item, axis, place) {
                        let [first, second] = if a < b {
                            [first, second]
                        } else {
                            [second, first]
                        };
                        low.push(first);
                        high.push(second);
                    } else if a + b < 2.0 * place {
                        low.push(item);
                    } else {
                        high.push(item);
                    }
                }
            }
        }
        let all = low.len() + high.len();
        let spare = self.spare - (all - count);
        let of_low = (spare as f64 * (low.len() as f64 / all as f64)) as usize;
        [Self::new(low, of_low), Self::new(high, spare - of_low)]
    }

    /// Two sets without a cut: halves along the key in which they differ most, the first of them
    /// full leaves.
    fn halved(mut self) -> [Self; 2] {
        let leaves = self.items.len().div_ceil(LEAF);
        let at = leaves / 2 * LEAF;
        select(&mut self.items, at);
        let high = self.items.split_off(at);
        let of_low = self.spare / 2;
        [
            Self::new(self.items, of_low),
            Self::new(high, self.spare - of_low),
        ]
    }
}

/// A piece on both sides of a plane; `None` if it is too short to be cut.
fn halves(shapes: &[BeamShape], item: &Item, axis: usize, place: f32) -> Option<[Item; 2]> {
    let Part { beam, numbers } = item.part;
    let [start, end] = numbers;
    if end - start < 2 {
        return None;
    }
    let [a, b] = item.ends.map(|end| end[axis]);
    let share = (place - a) / (b - a);
    let middle = start + (share * f32::from(end - start)).round() as u16;
    let middle = middle.clamp(start + 1, end - 1);
    let half = |numbers| Item::new(shapes, Part { beam, numbers });
    Some([half([start, middle]), half([middle, end])])
}

/// Puts the `at` items of smallest key in front, along the key in which they differ most.
fn select(items: &mut [Item], at: usize) {
    let mut range = [[f32::INFINITY, f32::NEG_INFINITY]; KEYS];
    for item in items.iter() {
        for (range, key) in range.iter_mut().zip(item.keys()) {
            *range = [range[0].min(key), range[1].max(key)];
        }
    }
    let spread = |axis: usize| range[axis][1] - range[axis][0];
    let axis = (1..KEYS).fold(0, |a, b| if spread(b) > spread(a) { b } else { a });
    items.select_nth_unstable_by(at, |a, b| a.keys()[axis].total_cmp(&b.keys()[axis]));
}

/// Sorts the items of a leaf into its blocks.
fn into_blocks(items: &mut [Item]) {
    let blocks = items.len().div_ceil(LANES);
    if blocks > 1 {
        let at = blocks / 2 * LANES;
        select(items, at);
        let (low, high) = items.split_at_mut(at);
        into_blocks(low);
        into_blocks(high);
    }
}

struct Builder<'a> {
    shapes: &'a [BeamShape],
}

impl Builder<'_> {
    /// Appends the subtree over a set; returns its box.
    fn grow(&self, set: Set, depth: usize, grown: &mut Grown) -> Aabb {
        let parallel = set.items.len() > TASK;
        let root = grown.nodes.len();
        grown.nodes.push(Node::EMPTY);
        let mut whole = Aabb::EMPTY;
        let mut adopt = |grown: &mut Grown, lane, (bounds, child)| {
            grown.nodes[root].set(lane, bounds, child);
            whole = whole.union(bounds);
        };
        let parts = self.parts(set, depth);
        if parallel {
            let grow = |(set, last)| {
                let mut below = Grown::default();
                (self.child(set, last, depth, 0, &mut below), below)
            };
            let parts: Vec<_> = parts.into_par_iter().map(grow).collect();
            for (lane, ((bounds, child), below)) in parts.into_iter().enumerate() {
                let child = child.moved(grown.nodes.len() - root, grown.leaves.len());
                grown.append(below);
                adopt(grown, lane, (bounds, child));
            }
        } else {
            for (lane, (set, last)) in parts.into_iter().enumerate() {
                let child = self.child(set, last, depth, root, grown);
                adopt(grown, lane, child);
            }
        }
        whole
    }

    /// Up to eight sets, and whether each is a leaf: that of the largest cost is parted again and
    /// again.
    fn parts(&self, set: Set, depth: usize) -> Vec<(Set, bool)> {
        let mut parts = vec![(set, false)];
        while parts.len() < LANES {
            let costs = parts.iter().enumerate().filter(|(_, (_, leaf))| !leaf);
            let costs = costs.map(|(i, (set, _))| (set.cost(), set.items.len(), i));
            let Some((_, _, next)) =
                costs.reduce(|a, b| if (b.0, b.1) > (a.0, a.1) { b } else { a })
            else {
                break;
            };
            let (set, _) = &parts[next];
            match self.cut_of(set, depth) {
                None => parts[next].1 = true,
                Some(cut) => {
                    let (set, _) = parts.swap_remove(next);
                    let [low, high] = match cut {
                        Some(cut) => set.cut(self.shapes, cut),
                        None => set.halved(),
                    };
                    // All on one side: they are too short for the plane.
                    match [low.items.len(), high.items.len()] {
                        [0, few] if few <= LEAF => parts.push((high, true)),
                        [few, 0] if few <= LEAF => parts.push((low, true)),
                        [0, _] => parts.extend(high.halved().map(|set| (set, false))),
                        [_, 0] => parts.extend(low.halved().map(|set| (set, false))),
                        _ => parts.extend([low, high].map(|set| (set, false))),
                    }
                }
            }
        }
        parts
    }

    /// How to part a set: `None` if it is a leaf, `Some(None)` if by number.
    fn cut_of(&self, set: &Set, depth: usize) -> Option<Option<Cut>> {
        let count = set.items.len();
        let cut = || (depth < LEVELS_BY_COST).then(|| set.best()).flatten();
        match cut() {
            _ if count <= FEW => None,
            None if count <= LEAF => None,
            cut => Some(cut),
        }
    }

    /// Makes a leaf, or appends a subtree; its box, and what it is to the node at `root`.
    fn child(
        &self,
        mut set: Set,
        leaf: bool,
        depth: usize,
        root: usize,
        grown: &mut Grown,
    ) -> (Aabb, Child) {
        if !leaf && self.cut_of(&set, depth).is_some() {
            let offset = grown.nodes.len() - root;
            let bounds = self.grow(set, depth + 1, grown);
            return (bounds, Child::Node(offset as u32));
        }
        into_blocks(&mut set.items);
        let parts: Vec<_> = set.items.iter().map(|item| item.part).collect();
        let segment = |part: &Part| segment(&self.shapes[part.beam as usize], part.numbers);
        let segments: Vec<_> = parts.iter().map(segment).collect();
        let bounds = segments.iter().map(Segment::bounds);
        let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
        let (leaf, blocks) = Leaf::new(&parts, &segments, grown.blocks.len() as u32);
        grown.leaves.push(leaf);
        grown.blocks.extend(blocks);
        (bounds, Child::Leaf(grown.leaves.len() as u32 - 1))
    }
}

impl Grown {
    /// Adds what was grown apart.
    fn append(&mut self, below: Self) {
        let (leaves, blocks) = (self.leaves.len(), self.blocks.len() as u32);
        let moved = |mut node: Node| {
            node.move_leaves(leaves);
            node
        };
        self.nodes.extend(below.nodes.into_iter().map(moved));
        let moved = |mut leaf: Leaf| {
            leaf.first += blocks;
            leaf
        };
        self.leaves.extend(below.leaves.into_iter().map(moved));
        self.blocks.extend(below.blocks);
    }
}
