//! Bounds of the extinction along a ray.
//!
//! A tree of cubes over the cells of a field ([`Field::cells`](crate::Field::cells)): a node has
//! 4³ children, empty ones are not stored, and each knows the bounds of all below. A ray walks the
//! children of a node it meets, and theirs, and passes what is empty in one step, however large
//! (Museth 2014, "Hierarchical Digital Differential Analyzer for Efficient Ray-Marching in OpenVDB").

use crate::field::{Cells, Range, Region};
use glam::{DAffine3, DVec3, IVec3};
use std::ops::ControlFlow;
use tyndall_core::Ray;

/// Children along an edge of a node, and their logarithm.
const EDGE: i32 = 4;
const LOG2: u32 = 2;
/// A node is crossed at once if that costs fewer null collisions than this: about what a step of
/// the walk takes.
const WORTH: f32 = 0.25;

/// What is known of a region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Of the density.
    pub(crate) density: Range<f32>,
    /// Where light is emitted, how many collisions per unit of length emission asks for.
    pub(crate) rate: f32,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    cell: Cell,
    /// A bit for each child that is not empty, x slowest; they lie together from `first` on.
    children: u64,
    first: u32,
}

/// A tree of bounds.
#[derive(Clone, Debug)]
pub(crate) struct Majorants {
    /// From space into units of cells, from the first one.
    to_cells: DAffine3,
    /// How many there are; a ray along the outermost face belongs to the last.
    count: DVec3,
    /// Nodes above the cells.
    levels: u32,
    /// The root first; none if all is empty.
    nodes: Vec<Node>,
    /// Extinction where the density is 1, of the channel where it is largest.
    sigma_t: f32,
}

impl Majorants {
    /// `describe` looks at a region; `None` if it is empty.
    pub(crate) fn new(
        cells: Cells,
        sigma_t: f32,
        describe: impl Fn(&Region) -> Option<Cell>,
    ) -> Self {
        let longest = cells.count.max_element().max(1) as u32;
        let levels = longest.next_power_of_two().ilog2().div_ceil(LOG2);
        let mut majorants = Self {
            to_cells: cells.to_world.inverse(),
            count: cells.count.as_dvec3(),
            levels,
            nodes: Vec::new(),
            sigma_t,
        };
        let maker = Maker { cells, describe };
        if let Some(cell) = maker.cell(IVec3::ZERO, levels) {
            majorants.nodes.push(Node {
                cell,
                children: 0,
                first: 0,
            });
            maker.divide(&mut majorants.nodes, 0, IVec3::ZERO, levels);
        }
        majorants
    }

    /// Visits the stretches of the ray between `start` and `end` whose bound is positive, in order.
    #[inline]
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        [start, end]: [f64; 2],
        mut visit: impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(root) = self.nodes.first() else {
            return ControlFlow::Continue(());
        };
        let direction = self.to_cells.transform_vector3(ray.direction.as_dvec3());
        let line = Line {
            origin: self.to_cells.transform_point3(ray.origin.as_dvec3()),
            direction,
            inverse: direction.recip(),
        };
        match line.through(DVec3::ZERO, f64::from(EDGE.pow(self.levels)), [start, end]) {
            Some(span) => self.descend(root, DVec3::ZERO, self.levels, &line, span, &mut visit),
            None => ControlFlow::Continue(()),
        }
    }

    /// Amanatides & Woo (1987) through the children of a node, with distances computed from the
    /// planes instead of summed. The stretches join without a gap.
    fn descend(
        &self,
        node: &Node,
        corner: DVec3,
        level: u32,
        line: &Line,
        [start, end]: [f64; 2],
        visit: &mut impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Range { min, max, .. } = node.cell.density;
        let null = self.sigma_t * (max - min) * (end - start) as f32;
        if node.children == 0 || null < WORTH {
            return visit(start, end, &node.cell);
        }
        let edge = f64::from(EDGE.pow(level - 1));
        let inside = (line.origin + start * line.direction - corner) / edge;
        let last = ((self.count - corner) / edge).ceil().as_ivec3() - 1;
        let last = last.min(IVec3::splat(EDGE - 1));
        let mut at = [0; 3];
        let mut exits = [0.0; 3];
        let exit = |i: usize, at: i32| {
            let forward = line.direction[i] > 0.0;
            let end = if forward { at >= last[i] } else { at == 0 };
            if end || line.inverse[i].is_infinite() {
                return f64::INFINITY;
            }
            let plane = corner[i] + edge * f64::from(at + i32::from(forward));
            (plane - line.origin[i]) * line.inverse[i]
        };
        for i in 0..3 {
            at[i] = (inside[i] as i32).clamp(0, last[i]);
            exits[i] = exit(i, at[i]);
        }
        let mut t = start;
        loop {
            let next = nearest(exits);
            let leave = exits[next].max(t).min(end);
            let bit = 1_u64 << (at[0] * EDGE * EDGE + at[1] * EDGE + at[2]);
            if leave > t && node.children & bit != 0 {
                let rank = (node.children & (bit - 1)).count_ones();
                let child = &self.nodes[(node.first + rank) as usize];
                let corner = corner + edge * DVec3::from(at.map(f64::from));
                self.descend(child, corner, level - 1, line, [t, leave], visit)?;
            }
            if exits[next] >= end {
                return ControlFlow::Continue(());
            }
            t = leave;
            at[next] += if line.direction[next] > 0.0 { 1 } else { -1 };
            exits[next] = exit(next, at[next]);
        }
    }
}

/// A ray in units of cells.
struct Line {
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
}

impl Line {
    /// The part of a stretch inside a cube.
    fn through(
        &self,
        corner: DVec3,
        edge: f64,
        [mut start, mut end]: [f64; 2],
    ) -> Option<[f64; 2]> {
        for i in 0..3 {
            let [a, b] = [corner[i], corner[i] + edge].map(|plane| plane - self.origin[i]);
            if self.inverse[i].is_infinite() {
                if a > 0.0 || b < 0.0 {
                    return None;
                }
            } else {
                let (a, b) = (a * self.inverse[i], b * self.inverse[i]);
                start = start.max(a.min(b));
                end = end.min(a.max(b));
            }
        }
        (start < end).then_some([start, end])
    }
}

/// The axis of the smallest distance.
#[inline]
fn nearest(exits: [f64; 3]) -> usize {
    let first = if exits[1] < exits[0] { 1 } else { 0 };
    if exits[2] < exits[first] { 2 } else { first }
}

struct Maker<F> {
    cells: Cells,
    describe: F,
}

impl<F: Fn(&Region) -> Option<Cell>> Maker<F> {
    /// What is known of the cube of 4^`level` cells from `first` on; `None` if it is empty.
    fn cell(&self, first: IVec3, level: u32) -> Option<Cell> {
        if first.cmpge(self.cells.count).any() {
            return None;
        }
        let place = DAffine3::from_translation(first.as_dvec3());
        let scale = DAffine3::from_scale(DVec3::splat(f64::from(EDGE.pow(level))));
        let to_world = self.cells.to_world * place * scale;
        (self.describe)(&Region { to_world })
    }

    /// Gives a node the children it is worth.
    fn divide(&self, nodes: &mut Vec<Node>, node: usize, first: IVec3, level: u32) {
        let Cell { density, rate } = nodes[node].cell;
        if level == 0 || (density.min == density.max && rate == 0.0) {
            return;
        }
        let start = nodes.len();
        let edge = EDGE.pow(level - 1);
        let mut origins = Vec::new();
        for i in 0..EDGE.pow(3) {
            let at = IVec3::new(i / (EDGE * EDGE), i / EDGE % EDGE, i % EDGE);
            let first = first + edge * at;
            if let Some(cell) = self.cell(first, level - 1) {
                nodes[node].children |= 1 << i;
                nodes.push(Node {
                    cell,
                    children: 0,
                    first: 0,
                });
                origins.push(first);
            }
        }
        nodes[node].first = start as u32;
        for (i, first) in origins.into_iter().enumerate() {
            self.divide(nodes, start + i, first, level - 1);
        }
    }
}
