//! Makes trees of bounds.

use super::{Cell, Children, EDGE, LOG2, Majorants, Node, WORTH};
use crate::field::{Cells, MOST_CELLS, Region};
use glam::{DAffine3, DVec3, IVec3};
use std::collections::VecDeque;

/// How large a tree may grow, in nodes of which one with children counts for many more (it has 1 kB);
/// what is below then goes without bounds of its own. Half a gigabyte.
const MOST: usize = 1 << 24;
const PARENT: usize = 36;

impl Majorants {
    /// `describe` looks at a region, a cell or larger; `None` if it is empty.
    pub(crate) fn new(
        cells: Cells,
        sigma_t: f32,
        describe: impl Fn(&Region, bool) -> Option<Cell>,
    ) -> Self {
        let last = cells.size.ceil().min(DVec3::splat(MOST_CELLS)).as_ivec3() - 1;
        let longest = last.max_element().max(0) as u32 + 1;
        let levels = longest.next_power_of_two().ilog2().div_ceil(LOG2);
        let mut majorants = Self {
            to_cells: cells.to_world.inverse(),
            size: cells.size,
            last: last.to_array(),
            levels,
            diagonals: Vec::new(),
            nodes: Vec::new(),
            children: Vec::new(),
            sigma_t,
        };
        let maker = Maker {
            to_world: cells.to_world,
            last,
            describe,
        };
        let diagonals = (0..=levels).map(|level| maker.region(IVec3::ZERO, level).diagonal());
        majorants.diagonals = diagonals.map(|length| length as f32).collect();
        if let Some(cell) = maker.cell(IVec3::ZERO, levels) {
            majorants.nodes.push(Node {
                cell,
                children: None,
            });
            maker.divide(&mut majorants);
        }
        majorants
    }
}

struct Maker<F> {
    to_world: DAffine3,
    last: IVec3,
    describe: F,
}

impl<F: Fn(&Region, bool) -> Option<Cell>> Maker<F> {
    /// The cube of 8^`level` cells along each edge from `first` on.
    fn region(&self, first: IVec3, level: u32) -> Region {
        let place = DAffine3::from_translation(first.as_dvec3());
        let scale = DAffine3::from_scale(DVec3::splat(f64::from(EDGE.pow(level))));
        Region {
            to_world: self.to_world * place * scale,
        }
    }

    /// What is known of a cube; `None` if it is empty.
    fn cell(&self, first: IVec3, level: u32) -> Option<Cell> {
        let inside = first.cmple(self.last).all();
        (inside.then(|| self.region(first, level))).and_then(|r| (self.describe)(&r, level == 0))
    }

    /// Gives all nodes the children that a ray through them may be worth, from the root down.
    fn divide(&self, tree: &mut Majorants) {
        let mut open = VecDeque::from([(0, IVec3::ZERO, tree.levels)]);
        while let Some((node, first, level)) = open.pop_front() {
            let Cell {
                density, uneven, ..
            } = tree.nodes[node].cell;
            let null = tree.sigma_t * (density.max - density.min) * tree.diagonals[level as usize];
            if level == 0 || !(null >= WORTH || uneven) {
                continue;
            }
            if tree.nodes.len() + PARENT * tree.children.len() > MOST {
                return;
            }
            let start = tree.nodes.len();
            let origins = self.add_children(tree, node, first, level);
            let children = origins.into_iter().enumerate();
            open.extend(children.map(|(i, first)| (start + i, first, level - 1)));
        }
    }

    /// Gives a node its children; returns where these begin.
    fn add_children(
        &self,
        tree: &mut Majorants,
        node: usize,
        first: IVec3,
        level: u32,
    ) -> Vec<IVec3> {
        let before = tree.nodes.len() as u32 - 1;
        let edge = EDGE.pow(level - 1);
        let mut places = [0; 512];
        let mut origins = Vec::new();
        for (i, place) in (0..).zip(&mut places) {
            let at = IVec3::new(i / (EDGE * EDGE), i / EDGE % EDGE, i % EDGE);
            let first = first + edge * at;
            if let Some(cell) = self.cell(first, level - 1) {
                tree.nodes.push(Node {
                    cell,
                    children: None,
                });
                origins.push(first);
                *place = origins.len() as u16;
            }
        }
        tree.nodes[node].children = Some(tree.children.len() as u32);
        tree.children.push(Children { places, before });
        origins
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Range;

    fn nodes(cells: f64, describe: impl Fn([DVec3; 2]) -> Option<Cell>) -> usize {
        let cells = Cells {
            to_world: DAffine3::IDENTITY,
            size: DVec3::splat(cells),
        };
        let of_region = |region: &Region, _| describe(region.bounds_in(&DAffine3::IDENTITY));
        Majorants::new(cells, 1.0, of_region).nodes.len()
    }

    fn cell(min: f32, max: f32, uneven: bool) -> Option<Cell> {
        let mean = 0.5 * (min + max);
        let density = Range { min, max, mean };
        let rate = f32::from(uneven);
        Some(Cell {
            density,
            rate,
            uneven,
        })
    }

    #[test]
    fn what_no_ray_looks_into_is_not_there() {
        // An even glow without density; densities that differ by less than is worth a step.
        assert_eq!(nodes(2048.0, |_| cell(0.0, 0.0, false)), 1);
        assert_eq!(nodes(64.0, |_| cell(1.0, 1.002, false)), 1);
    }

    #[test]
    fn a_small_flame_far_away_has_few_nodes() {
        let flame = DVec3::splat(1e9);
        let describe = |[min, max]: [DVec3; 2]| {
            let here = min.cmple(flame).all() && flame.cmplt(max).all();
            here.then(|| cell(0.0, 0.0, true)).flatten()
        };
        assert_eq!(nodes(f64::from(1 << 30), describe), 11);
    }

    #[test]
    fn trees_that_would_grow_for_ever_stop() {
        let count = nodes(f64::from(1 << 30), |_| cell(0.0, 1.0, false));
        assert!(count < MOST + 512 && count > MOST / 2, "{count}");
    }
}
