//! The kinds of nodes that have children, in the tree 5-4-3 of both formats.

use glam::IVec3;
use tyndall_media::{MediumError, TileSize};

/// Voxels of a leaf, and words of its mask.
pub(super) const VOXELS: usize = 512;
pub(super) const LEAF_WORDS: usize = VOXELS / 64;
/// log₂ of the voxels along the edge of what a slot of the root holds.
pub(super) const ROOT_EDGE: u32 = 12;

/// A kind of node with children.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// log₂ of the slots along an edge.
    slots: u32,
    /// log₂ of the voxels along the edge of a slot.
    pub(super) edge: u32,
    /// What fills a slot without a child.
    pub(super) tile: TileSize,
}

/// 16³ slots of 8³ voxels.
pub(super) const LOWER: Level = Level {
    slots: 4,
    edge: 3,
    tile: TileSize::Leaf,
};
/// 32³ slots of 128³ voxels.
pub(super) const UPPER: Level = Level {
    slots: 5,
    edge: 7,
    tile: TileSize::Lower,
};

impl Level {
    /// Number of slots.
    pub(super) const fn count(self) -> usize {
        1 << (3 * self.slots)
    }

    /// log₂ of the voxels along an edge.
    pub(super) fn node_edge(self) -> u32 {
        self.slots + self.edge
    }

    /// The slot of a voxel: x slowest.
    pub(super) fn slot(self, ijk: IVec3) -> usize {
        let IVec3 { x, y, z } = (ijk >> self.edge) & ((1 << self.slots) - 1);
        ((x << (2 * self.slots)) | (y << self.slots) | z) as usize
    }

    /// The first voxel of a slot, from the node's first.
    pub(super) fn origin(self, slot: usize) -> IVec3 {
        let (slot, mask) = (slot as i32, (1 << self.slots) - 1);
        let x = slot >> (2 * self.slots);
        IVec3::new(x, (slot >> self.slots) & mask, slot & mask) << self.edge
    }
}

/// Says why a node or tile of a file could not be placed.
pub(super) fn misplaced(error: MediumError) -> String {
    format!("{error}: the file is damaged, export it again")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_name_places() {
        for (level, slot) in [(LOWER, 4095), (LOWER, 17), (UPPER, 32_767), (UPPER, 1025)] {
            assert_eq!(level.slot(level.origin(slot)), slot);
            let origin = IVec3::new(-4096, 8192, i32::MIN);
            assert_eq!(level.slot(origin + level.origin(slot)), slot);
        }
    }
}
