//! Voxels in the hierarchy of OpenVDB (Museth 2013, "VDB: High-Resolution Sparse Volumes with
//! Dynamic Topology"), in its usual form 5-4-3: a root of any size over nodes of 32³ slots over nodes
//! of 16³ slots over leaves of 8³ voxels. A slot holds a child or one value, a tile. Read-only and
//! packed: children lie together in the order of their slots, and slots at the background cost a bit.

use super::leaves::Leaves;
use super::mask::{Mask, bits};
use crate::field::{Gather, Range};
use glam::IVec3;
use tyndall_core::Spectrum;

/// Voxels along the edge of a leaf.
pub(crate) const LEAF: i32 = 8;
/// Voxels along the edge of what a slot of each kind of node holds: leaf, lower, upper.
pub(crate) const EDGES: [i32; 3] = [LEAF, 128, 4096];

/// One value for all voxels of a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile<T> {
    /// The value of every voxel.
    pub value: T,
    /// Whether they count as active.
    pub active: bool,
}

/// A node of 64·W slots.
#[derive(Clone, Debug)]
pub(super) struct Node<T, const W: usize> {
    pub(super) children: Mask<W>,
    pub(super) first_child: u32,
    pub(super) tiled: Mask<W>,
    pub(super) tiles: Box<[Tile<T>]>,
    /// Of all voxels below, the background's too.
    pub(super) range: Range<T>,
}

/// Slots of 4096³ voxels, in order of their origin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Root<T> {
    Node(u32),
    Tile(Tile<T>),
}

#[derive(Clone, Debug)]
pub(super) struct Tree<T> {
    pub(super) background: T,
    pub(super) roots: Vec<(IVec3, Root<T>)>,
    pub(super) uppers: Vec<Node<T, 512>>,
    pub(super) lowers: Vec<Node<T, 64>>,
    pub(super) leaves: Leaves<T>,
}

/// What holds a voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found<T> {
    /// A leaf, by its number.
    Leaf(u32),
    /// One value for all of the 8³ voxels around.
    Constant(T),
}

/// A part of a tree that is not background.
#[derive(Clone, Copy, Debug)]
pub enum Piece<'a, T> {
    /// 8³ voxels; the value of voxel (x, y, z) has the index 64·x + 8·y + z here and in the mask.
    Leaf {
        /// Its number, for [`super::SparseGrid::leaf_values`].
        leaf: u32,
        /// A bit for each active voxel.
        active: &'a [u64; 8],
    },
    /// `edge`³ voxels of one value.
    Tile {
        /// Voxels along an edge: 8, 128 or 4096.
        edge: i32,
        /// Their value.
        tile: Tile<T>,
    },
}

/// The slot of a node that holds a voxel: x slowest. `log2` of the slots and of the slot's edge.
#[inline]
pub(super) fn slot(ijk: IVec3, log2: i32, edge: i32) -> usize {
    let [x, y, z] = (ijk >> edge)
        .to_array()
        .map(|i| (i & ((1 << log2) - 1)) as usize);
    (x << (2 * log2)) | (y << log2) | z
}

/// Where the slot of a node begins, from the node's first voxel.
fn slot_origin(slot: usize, log2: i32, edge: i32) -> IVec3 {
    let mask = (1 << log2) - 1;
    let slot = slot as i32;
    IVec3::new(slot >> (2 * log2), (slot >> log2) & mask, slot & mask) << edge
}

pub(super) fn upper_slot(ijk: IVec3) -> usize {
    slot(ijk, 5, 7)
}

pub(super) fn lower_slot(ijk: IVec3) -> usize {
    slot(ijk, 4, 3)
}

/// The index of a voxel in its leaf.
#[inline]
pub(super) fn leaf_slot(ijk: IVec3) -> usize {
    slot(ijk, 3, 0)
}

/// The voxel of an index in a leaf, from its first one.
pub(super) fn leaf_voxel(slot: usize) -> IVec3 {
    slot_origin(slot, 3, 0)
}

impl<T: Spectrum> Tree<T> {
    /// What the root has for the 4096³ voxels around.
    #[inline]
    fn root(&self, ijk: IVec3) -> Option<Root<T>> {
        let origin = ijk & !(EDGES[2] - 1);
        match self.roots.as_slice() {
            [(only, root)] => (*only == origin).then_some(*root),
            roots => {
                let key = |(origin, _): &(IVec3, Root<T>)| origin.to_array();
                let i = roots.binary_search_by_key(&origin.to_array(), key).ok()?;
                Some(roots[i].1)
            }
        }
    }

    /// What holds a voxel.
    #[inline]
    pub(super) fn find(&self, ijk: IVec3) -> Found<T> {
        let upper = match self.root(ijk) {
            None => return Found::Constant(self.background),
            Some(Root::Tile(tile)) => return Found::Constant(tile.value),
            Some(Root::Node(upper)) => &self.uppers[upper as usize],
        };
        let lower = match upper.find(upper_slot(ijk), self.background) {
            Err(value) => return Found::Constant(value),
            Ok(lower) => &self.lowers[lower as usize],
        };
        match lower.find(lower_slot(ijk), self.background) {
            Err(value) => Found::Constant(value),
            Ok(leaf) => Found::Leaf(leaf),
        }
    }

    /// Visits every leaf and tile with its first voxel, in the order of the slots.
    pub(super) fn visit<'a>(&'a self, mut visit: impl FnMut(IVec3, Piece<'a, T>)) {
        for &(origin, root) in &self.roots {
            let upper = match root {
                Root::Node(upper) => &self.uppers[upper as usize],
                Root::Tile(tile) => {
                    let edge = EDGES[2];
                    visit(origin, Piece::Tile { edge, tile });
                    continue;
                }
            };
            for (slot, content) in upper.contents() {
                let origin = origin + slot_origin(slot, 5, 7);
                let lower = match content {
                    Ok(lower) => &self.lowers[lower as usize],
                    Err(tile) => {
                        let edge = EDGES[1];
                        visit(origin, Piece::Tile { edge, tile });
                        continue;
                    }
                };
                for (slot, content) in lower.contents() {
                    let origin = origin + slot_origin(slot, 4, 3);
                    let piece = match content {
                        Ok(leaf) => Piece::Leaf {
                            leaf,
                            active: self.leaves.active(leaf),
                        },
                        Err(tile) => Piece::Tile {
                            edge: EDGES[0],
                            tile,
                        },
                    };
                    visit(origin, piece);
                }
            }
        }
    }

    /// Bytes held, without what the allocator adds.
    pub(super) fn bytes(&self) -> usize {
        fn of<T, const W: usize>(nodes: &[Node<T, W>]) -> usize {
            let mask = W * (size_of::<u64>() + size_of::<u16>());
            let tiles = |n: &Node<T, W>| size_of_val::<[Tile<T>]>(&n.tiles);
            (nodes.iter().map(tiles).sum::<usize>())
                + nodes.len() * (size_of::<Node<T, W>>() + 2 * mask)
        }
        size_of_val::<[(IVec3, Root<T>)]>(&self.roots)
            + of(&self.uppers)
            + of(&self.lowers)
            + self.leaves.bytes()
    }
}

impl<T: Copy, const W: usize> Node<T, W> {
    /// The child in a slot, or else the value there.
    #[inline]
    fn find(&self, slot: usize, background: T) -> Result<u32, T> {
        match self.children.rank(slot) {
            Some(rank) => Ok(self.first_child + rank as u32),
            None => Err((self.tiled.rank(slot)).map_or(background, |rank| self.tiles[rank].value)),
        }
    }

    /// Slots that hold a child or a tile, in order.
    fn contents(&self) -> impl Iterator<Item = (usize, Result<u32, Tile<T>>)> + '_ {
        let children = (self.children.slots().zip(self.first_child..)).map(|(s, c)| (s, Ok(c)));
        let tiles = (self.tiled.slots().zip(&self.tiles)).map(|(s, t)| (s, Err(*t)));
        merge(children, tiles)
    }
}

/// Two lists that rise by their first, as one.
fn merge<C>(
    a: impl Iterator<Item = (usize, C)>,
    b: impl Iterator<Item = (usize, C)>,
) -> impl Iterator<Item = (usize, C)> {
    let (mut a, mut b) = (a.peekable(), b.peekable());
    std::iter::from_fn(move || match (a.peek(), b.peek()) {
        (Some(x), Some(y)) if y.0 < x.0 => b.next(),
        (None, _) => b.next(),
        _ => a.next(),
    })
}

/// The active voxels of a leaf, as their indices.
pub(super) fn active_slots(mask: &[u64; 8]) -> impl Iterator<Item = usize> + '_ {
    (mask.iter().enumerate()).flat_map(|(w, &word)| bits(word).map(move |b| 64 * w + b))
}

/// Ranges of boxes of voxels.
impl<T: Spectrum> Tree<T> {
    /// Of the voxels from `first` to `last`, both counted.
    pub(super) fn range(&self, first: IVec3, last: IVec3) -> Range<T> {
        let mut gather = Gather::new();
        let all = (last.as_dvec3() - first.as_dvec3() + 1.0).element_product();
        let mut rest = all;
        // They lie in order along x.
        let along_x = |x: i32| {
            self.roots
                .partition_point(|(origin, _)| origin.x < x & !(EDGES[2] - 1))
        };
        let reached = &self.roots[along_x(first.x)..];
        for &(origin, _) in reached.iter().take_while(|(o, _)| o.x <= last.x) {
            let cut = [first.max(origin), last.min(origin + (EDGES[2] - 1))];
            if cut[0].cmple(cut[1]).all() {
                rest -= (cut[1] - cut[0] + 1).as_dvec3().element_product();
                self.gather(cut, 2, &mut gather);
            }
        }
        if rest > 0.0 {
            gather.add(Range::of(self.background), rest as f32);
        }
        gather.range()
    }

    fn gather(&self, [first, last]: [IVec3; 2], level: usize, gather: &mut Gather<T>) {
        let edge = EDGES[level];
        for block in blocks(first, last, edge) {
            let cut = [first.max(block), last.min(block + (edge - 1))];
            let voxels = (cut[1] - cut[0] + 1).as_vec3().element_product();
            let whole = cut == [block, block + (edge - 1)];
            match self.block(block, level) {
                Block::Constant(value) => gather.add(Range::of(value), voxels),
                Block::Node(range) if whole => gather.add(range, voxels),
                Block::Leaf(leaf) if whole => gather.add(self.leaves.range(leaf), voxels),
                Block::Node(_) => self.gather(cut, level - 1, gather),
                Block::Leaf(leaf) => {
                    for voxel in blocks(cut[0], cut[1], 1) {
                        let value = self.leaves.value(leaf, leaf_slot(voxel));
                        gather.add(Range::of(value), 1.0);
                    }
                }
            }
        }
    }

    /// What fills an aligned cube of this level.
    fn block(&self, origin: IVec3, level: usize) -> Block<T> {
        let upper = match self.root(origin) {
            None => return Block::Constant(self.background),
            Some(Root::Tile(tile)) => return Block::Constant(tile.value),
            Some(Root::Node(upper)) => &self.uppers[upper as usize],
        };
        if level == 2 {
            return Block::Node(upper.range);
        }
        let lower = match upper.find(upper_slot(origin), self.background) {
            Err(value) => return Block::Constant(value),
            Ok(lower) => &self.lowers[lower as usize],
        };
        if level == 1 {
            return Block::Node(lower.range);
        }
        match lower.find(lower_slot(origin), self.background) {
            Err(value) => Block::Constant(value),
            Ok(leaf) => Block::Leaf(leaf),
        }
    }

    /// Computes the ranges of all nodes, from below.
    pub(super) fn set_ranges(&mut self) {
        let Self {
            background,
            uppers,
            lowers,
            leaves,
            ..
        } = self;
        leaves.set_ranges();
        for lower in lowers.iter_mut() {
            lower.range = lower.range_of(*background, |leaf| leaves.range(leaf));
        }
        for upper in uppers {
            upper.range = upper.range_of(*background, |lower| lowers[lower as usize].range);
        }
    }
}

impl<T: Spectrum, const W: usize> Node<T, W> {
    fn range_of(&self, background: T, of_child: impl Fn(u32) -> Range<T>) -> Range<T> {
        let mut gather = Gather::new();
        let mut rest = 64 * W;
        for (_, content) in self.contents() {
            rest -= 1;
            let range = content.map_or_else(|tile| Range::of(tile.value), &of_child);
            gather.add(range, 1.0);
        }
        if rest > 0 {
            gather.add(Range::of(background), rest as f32);
        }
        gather.range()
    }
}

/// What fills an aligned cube of voxels.
enum Block<T> {
    Constant(T),
    Node(Range<T>),
    Leaf(u32),
}

/// The aligned cubes of this edge that hold voxels from `first` to `last`, by their first voxel.
pub(super) fn blocks(first: IVec3, last: IVec3, edge: i32) -> impl Iterator<Item = IVec3> {
    let first = first & !(edge - 1);
    let along = move |i: usize| (first[i]..=last[i]).step_by(edge as usize);
    along(0)
        .flat_map(move |x| along(1).flat_map(move |y| along(2).map(move |z| IVec3::new(x, y, z))))
}
