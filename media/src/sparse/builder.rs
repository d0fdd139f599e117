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

/// What a slot is to hold.
#[derive(Clone, Debug)]
enum Slot<T, C> {
    Child(C),
    Tile(Tile<T>),
}

type Lower<T> = BTreeMap<usize, Slot<T, u32>>;
type Upper<T> = BTreeMap<usize, Slot<T, Lower<T>>>;

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
    roots: BTreeMap<[i32; 3], Slot<T, Upper<T>>>,
    leaves: Leaves<T>,
}

impl<T: Spectrum> SparseBuilder<T> {
    /// A grid that is `background` everywhere.
    pub fn new(background: T) -> Self {
        Self {
            background,
            roots: BTreeMap::new(),
            leaves: Leaves::new(Precision::default()),
        }
    }

    /// Chooses how voxels are kept; before any is added.
    #[must_use]
    pub fn with_precision(self, precision: Precision) -> Self {
        let leaves = Leaves::new(precision);
        Self { leaves, ..self }
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
        let Slot::Child(upper) = self.roots.get(&root)? else {
            return None;
        };
        let Slot::Child(lower) = upper.get(&upper_slot(origin))? else {
            return None;
        };
        match lower.get(&lower_slot(origin))? {
            Slot::Child(leaf) => Some(*leaf),
            Slot::Tile(_) => None,
        }
    }

    fn place(
        &mut self,
        origin: IVec3,
        size: TileSize,
        content: Slot<T, u32>,
    ) -> Result<(), MediumError> {
        let edge = EDGES[size as usize];
        let bad = MediumError::Block {
            origin: origin.to_array(),
            edge,
        };
        if origin & (edge - 1) != IVec3::ZERO
            || origin.checked_add(IVec3::splat(edge - 1)).is_none()
        {
            return Err(bad);
        }
        let root = self.roots.entry((origin & !(EDGES[2] - 1)).to_array());
        if let (TileSize::Upper, Slot::Tile(tile)) = (size, &content) {
            return vacant(root, Slot::Tile(*tile)).ok_or(bad);
        }
        let Slot::Child(upper) = root.or_insert(Slot::Child(BTreeMap::new())) else {
            return Err(bad);
        };
        let slot = upper.entry(upper_slot(origin));
        if let (TileSize::Lower, Slot::Tile(tile)) = (size, &content) {
            return vacant(slot, Slot::Tile(*tile)).ok_or(bad);
        }
        let Slot::Child(lower) = slot.or_insert(Slot::Child(BTreeMap::new())) else {
            return Err(bad);
        };
        vacant(lower.entry(lower_slot(origin)), content).ok_or(bad)
    }

    /// The grid, whose voxel (i, j, k) has its centre at `to_world`·(i, j, k).
    ///
    /// # Errors
    /// [`MediumError::Transform`] if `to_world` has no inverse.
    pub fn build(self, to_world: DAffine3) -> Result<SparseGrid<T>, MediumError> {
        let Self {
            background,
            roots,
            mut leaves,
        } = self;
        let mut order = Vec::with_capacity(leaves.len());
        let (mut uppers, mut lowers, mut tops) = (Vec::new(), Vec::new(), Vec::new());
        for (origin, root) in roots {
            let root = match root {
                Slot::Tile(tile) => Root::Tile(tile),
                Slot::Child(upper) => {
                    let first = lowers.len() as u32;
                    for lower in upper.values() {
                        if let Slot::Child(lower) = lower {
                            lowers.push(node(lower, order.len() as u32, background));
                            order.extend(children(lower));
                        }
                    }
                    uppers.push(node(&upper, first, background));
                    Root::Node(uppers.len() as u32 - 1)
                }
            };
            tops.push((IVec3::from(origin), root));
        }
        if !order.is_sorted() {
            leaves.reorder(&order);
        }
        let mut tree = Tree {
            background,
            roots: tops,
            uppers,
            lowers,
            leaves,
        };
        tree.set_ranges();
        SparseGrid::of(tree, to_world)
    }
}

/// Fills a slot that is free.
fn vacant<K: Ord, V>(slot: Entry<'_, K, V>, content: V) -> Option<()> {
    match slot {
        Entry::Vacant(slot) => {
            slot.insert(content);
            Some(())
        }
        Entry::Occupied(_) => None,
    }
}

fn children<T>(lower: &Lower<T>) -> impl Iterator<Item = u32> + '_ {
    lower.values().filter_map(|slot| match slot {
        Slot::Child(leaf) => Some(*leaf),
        Slot::Tile(_) => None,
    })
}

/// A node without its range.
fn node<T: Spectrum, C, const W: usize>(
    slots: &BTreeMap<usize, Slot<T, C>>,
    first_child: u32,
    background: T,
) -> Node<T, W> {
    let is_child = |slot: &Slot<T, C>| matches!(slot, Slot::Child(_));
    let of = |child| {
        let slots = slots
            .iter()
            .filter(move |(_, slot)| is_child(slot) == child);
        Mask::of(slots.map(|(&i, _)| i))
    };
    let tiles = slots.values().filter_map(|slot| match slot {
        Slot::Tile(tile) => Some(*tile),
        Slot::Child(_) => None,
    });
    Node {
        children: of(true),
        first_child,
        tiled: of(false),
        tiles: tiles.collect(),
        range: Range::of(background),
    }
}
