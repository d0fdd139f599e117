//! Where things stand in the buffer of a grid.
//!
//! `GridData`, `TreeData`, root, root tiles, then the nodes of 32³ slots, those of 16³ slots, and the
//! leaves. All but `TreeData` and the tiles may lie anywhere in a file that we read; each begins at
//! a multiple of 32 bytes and offsets count from whoever holds them.

use crate::volume::level::{LOWER, Level, UPPER, VOXELS};

/// The header of a grid.
pub(super) mod grid {
    pub(crate) const CHECKSUM: usize = 8;
    pub(crate) const VERSION: usize = 16;
    pub(crate) const FLAGS: usize = 20;
    pub(crate) const COUNT: usize = 28;
    pub(crate) const SIZE: usize = 32;
    pub(crate) const NAME: usize = 40;
    /// With the zero at its end.
    pub(crate) const NAME_LENGTH: usize = 256;
    pub(crate) const MAP: usize = 296;
    pub(crate) const WORLD_BOX: usize = 560;
    pub(crate) const VOXEL_SIZE: usize = 608;
    pub(crate) const CLASS: usize = 632;
    pub(crate) const TYPE: usize = 636;
    /// Where it ends and the tree begins.
    pub(crate) const END: usize = 672;
}

/// The map from index to world, from [`grid::MAP`] on: matrices by rows.
pub(super) mod map {
    pub(crate) const MATRIX_F32: usize = 0;
    pub(crate) const INVERSE_F32: usize = 36;
    pub(crate) const VECTOR_F32: usize = 72;
    pub(crate) const TAPER_F32: usize = 84;
    pub(crate) const MATRIX: usize = 88;
    pub(crate) const INVERSE: usize = 160;
    pub(crate) const VECTOR: usize = 232;
    pub(crate) const TAPER: usize = 256;
}

/// The tree, from [`grid::END`] on.
pub(super) mod tree {
    /// Offsets of leaves, lower nodes, upper nodes and root.
    pub(crate) const OFFSETS: usize = 0;
    /// How many nodes: leaves, lower, upper.
    pub(crate) const NODES: usize = 32;
    /// How many active tiles in lower nodes, upper nodes and root.
    pub(crate) const TILES: usize = 44;
    pub(crate) const VOXELS: usize = 56;
    pub(crate) const SIZE: usize = 64;
}

/// The root begins with the box of its active voxels.
pub(super) const ROOT_TILES: usize = 24;

/// A tile of the root; 0 where there is no child.
pub(super) mod tile {
    pub(crate) const KEY: usize = 0;
    pub(crate) const CHILD: usize = 8;
    pub(crate) const ACTIVE: usize = 16;
}

/// A leaf begins with its first active voxel and the extent of the others.
pub(super) mod leaf {
    pub(crate) const EXTENT: usize = 12;
    pub(crate) const FLAGS: usize = 15;
    pub(crate) const MASK: usize = 16;
    pub(crate) const STATISTICS: usize = 80;
    /// Of quantised values: value = minimum + code · quantum.
    pub(crate) const MINIMUM: usize = 80;
    pub(crate) const QUANTUM: usize = 84;
    pub(crate) const CODES: usize = 96;
}

/// The kind of the nodes of a level: 1 (lower nodes) or 2 (upper nodes).
pub(super) fn kind_of(level: usize) -> Level {
    [LOWER, UPPER][level - 1]
}

/// How the voxels of a leaf are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leaves {
    /// One value after the other.
    Values,
    /// As codes of 2ⁿ bits.
    Codes(u8),
    /// As codes whose size each leaf states.
    AnyCodes,
}

/// How values are stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Bytes of a number: 4 or 8.
    pub(super) scalar: usize,
    /// Numbers of a value: 1 or 3.
    pub(super) channels: usize,
    pub(super) leaves: Leaves,
}

/// What types of values are called, by their number in a file.
const NAMES: [&str; 27] = [
    "unknown",
    "float",
    "double",
    "int16",
    "int32",
    "int64",
    "Vec3f",
    "Vec3d",
    "Mask",
    "Half",
    "uint32",
    "bool",
    "RGBA8",
    "Fp4",
    "Fp8",
    "Fp16",
    "FpN",
    "Vec4f",
    "Vec4d",
    "Index",
    "OnIndex",
    "IndexMask",
    "OnIndexMask",
    "PointIndex",
    "Vec3u8",
    "Vec3u16",
    "uint8",
];

/// The number of the type `float`.
pub(super) const FLOAT: u32 = 1;
/// The number of the type `Vec3f`.
pub(super) const VEC3F: u32 = 6;

/// What a type is called.
pub(super) fn name(code: u32) -> &'static str {
    NAMES.get(code as usize).unwrap_or(&NAMES[0])
}

impl Layout {
    /// Of single precision.
    pub(super) const fn plain(channels: usize) -> Self {
        Self {
            scalar: 4,
            channels,
            leaves: Leaves::Values,
        }
    }

    /// Of a type that is read; of another, why it is not.
    pub(super) fn of(code: u32) -> Result<Self, String> {
        let (scalar, channels, leaves) = match code {
            FLOAT => return Ok(Self::plain(1)),
            VEC3F => return Ok(Self::plain(3)),
            2 => (8, 1, Leaves::Values),
            7 => (8, 3, Leaves::Values),
            13 => (4, 1, Leaves::Codes(2)),
            14 => (4, 1, Leaves::Codes(3)),
            15 => (4, 1, Leaves::Codes(4)),
            16 => (4, 1, Leaves::AnyCodes),
            _ => {
                return Err(format!(
                    "its values are of type {} ({code}), which is not read: export it as float or Vec3f",
                    name(code)
                ));
            }
        };
        Ok(Self {
            scalar,
            channels,
            leaves,
        })
    }

    /// Bytes of a value.
    pub(super) fn value(self) -> usize {
        self.scalar * self.channels
    }

    /// Bytes of minimum, maximum, mean and standard deviation.
    fn statistics(self) -> usize {
        2 * self.value() + 2 * self.scalar
    }

    pub(super) fn background(self) -> usize {
        (ROOT_TILES + 4).next_multiple_of(self.scalar)
    }

    /// Bytes of the root without its tiles.
    pub(super) fn root(self) -> usize {
        (self.background() + self.value() + self.statistics()).next_multiple_of(32)
    }

    pub(super) fn tile_value(self) -> usize {
        (tile::ACTIVE + 4).next_multiple_of(self.scalar)
    }

    /// Bytes of a tile of the root.
    pub(super) fn tile(self) -> usize {
        (self.tile_value() + self.value()).next_multiple_of(32)
    }

    /// Of a node of level 1 or 2.
    pub(super) fn node(self, level: usize) -> NodeLayout {
        let slots = kind_of(level).count();
        let child_mask = NodeLayout::VALUE_MASK + slots / 8;
        let statistics = child_mask + slots / 8;
        let table = (statistics + self.statistics()).next_multiple_of(32);
        let stride = self.value().next_multiple_of(8);
        NodeLayout {
            slots,
            child_mask,
            statistics,
            table,
            stride,
            size: table + slots * stride,
        }
    }

    pub(super) fn leaf_values(self) -> usize {
        match self.leaves {
            Leaves::Values => (leaf::STATISTICS + self.statistics()).next_multiple_of(32),
            Leaves::Codes(_) | Leaves::AnyCodes => leaf::CODES,
        }
    }

    /// Bytes of a leaf; the fewest that one may have.
    pub(super) fn leaf(self) -> usize {
        let bits = match self.leaves {
            Leaves::Values => 8 * self.value(),
            Leaves::Codes(log2) => 1 << log2,
            Leaves::AnyCodes => 1,
        };
        self.leaf_values() + VOXELS / 8 * bits
    }
}

/// Where things stand in a node, which begins with the box of its active voxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeLayout {
    pub(super) slots: usize,
    pub(super) child_mask: usize,
    pub(super) statistics: usize,
    /// A child's offset or a value for each slot.
    pub(super) table: usize,
    /// Bytes of a slot.
    pub(super) stride: usize,
    pub(super) size: usize,
}

impl NodeLayout {
    pub(super) const FLAGS: usize = 24;
    /// Which slots are active tiles.
    pub(super) const VALUE_MASK: usize = 32;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes as a compiler lays the structures of NanoVDB 32.4 out.
    #[test]
    fn sizes_are_those_of_nano_vdb() {
        let sizes = |code| {
            let layout = Layout::of(code).unwrap();
            let nodes = [2, 1].map(|level| layout.node(level).size);
            [
                layout.root(),
                layout.tile(),
                nodes[0],
                nodes[1],
                layout.leaf(),
            ]
        };
        assert_eq!(sizes(1), [64, 32, 270_400, 33_856, 2144], "float");
        assert_eq!(sizes(2), [96, 32, 270_400, 33_856, 4224], "double");
        assert_eq!(sizes(6), [96, 32, 532_544, 66_624, 6272], "Vec3f");
        assert_eq!(sizes(7), [128, 64, 794_720, 99_424, 12_448], "Vec3d");
        assert_eq!(sizes(13), [64, 32, 270_400, 33_856, 352], "Fp4");
        assert_eq!(sizes(14), [64, 32, 270_400, 33_856, 608], "Fp8");
        assert_eq!(sizes(15), [64, 32, 270_400, 33_856, 1120], "Fp16");
        assert_eq!(sizes(16), [64, 32, 270_400, 33_856, 160], "FpN");
    }
}
