//! Bounds of the extinction along a ray.
//!
//! A tree of cubes over the cells of a field ([`Field::cells`](crate::Field::cells)): a node has
//! 8³ children, empty ones are not stored, and each knows the bounds of all below. A ray walks the
//! children of a node it meets, and theirs, and passes what is empty in one step, however large
//! (Museth 2014, "Hierarchical Digital Differential Analyzer for Efficient Ray-Marching in OpenVDB").

mod build;

use crate::field::Range;
use glam::{DAffine3, DVec3};
use std::fmt::{self, Debug, Formatter};
use std::ops::ControlFlow;
use tyndall_core::{Aabb, Ray};

/// Children along an edge of a node, and their logarithm.
const EDGE: i32 = 8;
const LOG2: u32 = 3;
/// The bits of a child's slot, of which x has the highest.
const SLOTS: i32 = (1 << (3 * LOG2)) - 1;
/// A node is crossed at once if that costs fewer null collisions than this: about what a step of
/// the walk takes.
const WORTH: f32 = 0.25;

/// How far a ray along an outermost face may be off by rounding, relative to the size of all cells.
const ROUNDING: f64 = 1e-12;

/// What is known of a region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Of the density.
    pub(crate) density: Range<f32>,
    /// Where light is emitted, how many collisions per unit of length emission asks for.
    pub(crate) rate: f32,
    /// Whether emission is much larger in a part than on the whole.
    pub(crate) uneven: bool,
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
    /// For each, by its slot: its place among those that are not empty, from 1 on; 0 if it is.
    places: [u16; 512],
    /// The number before that of the first; they lie together.
    before: u32,
}

impl Children {
    #[inline]
    fn find(&self, slot: i32) -> Option<u32> {
        match self.places[(slot & SLOTS) as usize] {
            0 => None,
            place => Some(self.before + u32::from(place)),
        }
    }
}

/// A tree of bounds.
#[derive(Clone)]
pub(crate) struct Majorants {
    /// From space into units of cells, from the first one.
    to_cells: DAffine3,
    /// How many there are, the last maybe in part.
    size: DVec3,
    /// The last along each axis; a ray along the outermost face belongs to it.
    last: [i32; 3],
    /// Nodes above the cells.
    levels: u32,
    /// The longest way through a cell, and through a node of each level.
    diagonals: Vec<f32>,
    /// The root first; none if all is empty.
    nodes: Vec<Node>,
    children: Vec<Children>,
    /// Extinction where the density is 1, of the channel where it is largest.
    sigma_t: f32,
}

impl Debug for Majorants {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Majorants")
            .field("nodes", &self.nodes.len())
            .finish_non_exhaustive()
    }
}

impl Majorants {
    /// A bound of ∫ σt dt along any ray inside these bounds, in the channel where it is largest.
    pub(crate) fn depth(&self, bounds: Aabb) -> f32 {
        self.nodes.first().map_or(0.0, |root| {
            let whole = self.sigma_t * root.cell.density.max * bounds.size().length();
            whole.min(self.depth_of(root, self.levels))
        })
    }

    /// Through a node: along its diagonal, or through all its children, along theirs.
    fn depth_of(&self, node: &Node, level: u32) -> f32 {
        let whole = self.sigma_t * node.cell.density.max * self.diagonals[level as usize];
        let Some(children) = node.children else {
            return whole;
        };
        let Children { places, before } = &self.children[children as usize];
        let count = u32::from(*places.iter().max().unwrap_or(&0));
        let children = &self.nodes[*before as usize + 1..][..count as usize];
        let each = children.iter().map(|child| self.depth_of(child, level - 1));
        whole.min(each.sum())
    }

    /// Visits the stretches of the ray that are not empty, in order: as fine as the bounds of the
    /// density are worth, and with `glow` also where emission is uneven.
    #[inline]
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        glow: bool,
        mut visit: impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(root) = self.nodes.first() else {
            return ControlFlow::Continue(());
        };
        let line = Line::new(
            self.to_cells.transform_point3(ray.origin.as_dvec3()),
            self.to_cells.transform_vector3(ray.direction.as_dvec3()),
            glow,
        );
        match line.through(self.size.to_array(), ray.t_max.into()) {
            Some(span) => self.cross(root, [0; 3], self.levels, &line, span, &mut visit),
            None => ControlFlow::Continue(()),
        }
    }

    /// Visits a node as a whole or its children.
    #[inline]
    fn cross(
        &self,
        node: &Node,
        corner: [i32; 3],
        level: u32,
        line: &Line,
        span: [f64; 2],
        visit: &mut impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let [start, end] = span;
        let Range { min, max, .. } = node.cell.density;
        let null = self.sigma_t * (max - min) * (end - start) as f32;
        match node.children {
            Some(children) if null >= WORTH || (line.glow && node.cell.uneven) => {
                let children = &self.children[children as usize];
                if level > 1 {
                    return self.descend(children, corner, level, line, span, visit);
                }
                self.each(
                    children,
                    corner,
                    level,
                    line,
                    span,
                    |cell, _, [enter, leave]| visit(enter, leave, &cell.cell),
                )
            }
            _ => visit(start, end, &node.cell),
        }
    }

    /// Visits what is below the children of a node.
    fn descend(
        &self,
        children: &Children,
        corner: [i32; 3],
        level: u32,
        line: &Line,
        span: [f64; 2],
        visit: &mut impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        self.each(
            children,
            corner,
            level,
            line,
            span,
            |child, corner, span| self.cross(child, corner, level - 1, line, span, visit),
        )
    }

    /// Amanatides & Woo (1987) through the children of a node. The stretches join without a gap.
    #[inline(always)]
    fn each(
        &self,
        children: &Children,
        corner: [i32; 3],
        level: u32,
        line: &Line,
        [start, end]: [f64; 2],
        mut visit: impl FnMut(&Node, [i32; 3], [f64; 2]) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let shift = (level - 1) * LOG2;
        let mut steps = Steps::new(line, corner, shift, self.last, start);
        let mut t = start;
        loop {
            let next = nearest(steps.exit);
            let exit = steps.exit[next];
            let leave = if exit < end { exit } else { end };
            if leave > t {
                if let Some(child) = children.find(steps.slot) {
                    let corner = steps.corner(corner, shift);
                    visit(&self.nodes[child as usize], corner, [t, leave])?;
                }
                t = leave;
            }
            if exit >= end {
                return ControlFlow::Continue(());
            }
            steps.advance(next);
        }
    }
}

/// A ray in units of cells.
struct Line {
    origin: [f64; 3],
    direction: [f64; 3],
    inverse: [f64; 3],
    /// Whether emission counts.
    glow: bool,
}

impl Line {
    fn new(origin: DVec3, direction: DVec3, glow: bool) -> Self {
        Self {
            glow,
            origin: origin.to_array(),
            direction: direction.to_array(),
            inverse: direction.recip().to_array(),
        }
    }

    /// The part inside the box of this size. No number here is NaN, for which `f64::min` is slow.
    #[inline]
    fn through(&self, size: [f64; 3], t_max: f64) -> Option<[f64; 2]> {
        let (mut start, mut end) = (0.0_f64, t_max);
        for (i, size) in size.into_iter().enumerate() {
            let [a, b] = [0.0, size].map(|plane| plane - self.origin[i]);
            if self.inverse[i].is_infinite() {
                // A face is inside, though it be off by rounding.
                if a > ROUNDING * size || b < -ROUNDING * size {
                    return None;
                }
            } else {
                let (a, b) = (a * self.inverse[i], b * self.inverse[i]);
                let (near, far) = if a < b { (a, b) } else { (b, a) };
                start = if near > start { near } else { start };
                end = if far < end { far } else { end };
            }
        }
        (start < end).then_some([start, end])
    }
}

/// A walk through the children of a node, axis by axis.
struct Steps {
    /// The child.
    slot: i32,
    /// Distance along the ray at which it ends; infinite for the last.
    exit: [f64; 3],
    /// Distance from one child's end to the next's.
    step: [f64; 3],
    /// Children after this one.
    left: [i32; 3],
    /// From its slot to the next's.
    stride: [i32; 3],
}

impl Steps {
    #[inline(always)]
    fn new(line: &Line, corner: [i32; 3], shift: u32, last: [i32; 3], start: f64) -> Self {
        let edge = f64::from(1 << shift);
        let mut steps = Self {
            slot: 0,
            exit: [f64::INFINITY; 3],
            step: line.inverse.map(|inverse| edge * inverse.abs()),
            left: [0; 3],
            stride: [EDGE * EDGE, EDGE, 1],
        };
        for i in 0..3 {
            let origin = line.origin[i] - f64::from(corner[i]);
            let last = ((last[i] - corner[i]) >> shift).min(EDGE - 1);
            // A negative or NaN position becomes 0 in the conversion.
            let inside = (origin + start * line.direction[i]) as i32;
            let at = (inside >> shift).max(0).min(last);
            steps.slot += at * steps.stride[i];
            if line.inverse[i].is_infinite() {
                continue;
            }
            let forward = line.direction[i] > 0.0;
            steps.left[i] = if forward { last - at } else { at };
            if steps.left[i] > 0 {
                let plane = edge * f64::from(at + i32::from(forward));
                steps.exit[i] = (plane - origin) * line.inverse[i];
            }
            if !forward {
                steps.stride[i] = -steps.stride[i];
            }
        }
        steps
    }

    /// The first cell of the child, in a node whose first is `node`.
    #[inline]
    fn corner(&self, node: [i32; 3], shift: u32) -> [i32; 3] {
        let at = |i: usize| (self.slot >> (LOG2 * (2 - i as u32))) & (EDGE - 1);
        [0, 1, 2].map(|i| node[i] + (at(i) << shift))
    }

    #[inline]
    fn advance(&mut self, axis: usize) {
        self.slot += self.stride[axis];
        self.left[axis] -= 1;
        self.exit[axis] = if self.left[axis] == 0 {
            f64::INFINITY
        } else {
            self.exit[axis] + self.step[axis]
        };
    }
}

/// The axis of the smallest distance.
#[inline]
fn nearest(exit: [f64; 3]) -> usize {
    let first = usize::from(exit[1] < exit[0]);
    if exit[2] < exit[first] { 2 } else { first }
}
