//! Bounds of the extinction along a ray.
//!
//! A tree of cubes over the cells of a field ([`Field::cells`](crate::Field::cells)): a node has
//! 8³ children, empty ones are not stored, and each knows the bounds of all below. A ray walks the
//! children of a node it meets, and theirs, and passes what is empty in one step, however large
//! (Museth 2014, "Hierarchical Digital Differential Analyzer for Efficient Ray-Marching in OpenVDB").

use crate::field::{Cells, Range, Region};
use glam::{DAffine3, DVec3, IVec3};
use std::ops::ControlFlow;
use tyndall_core::Ray;

/// Children along an edge of a node, and their logarithm.
const EDGE: i32 = 8;
const LOG2: u32 = 3;
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
    /// Its children; none if it is a cell.
    children: Option<u32>,
}

/// The children of a node.
#[derive(Clone, Debug)]
struct Children {
    /// For x and y, y faster, a bit for each z whose child is not empty.
    present: [u8; 64],
    /// The number of the first child there; they lie together in order.
    first: [u32; 64],
}

impl Children {
    #[inline]
    fn find(&self, [x, y, z]: [i32; 3]) -> Option<u32> {
        let column = (x * EDGE + y) as usize;
        let bit = 1_u8 << z;
        let below = (self.present[column] & (bit - 1)).count_ones();
        (self.present[column] & bit != 0).then(|| self.first[column] + below)
    }
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
    children: Vec<Children>,
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
            children: Vec::new(),
            sigma_t,
        };
        let maker = Maker { cells, describe };
        if let Some(cell) = maker.cell(IVec3::ZERO, levels) {
            majorants.nodes.push(Node {
                cell,
                children: None,
            });
            maker.divide(&mut majorants, 0, IVec3::ZERO, levels);
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
        let line = Line::new(
            self.to_cells.transform_point3(ray.origin.as_dvec3()),
            self.to_cells.transform_vector3(ray.direction.as_dvec3()),
        );
        match line.through(f64::from(EDGE.pow(self.levels)), [start, end]) {
            Some(span) => self.cross(root, [0.0; 3], self.levels, &line, span, &mut visit),
            None => ControlFlow::Continue(()),
        }
    }

    /// Visits a node as a whole or its children.
    #[inline]
    fn cross(
        &self,
        node: &Node,
        corner: [f64; 3],
        level: u32,
        line: &Line,
        [start, end]: [f64; 2],
        visit: &mut impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Range { min, max, .. } = node.cell.density;
        let null = self.sigma_t * (max - min) * (end - start) as f32;
        match node.children {
            Some(children) if null >= WORTH => {
                let children = &self.children[children as usize];
                self.descend(children, corner, level, line, [start, end], visit)
            }
            _ => visit(start, end, &node.cell),
        }
    }

    /// Amanatides & Woo (1987) through the children of a node. The stretches join without a gap.
    fn descend(
        &self,
        children: &Children,
        corner: [f64; 3],
        level: u32,
        line: &Line,
        [start, end]: [f64; 2],
        visit: &mut impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let edge = f64::from(EDGE.pow(level - 1));
        let mut axes = [0, 1, 2].map(|i| {
            let last = ((self.count[i] - corner[i]) / edge).ceil() as i32 - 1;
            Axis::new(line, i, corner[i], edge, last.min(EDGE - 1), start)
        });
        let mut t = start;
        loop {
            let next = nearest(&axes);
            let leave = axes[next].exit.max(t).min(end);
            if leave > t
                && let Some(child) = children.find([0, 1, 2].map(|i| axes[i].at))
            {
                let child = &self.nodes[child as usize];
                let corner = [0, 1, 2].map(|i| corner[i] + edge * f64::from(axes[i].at));
                self.cross(child, corner, level - 1, line, [t, leave], visit)?;
            }
            if axes[next].exit >= end {
                return ControlFlow::Continue(());
            }
            t = leave;
            axes[next].advance();
        }
    }
}

/// A ray in units of cells.
struct Line {
    origin: [f64; 3],
    direction: [f64; 3],
    inverse: [f64; 3],
}

impl Line {
    fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin: origin.to_array(),
            direction: direction.to_array(),
            inverse: direction.recip().to_array(),
        }
    }

    /// The part of a stretch inside the cube of this edge.
    fn through(&self, edge: f64, [mut start, mut end]: [f64; 2]) -> Option<[f64; 2]> {
        for i in 0..3 {
            let [a, b] = [0.0, edge].map(|plane| plane - self.origin[i]);
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

/// One axis of a walk through the children of a node.
#[derive(Clone, Copy)]
struct Axis {
    /// The child.
    at: i32,
    /// Distance along the ray at which it ends; infinite for the last.
    exit: f64,
    /// Distance from one child's end to the next's.
    step: f64,
    /// Children after this one.
    left: i32,
    /// To the next.
    sign: i32,
}

impl Axis {
    #[inline]
    fn new(line: &Line, i: usize, corner: f64, edge: f64, last: i32, start: f64) -> Self {
        let (origin, inverse) = (line.origin[i] - corner, line.inverse[i]);
        // A negative or NaN position becomes 0 in the conversion.
        let inside = (origin + start * line.direction[i]) / edge;
        let at = (inside as i32).clamp(0, last);
        let forward = line.direction[i] > 0.0;
        let left = match forward {
            _ if inverse.is_infinite() => 0,
            true => last - at,
            false => at,
        };
        let plane = edge * f64::from(at + i32::from(forward));
        Self {
            at,
            exit: if left == 0 {
                f64::INFINITY
            } else {
                (plane - origin) * inverse
            },
            step: edge * inverse.abs(),
            left,
            sign: if forward { 1 } else { -1 },
        }
    }

    #[inline]
    fn advance(&mut self) {
        self.at += self.sign;
        self.left -= 1;
        self.exit = if self.left == 0 {
            f64::INFINITY
        } else {
            self.exit + self.step
        };
    }
}

/// The axis of the smallest distance.
#[inline]
fn nearest(axes: &[Axis; 3]) -> usize {
    let first = if axes[1].exit < axes[0].exit { 1 } else { 0 };
    if axes[2].exit < axes[first].exit {
        2
    } else {
        first
    }
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
    fn divide(&self, tree: &mut Majorants, node: usize, first: IVec3, level: u32) {
        let Cell { density, rate } = tree.nodes[node].cell;
        if level == 0 || (density.min == density.max && rate == 0.0) {
            return;
        }
        let start = tree.nodes.len();
        let edge = EDGE.pow(level - 1);
        let mut children = Children {
            present: [0; 64],
            first: [0; 64],
        };
        let mut origins = Vec::new();
        for i in 0..EDGE.pow(3) {
            let at = IVec3::new(i / (EDGE * EDGE), i / EDGE % EDGE, i % EDGE);
            let column = (i / EDGE) as usize;
            if at.z == 0 {
                children.first[column] = tree.nodes.len() as u32;
            }
            let first = first + edge * at;
            if let Some(cell) = self.cell(first, level - 1) {
                children.present[column] |= 1 << at.z;
                tree.nodes.push(Node {
                    cell,
                    children: None,
                });
                origins.push(first);
            }
        }
        tree.nodes[node].children = Some(tree.children.len() as u32);
        tree.children.push(children);
        for (i, first) in origins.into_iter().enumerate() {
            self.divide(tree, start + i, first, level - 1);
        }
    }
}
