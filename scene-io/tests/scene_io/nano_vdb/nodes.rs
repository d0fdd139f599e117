//! What nodes that are written state of themselves, against the voxels they hold.

use super::round_trip::random;
use super::{TREE, buffer_start, f32_at, u32_at, u64_at, write};
use glam::IVec3;
use tyndall_core::{Rgb, Spectrum};
use tyndall_media::{Piece, SparseGrid};
use tyndall_scene_io::{GridClass, NanoCodec, VolumeGrid, Voxels};

/// Where things stand in the nodes of NanoVDB 32, written here once more.
struct Places {
    channels: usize,
    /// Of lower and upper nodes: statistics, children, size.
    nodes: [[usize; 3]; 2],
}

const FLOAT: Places = Places {
    channels: 1,
    nodes: [[1056, 1088, 33_856], [8224, 8256, 270_400]],
};
const VEC3F: Places = Places {
    channels: 3,
    nodes: [[1056, 1088, 66_624], [8224, 8256, 532_544]],
};

/// Active voxels of a part of a grid: cubes of one value.
type Cubes<T> = Vec<(IVec3, i32, T)>;

fn cubes<T: Spectrum>(grid: &SparseGrid<T>) -> Cubes<T> {
    let mut cubes = Vec::new();
    grid.visit(|origin, piece| match piece {
        Piece::Tile { edge, tile } => {
            if tile.active {
                cubes.push((origin, edge, tile.value));
            }
        }
        Piece::Leaf { leaf, active } => {
            for (i, value) in grid.leaf_values(leaf).enumerate() {
                if active[i / 64] >> (i % 64) & 1 == 1 {
                    let [x, y, z] = [i >> 6, i >> 3 & 7, i & 7].map(|x| x as i32);
                    cubes.push((origin + IVec3::new(x, y, z), 1, value));
                }
            }
        }
    });
    cubes
}

/// What NanoVDB orders values by, and averages.
fn measure<T: Spectrum>(value: T) -> f64 {
    let channel = |c| f64::from(value.channel(c));
    match T::CHANNELS {
        1 => channel(0),
        n => (0..n).map(|c| channel(c) * channel(c)).sum(),
    }
}

struct Checked<'a, T> {
    buffer: &'a [u8],
    places: Places,
    background: T,
    /// Leaves, lower and upper nodes that were met.
    met: [u32; 3],
}

impl<T: Spectrum> Checked<'_, T> {
    fn voxel(&self, at: usize) -> IVec3 {
        IVec3::from([0, 4, 8].map(|i| u32_at(self.buffer, at + i).cast_signed()))
    }

    fn value(&self, at: usize) -> T {
        T::from_channels(|c| f32_at(self.buffer, at + 4 * c))
    }

    /// Extremes to the bit; moments, of which f32 keeps 24 bits, to 1e-6 of the largest value.
    fn statistics(&self, at: usize, cubes: &Cubes<T>) {
        let size = 4 * self.places.channels;
        let stated = [self.value(at), self.value(at + size)];
        let moments = [0, 4].map(|i| f64::from(f32_at(self.buffer, at + 2 * size + i)));
        if cubes.is_empty() {
            assert_eq!((stated, moments), ([self.background; 2], [0.0; 2]));
            return;
        }
        let order =
            |a: &&(IVec3, i32, T), b: &&(IVec3, i32, T)| measure(a.2).total_cmp(&measure(b.2));
        let least = cubes.iter().min_by(order).unwrap().2;
        let most = cubes.iter().max_by(order).unwrap().2;
        assert_eq!(stated.map(measure), [least, most].map(measure));
        let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
            let one = |c: &(IVec3, i32, T)| f(measure(c.2)) * f64::from(c.1).powi(3);
            cubes.iter().map(one).sum()
        };
        let count = sum(&|_| 1.0);
        let mean = sum(&|x| x) / count;
        let deviation = (sum(&|x| (x - mean).powi(2)) / count).sqrt();
        let scale = measure(most).abs().max(measure(least).abs());
        for (stated, exact) in moments.into_iter().zip([mean, deviation]) {
            assert!(
                (stated - exact).abs() <= 1e-6 * scale,
                "{stated} for {exact}"
            );
        }
    }

    /// Box, flags and statistics of the leaf at a place, and the active voxels in it.
    fn leaf(&mut self, at: usize, origin: IVec3, all: &Cubes<T>) {
        self.met[0] += 1;
        let here = inside(all, origin, 8);
        let [first, last] = bounds(&here).unwrap_or([origin; 2]);
        assert_eq!(self.voxel(at), first);
        let extent = (last - first).to_array().map(|x| x as u8);
        assert_eq!(self.buffer[at + 12..at + 15], extent);
        // Bit 0: nothing active; bit 1: there is a box.
        assert_eq!(self.buffer[at + 15], if here.is_empty() { 1 } else { 2 });
        let bits: u32 = self.buffer[at + 16..at + 80]
            .iter()
            .map(|b| b.count_ones())
            .sum();
        assert_eq!(bits as usize, here.len());
        self.statistics(at + 80, &here);
    }

    fn node(&mut self, at: usize, level: usize, origin: IVec3, all: &Cubes<T>) {
        self.met[level] += 1;
        let [statistics, table, size] = self.places.nodes[level - 1];
        let [log2, edge] = [[4, 3], [5, 7]][level - 1];
        let here = inside(all, origin, 1 << (log2 + edge));
        let whole = 1 << (log2 + edge);
        let [first, last] = bounds(&here).unwrap_or([origin + (whole - 1), origin]);
        assert_eq!([self.voxel(at), self.voxel(at + 12)], [first, last]);
        // By which readers find it.
        assert_eq!(self.voxel(at) & !(whole - 1), origin);
        assert_eq!(
            u64_at(self.buffer, at + 24),
            if here.is_empty() { 1 } else { 2 }
        );
        self.statistics(at + statistics, &here);
        let slots = 1_usize << (3 * log2);
        let stride = (size - table) / slots;
        let children = at + 32 + slots / 8;
        for slot in (0..slots).filter(|s| self.buffer[children + s / 8] >> (s % 8) & 1 == 1) {
            let (s, mask) = (slot as i32, (1 << log2) - 1);
            let cell = IVec3::new(s >> (2 * log2), (s >> log2) & mask, s & mask);
            let child = at + u64_at(self.buffer, at + table + stride * slot) as usize;
            let origin = origin + (cell << edge);
            match level {
                1 => self.leaf(child, origin, &here),
                _ => self.node(child, 1, origin, &here),
            }
        }
    }
}

fn inside<T: Copy>(all: &Cubes<T>, origin: IVec3, edge: i32) -> Cubes<T> {
    let is_inside = |c: &&(IVec3, i32, T)| c.0 & !(edge - 1) == origin && c.1 <= edge;
    all.iter().filter(is_inside).copied().collect()
}

fn bounds<T>(cubes: &Cubes<T>) -> Option<[IVec3; 2]> {
    let ends = cubes
        .iter()
        .map(|(first, edge, _)| [*first, *first + (edge - 1)]);
    ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

fn check<T: Spectrum>(grid: &SparseGrid<T>, voxels: Voxels, places: Places) {
    let grids = [VolumeGrid::new("a", GridClass::Unknown, voxels)];
    let file = write(&grids, NanoCodec::None);
    let buffer = &file[buffer_start(&file)..];
    let all = cubes(grid);
    let root = TREE + u64_at(buffer, TREE + 24) as usize;
    let channels = places.channels;
    let mut checked = Checked {
        buffer,
        places,
        background: grid.background(),
        met: [0; 3],
    };
    checked.statistics(root + 28 + 4 * channels, &all);
    let (head, tile) = if channels == 1 { (64, 32) } else { (96, 32) };
    let mut tiles = 0;
    for i in 0..u32_at(buffer, root + 24) as usize {
        let at = root + head + tile * i;
        let key = u64_at(buffer, at);
        let axis = |i: u32| ((key >> (21 * i)) as u32 & 0x1f_ffff) << 12;
        let origin = IVec3::from([2, 1, 0].map(|i| axis(i).cast_signed()));
        match u64_at(buffer, at + 8) {
            0 => tiles += buffer[at + 16],
            child => checked.node(root + child as usize, 2, origin, &all),
        }
    }
    let stated = [0, 1, 2].map(|i| u32_at(buffer, TREE + 32 + 4 * i));
    assert_eq!(checked.met, stated);
    assert!(checked.met.iter().all(|&n| n > 1) && tiles > 0);
}

/// Of every node of grids with leaves and tiles of all sizes, some of them inactive.
#[test]
fn nodes_tell_the_truth() {
    for seed in 0..3 {
        let grid = random::<f32>(seed, 30);
        check(&grid, Voxels::Scalar(grid.clone()), FLOAT);
        let grid = random::<Rgb>(seed + 9, 20);
        check(&grid, Voxels::Vector(grid.clone()), VEC3F);
    }
}
