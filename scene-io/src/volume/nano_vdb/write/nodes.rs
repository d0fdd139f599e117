//! Lays the nodes of a grid out: breadth first, one level after the other.

use super::super::layout::{Layout, NodeLayout, ROOT_TILES, grid, kind_of, leaf, tile, tree};
use super::super::summary::Summary;
use super::super::tree::key_of;
use super::buffer::Buffer;
use crate::volume::level::ROOT_EDGE;
use crate::volume::skeleton::{Leaf, Node, Skeleton, Slot};
use glam::IVec3;
use tyndall_core::Spectrum;
use tyndall_media::SparseGrid;

/// The node has active voxels, and so a box.
const HAS_BOX: u32 = 2;
/// It has none: renderers may pass it by.
const EMPTY: u32 = 1;
/// First and last voxel where there is none.
pub(super) const EMPTY_BOX: [IVec3; 2] = [IVec3::MAX, IVec3::MIN];

/// Where the nodes of a grid begin in its buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    /// Leaves, lower nodes, upper nodes.
    pub(super) levels: [u64; 3],
    pub(super) root: u64,
    pub(super) end: u64,
}

impl Places {
    fn of<T: Spectrum>(skeleton: &Skeleton<'_, T>, layout: Layout) -> Self {
        let counts = skeleton.counts().map(|n| n as u64);
        let size = |level| layout.node(level).size as u64;
        let root = (grid::END + tree::SIZE) as u64;
        let uppers = root + (layout.root() + layout.tile() * skeleton.root.len()) as u64;
        let lowers = uppers + size(2) * counts[2];
        let leaves = lowers + size(1) * counts[1];
        Self {
            levels: [leaves, lowers, uppers],
            root,
            end: leaves + layout.leaf() as u64 * counts[0],
        }
    }
}

/// The buffer of a grid without its header, where things stand in it, and what they hold.
pub(super) fn lay_out<T: Spectrum>(
    grid: &SparseGrid<T>,
    skeleton: &Skeleton<'_, T>,
    layout: Layout,
) -> Result<(Buffer, Places, Summary<T>), String> {
    let places = Places::of(skeleton, layout);
    let mut writer = Writer {
        grid,
        layout,
        places,
        buffer: Buffer::new(places.end)?,
    };
    let leaves = skeleton.leaves.iter().enumerate();
    let mut below: Vec<_> = leaves.map(|(i, leaf)| writer.leaf(i, leaf)).collect();
    for level in [1, 2] {
        let nodes = skeleton.nodes[level - 1].iter().enumerate();
        below = (nodes.map(|(i, node)| writer.node(level, i, node, &below))).collect();
    }
    let summary = writer.root(&skeleton.root, &below);
    Ok((writer.buffer, places, summary))
}

struct Writer<'a, T> {
    grid: &'a SparseGrid<T>,
    layout: Layout,
    places: Places,
    buffer: Buffer,
}

impl<T: Spectrum> Writer<'_, T> {
    /// The place of a leaf or node, by its level and its number in it.
    fn place(&self, level: usize, i: usize) -> u64 {
        let size = match level {
            0 => self.layout.leaf(),
            _ => self.layout.node(level).size,
        };
        self.places.levels[level] + (size * i) as u64
    }

    fn leaf(&mut self, i: usize, leaf: &Leaf<'_>) -> Summary<T> {
        let at = self.place(0, i) as usize;
        let mut summary = Summary::new();
        let (values, size) = (at + self.layout.leaf_values(), self.layout.value());
        for (i, value) in self.grid.leaf_values(leaf.number).enumerate() {
            let place = values + size * i;
            self.buffer.put_value(place, value);
            if leaf.active[i / 64] >> (i % 64) & 1 == 1 {
                let voxel = IVec3::new(i as i32 >> 6, i as i32 >> 3 & 7, i as i32 & 7);
                summary.add(&Summary::cube(leaf.origin + voxel, 1, value));
            }
        }
        for (i, word) in leaf.active.iter().enumerate() {
            self.buffer
                .put_u64(at + leaf::MASK + size_of_val(word) * i, *word);
        }
        // A leaf without a box has its origin in the place of one.
        let [first, last] = summary.bounds.unwrap_or([leaf.origin; 2]);
        self.buffer.put_voxel(at, first);
        let extent = (last - first).to_array().map(|x| x as u8);
        self.buffer.put(at + leaf::EXTENT, &extent);
        let flags = if summary.voxels > 0 { HAS_BOX } else { EMPTY };
        self.buffer.put(at + leaf::FLAGS, &[flags as u8]);
        self.statistics(at + leaf::STATISTICS, &summary);
        summary
    }

    fn node(&mut self, level: usize, i: usize, node: &Node<T>, below: &[Summary<T>]) -> Summary<T> {
        let (kind, layout) = (kind_of(level), self.layout.node(level));
        let at = self.place(level, i) as usize;
        for slot in 0..layout.slots {
            let place = at + layout.table + layout.stride * slot;
            self.buffer.put_value(place, self.grid.background());
        }
        let mut summary = Summary::new();
        for &(slot, content) in &node.slots {
            let place = at + layout.table + layout.stride * slot;
            match content {
                Slot::Child(child) => {
                    let offset = self.place(level - 1, child) - at as u64;
                    self.buffer.put_u64(place, offset);
                    self.buffer.set_bit(at + layout.child_mask, slot);
                    summary.add(&below[child]);
                }
                Slot::Tile(tile) => {
                    self.buffer.put_value(place, tile.value);
                    if tile.active {
                        self.buffer.set_bit(at + NodeLayout::VALUE_MASK, slot);
                        let origin = node.origin + kind.origin(slot);
                        summary.add(&Summary::cube(origin, 1 << kind.edge, tile.value));
                    }
                }
            }
        }
        // Readers find its origin by the first corner of its box, even of an empty one.
        let edge = 1 << kind.node_edge();
        let empty = [node.origin + (edge - 1), node.origin];
        let bounds = summary.bounds.unwrap_or(empty);
        self.buffer.put_box(at, bounds);
        let flags = if summary.voxels > 0 { HAS_BOX } else { EMPTY };
        self.buffer.put_u64(at + NodeLayout::FLAGS, flags.into());
        self.statistics(at + layout.statistics, &summary);
        summary
    }

    fn root(&mut self, tiles: &[(IVec3, Slot<T>)], uppers: &[Summary<T>]) -> Summary<T> {
        let at = self.places.root as usize;
        let mut summary = Summary::new();
        for (i, (origin, content)) in tiles.iter().enumerate() {
            let here = at + self.layout.root() + self.layout.tile() * i;
            self.buffer.put_u64(here + tile::KEY, key_of(*origin));
            match *content {
                Slot::Child(child) => {
                    let offset = self.place(2, child) - self.places.root;
                    self.buffer.put_u64(here + tile::CHILD, offset);
                    summary.add(&uppers[child]);
                }
                Slot::Tile(content) => {
                    let value = here + self.layout.tile_value();
                    self.buffer.put_value(value, content.value);
                    self.buffer
                        .put_u32(here + tile::ACTIVE, content.active.into());
                    if content.active {
                        summary.add(&Summary::cube(*origin, 1 << ROOT_EDGE, content.value));
                    }
                }
            }
        }
        self.buffer.put_box(at, summary.bounds.unwrap_or(EMPTY_BOX));
        self.buffer.put_u32(at + ROOT_TILES, tiles.len() as u32);
        let background = at + self.layout.background();
        self.buffer.put_value(background, self.grid.background());
        self.statistics(background + self.layout.value(), &summary);
        summary
    }

    /// Those of no voxel are the background's.
    fn statistics(&mut self, at: usize, summary: &Summary<T>) {
        let background = self.grid.background();
        let [min, max] = summary.extremes().unwrap_or([background; 2]);
        self.buffer.put_value(at, min);
        self.buffer.put_value(at + self.layout.value(), max);
        self.buffer
            .put_f32s(at + 2 * self.layout.value(), &summary.moments());
    }
}
