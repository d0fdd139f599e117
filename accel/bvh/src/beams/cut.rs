//! The builder: space is cut, and beams with it, until few pieces are in each leaf.
//!
//! A ray comes near a beam in proportion to its length, but meets boxes in proportion to their
//! surface: of beams that go anywhere, it is shown the fewest if all pieces that cross a small box
//! are in one leaf, and end at its faces. So boxes are halved, along the axis that pays most, and
//! what lies across the plane is cut there.

use super::leaf::{Leaf, Part, Slot};
use super::lines::Lines;
use super::{BeamShape, STEPS, Segment, segment};
use crate::builder::{LEVELS_BY_COST, TASK, area};
use crate::node::{Child, Node};
use crate::{LANES, LEAF};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use tyndall_core::Aabb;

/// Pieces a beam, on the mean, at most. With 16, rays through 66,000 beams take nine tenths of the
/// time, and trees 1.2 times the memory and 1.15 times the time to build.
const PIECES: usize = 12;
/// Pieces of a leaf that is not worth another cut.
const FEW: usize = 40;
/// A cut leaves so much of the tests at most.
const WORTH: f32 = 0.9;

/// What is built.
#[derive(Default)]
pub(super) struct Grown {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) slots: Vec<Slot>,
    pub(super) lines: Vec<Lines>,
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
        let Segment { ends, radius, .. } = segment(&shapes[part.beam as usize], part.numbers);
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
    #[inline]
    fn keys(&self) -> [Vec3; 3] {
        let [a, b] = self.ends;
        let along = b - a;
        let turn = if along.element_sum() < 0.0 { -1.0 } else { 1.0 };
        [a + b, turn * along, 2.0 * self.radius * Vec3::X]
    }
}

/// Pieces that are to be in one subtree.
struct Set {
    items: Vec<Item>,
    /// How many more there may be.
    spare: usize,
    /// Tests that a ray has to expect.
    cost: f64,
    plan: Plan,
}

/// How a set is parted.
#[derive(Clone, Copy, PartialEq)]
enum Plan {
    /// Along an axis, at a place; pieces may lie on both sides.
    Plane(usize, f32),
    /// Pieces up to a size from larger ones.
    Size(f32),
    /// By number.
    Halves,
    /// Not at all.
    Leaf,
}

impl Plan {
    fn by_number(count: usize) -> Self {
        if count > LEAF {
            Self::Halves
        } else {
            Self::Leaf
        }
    }
}

/// What lies on one side of a plane: its box, and how many there are.
#[derive(Clone, Copy)]
struct Side {
    min: Vec3A,
    max: Vec3A,
    count: usize,
}

impl Side {
    const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
        count: 0,
    };

    #[inline]
    fn add(&mut self, a: Vec3A, b: Vec3A) {
        self.min = self.min.min(a.min(b));
        self.max = self.max.max(a.max(b));
        self.count += 1;
    }

    fn bounds(&self) -> Aabb {
        Aabb {
            min: self.min.into(),
            max: self.max.into(),
        }
    }
}

/// The box of all ends, and the largest radius.
#[derive(Clone, Copy)]
struct Extent(Aabb, f32);

impl Extent {
    const EMPTY: Self = Self(Aabb::EMPTY, 0.0);

    fn with(self, item: &Item) -> Self {
        Self(self.0.union(item.bounds()), self.1.max(item.radius))
    }

    /// Tests that a ray has to expect of so many pieces: in proportion to the surface.
    fn cost(self, count: usize) -> f64 {
        let Self(Aabb { min, max }, radius) = self;
        let all = Aabb {
            min: min - radius,
            max: max + radius,
        };
        area(all) * count as f64
    }
}

impl Set {
    fn new(items: Vec<Item>, spare: usize) -> Self {
        let extent = items.iter().fold(Extent::EMPTY, Extent::with);
        let mut set = Self {
            cost: extent.cost(items.len()),
            items,
            spare,
            plan: Plan::Leaf,
        };
        if set.items.len() > FEW {
            set.plan = set.best(extent);
        }
        set
    }

    /// The cut that leaves the least cost, if it is worth it.
    fn best(&self, extent: Extent) -> Plan {
        let count = self.items.len();
        let center = extent.0.center();
        let mut sides = [[Side::EMPTY; 2]; 3];
        for item in &self.items {
            let [a, b] = item.ends.map(Vec3A::from);
            let along = b - a;
            let share = ((Vec3A::from(center) - a) / along).to_array();
            let Aabb { min, max } = item.bounds();
            for (axis, [low, high]) in sides.iter_mut().enumerate() {
                if max[axis] <= center[axis] {
                    low.add(a, b);
                } else if min[axis] >= center[axis] {
                    high.add(a, b);
                } else {
                    let cut = a + along * share[axis];
                    let up = item.ends[0][axis] < item.ends[1][axis];
                    low.add(if up { a } else { b }, cut);
                    high.add(if up { b } else { a }, cut);
                }
            }
        }
        let mut best = (f64::from(WORTH) * self.cost, Plan::by_number(count));
        let mut offer = |cost: f64, plan: Plan| {
            if cost < best.0 {
                best = (cost, plan);
            }
        };
        for (axis, [low, high]) in sides.iter().enumerate() {
            let all = low.count + high.count;
            if low.count.min(high.count) > 0 && all - count <= self.spare {
                let cost = |side: &Side| Extent(side.bounds(), extent.1).cost(side.count);
                offer(cost(low) + cost(high), Plan::Plane(axis, center[axis]));
            }
        }
        let largest = self.items.iter().map(Item::size).fold(0.0, f32::max);
        let small = |item: &&Item| item.size() <= 0.25 * largest;
        let few = self.items.iter().filter(small).count();
        if (1..count).contains(&few) {
            let all_small = self.items.iter().filter(small);
            let of_small = all_small.fold(Extent::EMPTY, Extent::with).cost(few);
            offer(
                of_small + extent.cost(count - few),
                Plan::Size(0.25 * largest),
            );
        }
        best.1
    }

    /// Two sets, of which one is empty if pieces are too short for the plane.
    fn parted(self, shapes: &[BeamShape]) -> [Self; 2] {
        let (mut low, mut high) = (Vec::new(), Vec::new());
        let count = self.items.len();
        match self.plan {
            Plan::Plane(axis, place) => {
                for item in self.items {
                    let [a, b] = item.ends.map(|end| end[axis]);
                    if a.max(b) <= place {
                        low.push(item);
                    } else if a.min(b) >= place {
                        high.push(item);
                    } else if let Some([first, second]) = halves(shapes, &item, axis, place) {
                        low.push(if a < b { first } else { second });
                        high.push(if a < b { second } else { first });
                    } else if a + b < 2.0 * place {
                        low.push(item);
                    } else {
                        high.push(item);
                    }
                }
            }
            Plan::Size(size) => {
                (low, high) = self.items.iter().partition(|item| item.size() <= size)
            }
            Plan::Halves | Plan::Leaf => return self.halved(),
        }
        let all = low.len() + high.len();
        let spare = self.spare - (all - count);
        let of_low = (spare as f64 * (low.len() as f64 / all as f64)) as usize;
        [Self::new(low, of_low), Self::new(high, spare - of_low)]
    }

    /// Two sets without a cut: halves along the key in which they differ most, the first of them
    /// full leaves.
    fn halved(mut self) -> [Self; 2] {
        let at = self.items.len().div_ceil(LEAF) / 2 * LEAF;
        select(&mut self.items, at);
        let high = self.items.split_off(at);
        let of_low = self.spare / 2;
        let low = Self::new(self.items, of_low);
        [low, Self::new(high, self.spare - of_low)]
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
    let mut ranges = [Aabb::EMPTY; 3];
    for item in items.iter() {
        for (range, key) in ranges.iter_mut().zip(item.keys()) {
            *range = Aabb {
                min: range.min.min(key),
                max: range.max.max(key),
            };
        }
    }
    let widest = |of: usize| ranges[of].size().max_element();
    let of = (1..3).fold(0, |a, b| if widest(b) > widest(a) { b } else { a });
    let axis = ranges[of].size().max_position();
    let mut keyed: Vec<_> = items
        .iter()
        .map(|item| (item.keys()[of][axis], *item))
        .collect();
    keyed.select_nth_unstable_by(at, |a, b| a.0.total_cmp(&b.0));
    for (item, (_, sorted)) in items.iter_mut().zip(keyed) {
        *item = sorted;
    }
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
            let grow = |set| {
                let mut below = Grown::default();
                (self.child(set, depth, 0, &mut below), below)
            };
            let parts: Vec<_> = parts.into_par_iter().map(grow).collect();
            for (lane, ((bounds, child), below)) in parts.into_iter().enumerate() {
                let child = child.moved(grown.nodes.len() - root, grown.leaves.len());
                grown.append(below);
                adopt(grown, lane, (bounds, child));
            }
        } else {
            for (lane, set) in parts.into_iter().enumerate() {
                let child = self.child(set, depth, root, grown);
                adopt(grown, lane, child);
            }
        }
        whole
    }

    /// Up to eight sets: that of the largest cost is parted again and again.
    fn parts(&self, set: Set, depth: usize) -> Vec<Set> {
        let evenly = depth >= LEVELS_BY_COST;
        let rank = |set: &Set| (if evenly { 0.0 } else { set.cost }, set.items.len());
        let mut parts = vec![set];
        while parts.len() < LANES {
            let open = (0..parts.len()).filter(|&part| parts[part].plan != Plan::Leaf);
            let next = open.reduce(|a, b| {
                if rank(&parts[b]) > rank(&parts[a]) {
                    b
                } else {
                    a
                }
            });
            let Some(next) = next else {
                break;
            };
            let both = parts.swap_remove(next).parted(self.shapes);
            let all_in_one = both.iter().any(|set| set.items.is_empty());
            for mut set in both.into_iter().filter(|set| !set.items.is_empty()) {
                if evenly || all_in_one {
                    set.plan = Plan::by_number(set.items.len());
                }
                parts.push(set);
            }
        }
        parts
    }

    /// Makes a leaf, or appends a subtree; its box, and what it is to the node at `root`.
    fn child(&self, mut set: Set, depth: usize, root: usize, grown: &mut Grown) -> (Aabb, Child) {
        if set.plan != Plan::Leaf {
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
        let (leaf, slots) = Leaf::new(&parts, &segments, grown.lines.len() as u32);
        let lines = segments.chunks(LANES).map(|block| leaf.ball.lines(block));
        grown.lines.extend(lines);
        grown.leaves.push(leaf);
        grown.slots.extend(slots);
        (bounds, Child::Leaf(grown.leaves.len() as u32 - 1))
    }
}

impl Grown {
    /// Adds what was grown apart.
    fn append(&mut self, below: Self) {
        let (leaves, blocks) = (self.leaves.len(), self.lines.len() as u32);
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
        self.slots.extend(below.slots);
        self.lines.extend(below.lines);
    }
}
