//! Makes sparse grids of leaves and tiles in any order.

use super::SparseGrid;
use super::leaves::{Leaves, Precision, VOXELS};
use super::mask::Mask;
use super::tree::{EDGES, Node, Root, Tile, Tree, leaf_slot, lower_slot, upper_slot};
use crate::MediumError;
use crate::field::Range;
use glam::{DAffine3, IVec3};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use tyndall_core::Spectrum;

/// How large a tile is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileSize {
    /// 8³ voxels, in place of a leaf.
    Leaf,
    /// 128³ voxels, in place of a lower node.
    Lower,
    /// 4096³ voxels, in place of an upper node.
    Upper,
}

/// What a slot is to hold: a node of the level below, by its number there, or one value.
#[derive(Clone, Copy, Debug)]
enum Slot<T> {
    Child(u32),
    Tile(Tile<T>),
}

/// The slots of a node that hold something, in order: a few bytes each, as files may have nodes that
/// are full of tiles in a bit each.
#[derive(Clone, Debug)]
struct Slots<T>(Vec<(u16, Slot<T>)>);

impl<T: Copy> Slots<T> {
    /// Where a slot is, or where it is to be.
    fn find(&self, slot: usize) -> Result<usize, usize> {
        let slot = slot as u16;
        match self.0.last() {
            Some((last, _)) if slot <= *last => self.0.binary_search_by_key(&slot, |(s, _)| *s),
            _ => Err(self.0.len()),
        }
    }

    fn get(&self, slot: usize) -> Option<Slot<T>> {
        self.find(slot).ok().map(|i| self.0[i].1)
    }

    /// What the slot holds, which is `content` if it was free.
    fn get_or(&mut self, slot: usize, content: Slot<T>) -> Slot<T> {
        match self.find(slot) {
            Ok(i) => self.0[i].1,
            Err(i) => {
                self.0.insert(i, (slot as u16, content));
                content
            }
        }
    }

    /// Fills a slot that is free.
    fn fill(&mut self, slot: usize, content: Slot<T>) -> Option<()> {
        let place = self.find(slot).err()?;
        self.0.insert(place, (slot as u16, content));
        Some(())
    }

    fn children(&self) -> impl Iterator<Item = u32> + '_ {
        self.0.iter().filter_map(|(_, content)| match content {
            Slot::Child(child) => Some(*child),
            Slot::Tile(_) => None,
        })
    }
}

/// No slots.
impl<T> Default for Slots<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

/// A sparse grid in the making.
///
/// ```
/// use glam::{DAffine3, IVec3, Vec3};
/// use tyndall_media::{SparseBuilder, TileSize};
/// let mut cloud = SparseBuilder::new(0.0_f32);
/// cloud.tile(IVec3::new(-8, 0, 0), TileSize::Leaf, 0.5, true)?;
/// cloud.voxel(IVec3::new(3, 4, 5), 2.0)?;
/// let cloud = cloud.build(DAffine3::IDENTITY)?;
/// assert_eq!(cloud.statistics().voxels, 513);
/// assert_eq!(cloud.voxel(IVec3::new(-1, 7, 7)), 0.5);
/// # Ok::<(), tyndall_media::MediumError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SparseBuilder<T = f32> {
    background: T,
    roots: BTreeMap<[i32; 3], Slot<T>>,
    uppers: Vec<Slots<T>>,
    lowers: Vec<Slots<T>>,
    leaves: Leaves<T>,
}

impl<T: Spectrum> SparseBuilder<T> {
    /// A grid that is `background` everywhere.
    pub fn new(background: T) -> Self {
        Self {
            background,
            roots: BTreeMap::new(),
            uppers: Vec::new(),
            lowers: Vec::new(),
            leaves: Leaves::default(),
        }
    }

    /// Chooses how voxels are kept, those too that have been added.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.leaves.set_precision(precision);
        self
    }

    /// Adds the 8³ voxels from `origin` on, whose coordinates are multiples of 8. Voxel (x, y, z)
    /// from there is value 64·x + 8·y + z, and this bit of `active`.
    ///
    /// # Errors
    /// [`MediumError::Block`] if the place is not one for a leaf or already taken.
    pub fn leaf(
        &mut self,
        origin: IVec3,
        values: &[T; VOXELS],
        active: [u64; 8],
    ) -> Result<(), MediumError> {
        let leaf = self.leaves.len() as u32;
        self.place(origin, TileSize::Leaf, Slot::Child(leaf))?;
        self.leaves.push(values, active);
        Ok(())
    }

    /// Adds a cube of voxels of one value from `origin` on, whose coordinates are multiples of its
    /// edge.
    ///
    /// # Errors
    /// As [`SparseBuilder::leaf`].
    pub fn tile(
        &mut self,
        origin: IVec3,
        size: TileSize,
        value: T,
        active: bool,
    ) -> Result<(), MediumError> {
        self.place(origin, size, Slot::Tile(Tile { value, active }))
    }

    /// Sets a voxel and makes it active; the others of a leaf made for it are background.
    ///
    /// # Errors
    /// [`MediumError::Block`] if it lies in a tile.
    pub fn voxel(&mut self, ijk: IVec3, value: T) -> Result<(), MediumError> {
        let origin = ijk & !(EDGES[0] - 1);
        let leaf = match self.leaf_at(origin) {
            Some(leaf) => leaf,
            None => {
                self.leaf(origin, &[self.background; VOXELS], [0; 8])?;
                self.leaves.len() as u32 - 1
            }
        };
        self.leaves.set(leaf, leaf_slot(ijk), value);
        Ok(())
    }

    fn leaf_at(&self, origin: IVec3) -> Option<u32> {
        let root = (origin & !(EDGES[2] - 1)).to_array();
        let Slot::Child(upper) = *self.roots.get(&root)? else {
            return None;
        };
        let Slot::Child(lower) = self.uppers[upper as usize].get(upper_slot(origin))? else {
            return None;
        };
        match self.lowers[lower as usize].get(lower_slot(origin))? {
            Slot::Child(leaf) => Some(leaf),
            Slot::Tile(_) => None,
        }
    }

    fn place(
        &mut self,
        origin: IVec3,
        size: TileSize,
        content: Slot<T>,
    ) -> Result<(), MediumError> {
        let edge = EDGES[size as usize];
        let is_aligned = origin & (edge - 1) == IVec3::ZERO
            && origin.checked_add(IVec3::splat(edge - 1)).is_some();
        let placed = if is_aligned {
            self.fill(origin, size, content)
        } else {
            None
        };
        placed.ok_or(MediumError::Block {
            origin: origin.to_array(),
            edge,
        })
    }

    /// Fills the slot of a place if it is free, making the nodes above.
    fn fill(&mut self, origin: IVec3, size: TileSize, content: Slot<T>) -> Option<()> {
        let root = self.roots.entry((origin & !(EDGES[2] - 1)).to_array());
        if size == TileSize::Upper {
            return match root {
                Entry::Vacant(root) => {
                    root.insert(content);
                    Some(())
                }
                Entry::Occupied(_) => None,
            };
        }
        let new = Slot::Child(self.uppers.len() as u32);
        let upper = child(&mut self.uppers, *root.or_insert(new))?;
        if size == TileSize::Lower {
            return upper.fill(upper_slot(origin), content);
        }
        let new = Slot::Child(self.lowers.len() as u32);
        let lower = upper.get_or(upper_slot(origin), new);
        child(&mut self.lowers, lower)?.fill(lower_slot(origin), content)
    }

    /// The grid, whose voxel (i, j, k) has its centre at `to_world`·(i, j, k).
    ///
    /// # Errors
    /// [`MediumError::Transform`] if `to_world` has no inverse.
    pub fn build(mut self, to_world: DAffine3) -> Result<SparseGrid<T>, MediumError> {
        let background = self.leaves.rounded(self.background);
        let settled = |tile: Tile<T>| match tile.value == self.background {
            true => Tile {
                value: background,
                ..tile
            },
            false => tile,
        };
        let mut order = Vec::with_capacity(self.leaves.len());
        let (mut uppers, mut lowers, mut tops) = (Vec::new(), Vec::new(), Vec::new());
        for (origin, root) in self.roots {
            let root = match root {
                Slot::Tile(tile) => Root::Tile(settled(tile)),
                Slot::Child(upper) => {
                    let upper = std::mem::take(&mut self.uppers[upper as usize]);
                    let first = lowers.len() as u32;
                    for lower in upper.children() {
                        let lower = std::mem::take(&mut self.lowers[lower as usize]);
                        lowers.push(node(&lower, order.len() as u32, settled));
                        order.extend(lower.children());
                    }
                    uppers.push(node(&upper, first, settled));
                    Root::Node(uppers.len() as u32 - 1)
                }
            };
            tops.push((IVec3::from(origin), root));
        }
        if !order.is_sorted() {
            self.leaves.reorder(&order);
        }
        self.leaves.shrink();
        let mut tree = Tree {
            background,
            roots: tops,
            uppers,
            lowers,
            leaves: self.leaves,
        };
        tree.set_ranges();
        SparseGrid::of(tree, to_world)
    }
}

/// The node that a slot holds, which is new if it has the number after the last.
fn child<T>(nodes: &mut Vec<Slots<T>>, slot: Slot<T>) -> Option<&mut Slots<T>> {
    let Slot::Child(i) = slot else {
        return None;
    };
    if i as usize == nodes.len() {
        nodes.push(Slots::default());
    }
    nodes.get_mut(i as usize)
}

/// A node, its tiles `settled`, its range still to be set.
fn node<T: Spectrum, const W: usize>(
    slots: &Slots<T>,
    first_child: u32,
    settled: impl Fn(Tile<T>) -> Tile<T>,
) -> Node<T, W> {
    let of = |child: bool| {
        let is_child = |content: &Slot<T>| matches!(content, Slot::Child(_));
        let slots = slots.0.iter();
        let slots = slots.filter(|(_, content)| is_child(content) == child);
        Mask::of(slots.map(|(slot, _)| usize::from(*slot)))
    };
    let tiles = slots.0.iter().filter_map(|(_, content)| match content {
        Slot::Tile(tile) => Some(settled(*tile)),
        Slot::Child(_) => None,
    });
    Node {
        children: of(true),
        first_child,
        tiled: of(false),
        tiles: tiles.collect(),
        range: Range::of(T::default()),
    }
}
