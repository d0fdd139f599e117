//! The nodes of a grid, as files have them.

use super::values::Values;
use crate::volume::open_vdb::mask;
use crate::volume::open_vdb::tree::{LEAF_WORDS, LOWER, Level, ROOT_EDGE, UPPER};
use glam::IVec3;
use std::collections::BTreeMap;
use tyndall_core::Spectrum;
use tyndall_media::{Piece, SparseGrid, Tile};

/// A node; what it holds by slot.
#[derive(Default)]
struct Node<T, C> {
    children: BTreeMap<usize, C>,
    tiles: Vec<(usize, Tile<T>)>,
}

#[derive(Clone, Copy, Default)]
struct Leaf {
    number: u32,
    active: [u64; LEAF_WORDS],
}

type Lower<T> = Node<T, Leaf>;
type Upper<T> = Node<T, Lower<T>>;

/// All nodes of a grid.
pub(super) struct Nodes<'g, T> {
    grid: &'g SparseGrid<T>,
    tiles: Vec<(IVec3, Tile<T>)>,
    uppers: BTreeMap<[i32; 3], Upper<T>>,
}

impl<'g, T: Spectrum> Nodes<'g, T> {
    pub(super) fn of(grid: &'g SparseGrid<T>) -> Self {
        let (mut tiles, mut uppers) = (Vec::new(), BTreeMap::<_, Upper<T>>::new());
        grid.visit(|origin, piece| {
            let edge = match piece {
                Piece::Tile { edge, .. } => edge,
                Piece::Leaf { .. } => 1 << LOWER.edge,
            };
            if let (true, Piece::Tile { tile, .. }) = (edge == 1 << ROOT_EDGE, piece) {
                tiles.push((origin, tile));
                return;
            }
            let root = origin & !((1 << ROOT_EDGE) - 1);
            let upper = uppers.entry(root.to_array()).or_default();
            let slot = UPPER.slot(origin);
            if let (true, Piece::Tile { tile, .. }) = (edge == 1 << UPPER.edge, piece) {
                upper.tiles.push((slot, tile));
                return;
            }
            let lower = upper.children.entry(slot).or_default();
            let slot = LOWER.slot(origin);
            match piece {
                Piece::Tile { tile, .. } => lower.tiles.push((slot, tile)),
                Piece::Leaf { leaf, active } => {
                    let (number, active) = (leaf, *active);
                    lower.children.insert(slot, Leaf { number, active });
                }
            }
        });
        Self {
            grid,
            tiles,
            uppers,
        }
    }

    /// The background and the values of all tiles.
    pub(super) fn constants(&self) -> impl Iterator<Item = T> + '_ {
        let lowers = || {
            self.uppers
                .values()
                .flat_map(|upper| upper.children.values())
        };
        let uppers = self.uppers.values().flat_map(|upper| &upper.tiles);
        let slots = uppers.chain(lowers().flat_map(|lower| &lower.tiles));
        let roots = self.tiles.iter().map(|(_, tile)| tile.value);
        std::iter::once(self.grid.background())
            .chain(roots)
            .chain(slots.map(|(_, tile)| tile.value))
    }

    fn leaves(&self) -> impl Iterator<Item = &Leaf> {
        let lowers = self
            .uppers
            .values()
            .flat_map(|upper| upper.children.values());
        lowers.flat_map(|lower| lower.children.values())
    }

    /// Writes nodes, tiles and the masks of leaves.
    pub(super) fn write_topology(&self, out: &mut Values<T>) {
        out.words(&[1]);
        out.value(self.grid.background());
        out.words(&[self.tiles.len() as u32, self.uppers.len() as u32]);
        for (origin, tile) in &self.tiles {
            out.origin(origin.to_array());
            out.value(tile.value);
            out.flag(tile.active);
        }
        for (origin, upper) in &self.uppers {
            out.origin(*origin);
            self.write_node(upper, UPPER, out);
            for lower in upper.children.values() {
                self.write_node(lower, LOWER, out);
                for leaf in lower.children.values() {
                    out.mask(&leaf.active);
                }
            }
        }
    }

    fn write_node<C>(&self, node: &Node<T, C>, level: Level, out: &mut Values<T>) {
        let words = level.count() / 64;
        let children = mask::of(words, |slot| node.children.contains_key(&slot));
        let mut values = vec![self.grid.background(); level.count()];
        let mut active = vec![0; words];
        for (slot, tile) in &node.tiles {
            values[*slot] = tile.value;
            active[slot / 64] |= u64::from(tile.active) << (slot % 64);
        }
        out.mask(&children);
        out.mask(&active);
        out.values(&values, &active);
    }

    /// Writes the voxels of all leaves.
    pub(super) fn write_voxels(&self, out: &mut Values<T>) {
        let mut values = Vec::new();
        for leaf in self.leaves() {
            values.clear();
            values.extend(self.grid.leaf_values(leaf.number));
            out.mask(&leaf.active);
            out.values(&values, &leaf.active);
        }
    }
}
