//! Copies of sparse grids with other values in the same places.

use glam::IVec3;
use tyndall_core::Spectrum;
use tyndall_media::{Piece, Precision, SparseBuilder, SparseGrid, Tile, TileSize};

/// A copy whose voxels are what `map` makes of them, and whose background is what it makes of that;
/// what is background, and inactive, is not stored. An error is the first voxel that `map` has nothing
/// for (of a tile its first, of the background the origin), and its value.
pub(super) fn rebuild<T: Spectrum>(
    grid: &SparseGrid<T>,
    precision: Precision,
    map: impl Fn(Tile<T>) -> Option<Tile<T>>,
) -> Result<SparseGrid<T>, (IVec3, T)> {
    let outside = Tile {
        value: grid.background(),
        active: false,
    };
    let background = map(outside).ok_or((IVec3::ZERO, outside.value))?.value;
    let mut copy = SparseBuilder::new(background).with_precision(precision);
    let mut first_bad = None;
    let is_stored = |tile: &Tile<T>| tile.active || tile.value != background;
    grid.visit(|origin, piece| match piece {
        Piece::Tile { edge, tile } => match map(tile) {
            None => {
                first_bad.get_or_insert((origin, tile.value));
            }
            Some(tile) if is_stored(&tile) => copy
                .tile(origin, tile_size(edge), tile.value, tile.active)
                .expect("the places of a tree are free in a copy"),
            Some(_) => {}
        },
        Piece::Leaf { leaf, active } => {
            let (mut values, mut mask) = ([background; 512], [0; 8]);
            let mut is_empty = true;
            for (slot, value) in grid.leaf_values(leaf).enumerate() {
                let active = active[slot / 64] >> (slot % 64) & 1 == 1;
                let Some(tile) = map(Tile { value, active }) else {
                    first_bad.get_or_insert((origin + in_leaf(slot), value));
                    continue;
                };
                values[slot] = tile.value;
                mask[slot / 64] |= u64::from(tile.active) << (slot % 64);
                is_empty &= !is_stored(&tile);
            }
            if !is_empty {
                (copy.leaf(origin, &values, mask))
                    .expect("the places of a tree are free in a copy");
            }
        }
    });
    match first_bad {
        Some(bad) => Err(bad),
        None => Ok((copy.build(grid.to_world())).expect("the transform of a grid has an inverse")),
    }
}

/// The place in a leaf of the value with this number.
pub(crate) fn in_leaf(slot: usize) -> IVec3 {
    IVec3::from([slot >> 6, slot >> 3, slot].map(|i| (i & 7) as i32))
}

fn tile_size(edge: i32) -> TileSize {
    match edge {
        8 => TileSize::Leaf,
        128 => TileSize::Lower,
        _ => TileSize::Upper,
    }
}
