//! The header of a grid, and its description in the file.

use super::super::file::{DESCRIPTION, HEADER, description};
use super::super::layout::{grid, map, tree};
use super::buffer::Buffer;
use super::nodes::{EMPTY_BOX, Places};
use super::{MAGIC, VERSION};
use glam::{DAffine3, DVec3, IVec3};

/// Boxes, minima and maxima, means, standard deviations; nodes lie breadth first.
const FLAGS: u32 = 2 | 4 | 8 | 16 | 32;
const HAS_BOX: u32 = 2;
/// No checksum.
const UNCHECKED: u64 = u64::MAX;

/// What a file says of a grid, in its header or before it.
#[derive(Debug)]
pub(super) struct About<'a> {
    pub(super) name: &'a [u8],
    pub(super) kind: u32,
    pub(super) class: u32,
    pub(super) to_world: DAffine3,
    /// First and last active voxel, if any.
    pub(super) bounds: Option<[IVec3; 2]>,
    pub(super) voxels: u64,
    pub(super) nodes: [u32; 3],
    pub(super) tiles: [u32; 3],
    pub(super) places: Places,
}

impl About<'_> {
    /// Fills the header of the grid and of its tree.
    pub(super) fn put(&self, buffer: &mut Buffer) {
        buffer.put(0, MAGIC);
        buffer.put_u64(grid::CHECKSUM, UNCHECKED);
        buffer.put_u32(grid::VERSION, VERSION);
        let without = if self.bounds.is_some() { 0 } else { HAS_BOX };
        buffer.put_u32(grid::FLAGS, FLAGS & !without);
        buffer.put_u32(grid::COUNT, 1);
        buffer.put_u64(grid::SIZE, self.places.end);
        buffer.put(grid::NAME, self.name);
        self.put_map(buffer);
        buffer.put_f64s(grid::WORLD_BOX, self.world_box().as_flattened());
        buffer.put_f64s(grid::VOXEL_SIZE, &self.voxel_size());
        buffer.put_u32(grid::CLASS, self.class);
        buffer.put_u32(grid::TYPE, self.kind);
        let Places { levels, root, .. } = self.places;
        let [leaves, lowers, uppers] = levels;
        for (i, place) in [leaves, lowers, uppers, root].into_iter().enumerate() {
            let at = grid::END + tree::OFFSETS + size_of::<u64>() * i;
            buffer.put_u64(at, place - grid::END as u64);
        }
        put_u32s(buffer, grid::END + tree::NODES, &self.nodes);
        put_u32s(buffer, grid::END + tree::TILES, &self.tiles);
        buffer.put_u64(grid::END + tree::VOXELS, self.voxels);
    }

    fn put_map(&self, buffer: &mut Buffer) {
        let inverse = self.to_world.matrix3.inverse();
        let rows = |m: glam::DMat3| m.transpose().to_cols_array();
        let single = |all: &[f64]| all.iter().map(|&x| x as f32).collect::<Vec<_>>();
        let (matrix, inverse) = (rows(self.to_world.matrix3), rows(inverse));
        let vector = self.to_world.translation.to_array();
        buffer.put_f32s(grid::MAP + map::MATRIX_F32, &single(&matrix));
        buffer.put_f32s(grid::MAP + map::INVERSE_F32, &single(&inverse));
        buffer.put_f32s(grid::MAP + map::VECTOR_F32, &single(&vector));
        buffer.put_f32s(grid::MAP + map::TAPER_F32, &[1.0]);
        buffer.put_f64s(grid::MAP + map::MATRIX, &matrix);
        buffer.put_f64s(grid::MAP + map::INVERSE, &inverse);
        buffer.put_f64s(grid::MAP + map::VECTOR, &vector);
        buffer.put_f64s(grid::MAP + map::TAPER, &[1.0]);
    }

    /// The segment of this grid up to its buffer, which is stored in so many bytes.
    pub(super) fn describe(&self, stored: usize, codec: u16) -> Result<Buffer, String> {
        let length = self.name.len() + 1;
        let mut buffer = Buffer::new((HEADER + DESCRIPTION + length) as u64)?;
        buffer.put(0, MAGIC);
        buffer.put_u32(8, VERSION);
        buffer.put(12, &1_u16.to_le_bytes());
        buffer.put(14, &codec.to_le_bytes());
        let at = |field| HEADER + field;
        buffer.put_u64(at(description::SIZE), self.places.end);
        buffer.put_u64(at(description::STORED), stored as u64);
        buffer.put_u64(at(description::NAME_KEY), key(self.name));
        buffer.put_u64(at(description::VOXELS), self.voxels);
        buffer.put_u32(at(description::TYPE), self.kind);
        buffer.put_u32(at(description::CLASS), self.class);
        let world_box = self.world_box();
        buffer.put_f64s(at(description::WORLD_BOX), world_box.as_flattened());
        let index_box = self.bounds.unwrap_or(EMPTY_BOX);
        buffer.put_box(at(description::INDEX_BOX), index_box);
        buffer.put_f64s(at(description::VOXEL_SIZE), &self.voxel_size());
        buffer.put_u32(at(description::NAME_LENGTH), length as u32);
        let [leaves, lowers, uppers] = self.nodes;
        let nodes = [leaves, lowers, uppers, 1];
        put_u32s(&mut buffer, at(description::NODES), &nodes);
        put_u32s(&mut buffer, at(description::TILES), &self.tiles);
        buffer.put(at(description::CODEC), &codec.to_le_bytes());
        buffer.put_u32(at(description::VERSION), VERSION);
        buffer.put(HEADER + DESCRIPTION, self.name);
        Ok(buffer)
    }

    /// Around the active voxels, each taken to reach from its own coordinates to the next ones.
    fn world_box(&self) -> [[f64; 3]; 2] {
        let Some([first, last]) = self.bounds else {
            return [[f64::MAX; 3], [f64::MIN; 3]];
        };
        let ends = [first.as_dvec3(), last.as_dvec3() + 1.0];
        let corner = |i: usize| {
            let end = |axis: usize| ends[i >> axis & 1][axis];
            self.to_world
                .transform_point3(DVec3::new(end(0), end(1), end(2)))
        };
        let min = (0..8).map(corner).fold(DVec3::MAX, DVec3::min);
        let max = (0..8).map(corner).fold(DVec3::MIN, DVec3::max);
        [min.to_array(), max.to_array()]
    }

    /// The edges of a voxel.
    fn voxel_size(&self) -> [f64; 3] {
        let m = self.to_world.matrix3;
        [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length)
    }
}

fn put_u32s(buffer: &mut Buffer, at: usize, all: &[u32]) {
    for (i, x) in all.iter().enumerate() {
        buffer.put_u32(at + size_of_val(x) * i, *x);
    }
}

/// The hash of a name.
fn key(name: &[u8]) -> u64 {
    name.iter().fold(0, |hash: u64, &byte| {
        let carry = hash >> 56;
        hash.wrapping_mul(67).wrapping_add(u64::from(byte) + carry)
    })
}

#[cfg(test)]
mod tests {
    use super::key;

    /// As in files of NanoVDB 32.4.
    #[test]
    fn names_have_their_keys() {
        assert_eq!(key(b"density"), 9_184_452_543_000);
    }
}
