//! Writes the nodes of a grid.

use super::values::Values;
use crate::volume::level::{LOWER, Level, UPPER};
use crate::volume::skeleton::{Node, Skeleton, Slot};
use glam::IVec3;
use tyndall_core::Spectrum;
use tyndall_media::{SparseGrid, Tile};

/// All nodes of a grid.
pub(super) struct Nodes<'g, T> {
    grid: &'g SparseGrid<T>,
    skeleton: Skeleton<'g, T>,
}

impl<'g, T: Spectrum> Nodes<'g, T> {
    pub(super) fn of(grid: &'g SparseGrid<T>) -> Self {
        let skeleton = Skeleton::of(grid);
        Self { grid, skeleton }
    }

    /// The background and the values of all tiles.
    pub(super) fn constants(&self) -> impl Iterator<Item = T> + '_ {
        let nodes = self.skeleton.nodes.iter().flatten();
        let slots = nodes.flat_map(|node| node.slots.iter().map(|(_, content)| content));
        let root = self.skeleton.root.iter().map(|(_, content)| content);
        let tiles = slots.chain(root).filter_map(|content| match content {
            Slot::Tile(tile) => Some(tile.value),
            Slot::Child(_) => None,
        });
        std::iter::once(self.grid.background()).chain(tiles)
    }

    /// Writes nodes, tiles and the masks of leaves.
    pub(super) fn write_topology(&self, out: &mut Values<T>) {
        let root = &self.skeleton.root;
        let tiles: Vec<(IVec3, Tile<T>)> = (root.iter())
            .filter_map(|(origin, content)| match content {
                Slot::Tile(tile) => Some((*origin, *tile)),
                Slot::Child(_) => None,
            })
            .collect();
        out.words(&[1]);
        out.value(self.grid.background());
        out.words(&[tiles.len() as u32, (root.len() - tiles.len()) as u32]);
        for (origin, tile) in tiles {
            out.origin(origin.to_array());
            out.value(tile.value);
            out.flag(tile.active);
        }
        for (origin, content) in root {
            if let Slot::Child(upper) = content {
                out.origin(origin.to_array());
                self.write_upper(&self.skeleton.nodes[1][*upper], out);
            }
        }
    }

    fn write_upper(&self, upper: &Node<T>, out: &mut Values<T>) {
        self.write_node(upper, UPPER, out);
        for lower in upper.children() {
            let lower = &self.skeleton.nodes[0][lower];
            self.write_node(lower, LOWER, out);
            for leaf in lower.children() {
                out.mask(self.skeleton.leaves[leaf].active);
            }
        }
    }

    fn write_node(&self, node: &Node<T>, level: Level, out: &mut Values<T>) {
        let (mut children, mut active) = (vec![0; level.count() / 64], vec![0; level.count() / 64]);
        let mut values = vec![self.grid.background(); level.count()];
        for &(slot, content) in &node.slots {
            let bit = 1_u64 << (slot % 64);
            match content {
                Slot::Child(_) => children[slot / 64] |= bit,
                Slot::Tile(tile) => {
                    values[slot] = tile.value;
                    active[slot / 64] |= if tile.active { bit } else { 0 };
                }
            }
        }
        out.mask(&children);
        out.mask(&active);
        out.values(&values, &active);
    }

    /// Writes the voxels of all leaves, which lie in the order of their masks.
    pub(super) fn write_voxels(&self, out: &mut Values<T>) {
        let mut values = Vec::new();
        for leaf in &self.skeleton.leaves {
            values.clear();
            values.extend(self.grid.leaf_values(leaf.number));
            out.mask(leaf.active);
            out.values(&values, leaf.active);
        }
    }
}
