//! How much memory small files can take: a stated number of times what they have, while they are read
//! and after.

#[path = "scene_io/open_vdb/encoder.rs"]
#[allow(dead_code, reason = "the tests of OpenVDB files use the rest")]
mod encoder;

use cap::Cap;
use encoder::{ACTIVE_MASK, File, Grid, ZIP};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::{DAffine3, IVec3};
use std::alloc::System;
use std::io::Write;
use std::sync::{Mutex, PoisonError};
use tyndall_core::Sampler;
use tyndall_media::{SparseBuilder, TileSize};
use tyndall_scene_io::{
    GridClass, NanoCodec, VolumeGrid, Voxels, read_volume, write_nano_vdb, write_open_vdb,
};
use tyndall_testkit::rng;

/// An allocation beyond the limit ends the run.
#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);
/// Tests share the limit: one at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// What is taken whatever the file: names, messages, the scratch of decompression and one upper
/// node's values.
const BASE: usize = 1 << 20;

/// Reads a file with no more memory than it has bytes, so many `times`, and [`BASE`].
fn read_within(bytes: &[u8], times: usize) -> Result<Vec<VolumeGrid>, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let limit = MEMORY.allocated() + times * bytes.len() + BASE;
    MEMORY.set_limit(limit).unwrap();
    let grids = read_volume(file.path(), |_| true).map_err(|e| e.to_string());
    MEMORY.set_limit(usize::MAX).unwrap();
    grids
}

fn alone() -> impl Drop {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a byte of an OpenVDB file stands for at most:
/// - an active tile is a bit in each of two masks, and in zip next to nothing: 20 bytes of three
///   channels in the making, then 16, 80 for a byte;
/// - a leaf is two masks and a code, 129 bytes, and of three channels 6.2 kB, in room that may be twice
///   too large while it grows: 97.
const OPEN_VDB: usize = 100;

/// The first upper node is full of active tiles, in a few bytes of zip. `roots` of them.
fn tiles(kind: &'static str, channels: usize, roots: i32) -> Vec<u8> {
    let head = Grid {
        kind,
        channels,
        flags: ACTIVE_MASK | ZIP,
        ..Grid::default()
    };
    let whole = File::of(vec![head.clone()]).bytes();
    // Up to the tree, which begins with the number of values of a voxel and the background.
    let map = b"TranslationMap";
    let map = whole.windows(map.len()).position(|w| w == map).unwrap() + map.len() + 24;
    let mut file = whole[..map].to_vec();
    file.extend(1_u32.to_le_bytes());
    file.extend(vec![0; 4 * channels]);
    file.extend([0, roots].into_iter().flat_map(i32::to_le_bytes));
    let mut zip = ZlibEncoder::new(Vec::new(), Compression::best());
    zip.write_all(&vec![1; 32_768 * 4 * channels]).unwrap();
    let zip = zip.finish().unwrap();
    for i in 0..roots {
        file.extend([4096 * i, 0, 0].into_iter().flat_map(i32::to_le_bytes));
        file.extend([0; 4096]);
        file.extend([0xff; 4096]);
        file.push(0);
        file.extend((zip.len() as u64).to_le_bytes());
        file.extend(&zip);
    }
    end_at(&mut file, &whole);
    file
}

/// Corrects where the only grid says that it ends.
fn end_at(file: &mut [u8], whole: &[u8]) {
    let before = (whole.len() as u64).to_le_bytes();
    let at = whole.windows(8).position(|w| w == before).unwrap();
    let end = (file.len() as u64).to_le_bytes();
    file[at..at + 8].copy_from_slice(&end);
}

#[test]
fn tiles_of_a_bit_take_little() {
    let _alone = alone();
    for (kind, channels) in [("Tree_float_5_4_3", 1), ("Tree_vec3s_5_4_3", 3)] {
        let file = tiles(kind, channels, 60);
        let grids = read_within(&file, OPEN_VDB).unwrap();
        let voxels = match &grids[0].voxels {
            Voxels::Scalar(grid) => grid.statistics().voxels,
            Voxels::Vector(grid) => grid.statistics().voxels,
            _ => 0,
        };
        assert_eq!(voxels, 60 * 4096_u64.pow(3));
    }
}

/// Grids that share a tree take what they say of themselves.
#[test]
fn shared_trees_are_held_once() {
    let _alone = alone();
    let mut many = vec![
        Grid {
            parent: "density",
            ..Grid::default()
        };
        20_000
    ];
    many[7] = Grid {
        name: "density",
        ..Grid::default()
    };
    let file = File::of(many).bytes();
    // 200 bytes each in the file; a name, a type, a grid and what was read of them.
    assert_eq!(read_within(&file, 10).unwrap().len(), 20_000);
}

fn cloud(leaves: i32) -> VolumeGrid {
    let mut builder = SparseBuilder::new(0.5_f32);
    for i in 0..leaves {
        builder.voxel(IVec3::new(8 * i, 9, 100), i as f32).unwrap();
    }
    let tile = IVec3::new(4096, 0, 128);
    builder.tile(tile, TileSize::Lower, 2.0, true).unwrap();
    let voxels = Voxels::Scalar(builder.build(DAffine3::IDENTITY).unwrap());
    VolumeGrid::new("density", GridClass::FogVolume, voxels)
}

/// Bits, bytes and words anywhere, and counts that no file can have.
#[test]
fn damaged_files_take_little() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let grids = [cloud(200)];
    write_open_vdb(&path, &grids).unwrap();
    let open = std::fs::read(&path).unwrap();
    write_nano_vdb(&path, &grids, NanoCodec::None).unwrap();
    let nano = std::fs::read(&path).unwrap();
    let mut random = rng(7);
    let mut below = |n: usize| ((f64::from(random.next_1d()) * n as f64) as usize).min(n - 1);
    let numbers = [0, 1, u64::MAX, 1 << 31, 1 << 20, 0x7fff_ffff, 1 << 40];
    for (file, times) in [(open, OPEN_VDB), (nano, NANO_VDB)] {
        for i in 0..1500 {
            let mut file = file.clone();
            for _ in 0..=below(3) {
                let range = [file.len(), 1000, 1500][below(3)];
                let at = below(range.min(file.len()) - 8);
                match below(3) {
                    0 => file[at] ^= 1 << below(8),
                    1 => file[at] = below(256) as u8,
                    _ => file[at..at + 8].copy_from_slice(&numbers[i % 7].to_le_bytes()),
                }
            }
            let _ = read_within(&file, times);
        }
    }
}

/// What a byte of a NanoVDB file that is not packed stands for at most: a leaf of codes of a bit (`FpN`)
/// has 160 bytes and takes 2.1 kB, in room that may be twice too large: 27; and the file itself.
const NANO_VDB: usize = 29;

/// The buffer of a grid of `FpN` whose leaves are of a bit a voxel, as far as its nodes hold.
fn bits(leaves: usize) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    write_nano_vdb(&path, &[cloud(1)], NanoCodec::None).unwrap();
    let mut file = std::fs::read(&path).unwrap();
    let word = |file: &[u8], at: usize| u64::from_le_bytes(file[at..at + 8].try_into().unwrap());
    let start = 16 + 176 + "density\0".len();
    let [leaf, lower] = [0, 1].map(|i| start + 672 + word(&file, start + 672 + 8 * i) as usize);
    file.truncate(leaf);
    file.extend(vec![0; 160 * leaves]);
    file[lower + 32..lower + 1056].fill(0);
    for i in 0..leaves {
        file[lower + 544 + i / 8] |= 1 << (i % 8);
        let offset = (leaf - lower + 160 * i) as u64;
        file[lower + 1088 + 8 * i..][..8].copy_from_slice(&offset.to_le_bytes());
    }
    let size = (file.len() - start) as u64;
    for at in [16, 24, start + 32] {
        file[at..at + 8].copy_from_slice(&size.to_le_bytes());
    }
    for at in [16 + 32, start + 636] {
        file[at..at + 4].copy_from_slice(&16_u32.to_le_bytes());
    }
    file
}

#[test]
fn leaves_of_a_bit_take_little() {
    let _alone = alone();
    let mut file = bits(4096);
    let grids = read_within(&file, NANO_VDB).unwrap();
    let Voxels::Scalar(grid) = &grids[0].voxels else {
        panic!()
    };
    assert_eq!(grid.leaf_count(), 4096);
    // All leaves in one place.
    let lower = 16 + 176 + 8 + 672;
    let lower =
        lower + u64::from_le_bytes(file[lower + 8..lower + 16].try_into().unwrap()) as usize;
    let first = file[lower + 1088..lower + 1096].to_vec();
    for slot in file[lower + 1088..][..8 * 4096].chunks_exact_mut(8) {
        slot.copy_from_slice(&first);
    }
    let why = read_within(&file, NANO_VDB).unwrap_err();
    assert!(why.contains("overlap"), "{why}");
}
