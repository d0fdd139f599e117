//! NanoVDB files: those of others, our own, broken ones.

mod broken;
mod mutations;
mod nodes;
mod others;
mod packed;
mod round_trip;

use flate2::read::ZlibDecoder;
use glam::{DAffine3, IVec3};
use std::io::Read;
use tyndall_core::Spectrum;
use tyndall_media::{Piece, SparseGrid};
use tyndall_scene_io::{GridClass, NanoCodec, VolumeGrid, Voxels, read_volume, write_nano_vdb};

/// Bytes of a header, and of a description without the name.
const HEADER: usize = 16;
const DESCRIPTION: usize = 176;
/// Where the tree begins in a buffer.
const TREE: usize = 672;

/// Reads all grids of a file of these bytes.
fn read(bytes: &[u8]) -> Result<Vec<VolumeGrid>, String> {
    read_wanted(bytes, |_| true)
}

fn read_wanted(bytes: &[u8], wanted: impl Fn(&str) -> bool) -> Result<Vec<VolumeGrid>, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let prefix = format!("{}: ", file.path().display());
    read_volume(file.path(), wanted).map_err(|e| {
        let message = e.to_string();
        let problem = message.strip_prefix(&prefix);
        problem.expect("the message names the file").to_owned()
    })
}

fn write(grids: &[VolumeGrid], codec: NanoCodec) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grids.nvdb");
    write_nano_vdb(&path, grids, codec).unwrap();
    std::fs::read(path).unwrap()
}

fn scalar(name: &str, grid: SparseGrid<f32>) -> VolumeGrid {
    VolumeGrid::new(name, GridClass::FogVolume, Voxels::Scalar(grid))
}

fn as_scalar(grid: &VolumeGrid) -> &SparseGrid<f32> {
    match &grid.voxels {
        Voxels::Scalar(grid) => grid,
        _ => panic!("{} is not scalar", grid.name),
    }
}

/// All that is in a grid, as bits.
#[derive(Debug, PartialEq)]
struct Content {
    to_world: DAffine3,
    background: Vec<u32>,
    /// First voxel, edge, whether active, values.
    pieces: Vec<(IVec3, i32, [u64; 8], Vec<u32>)>,
}

fn bits<T: Spectrum>(value: T) -> impl Iterator<Item = u32> {
    (0..T::CHANNELS).map(move |c| value.channel(c).to_bits())
}

fn content<T: Spectrum>(grid: &SparseGrid<T>) -> Content {
    let mut pieces = Vec::new();
    grid.visit(|origin, piece| {
        pieces.push(match piece {
            Piece::Leaf { leaf, active } => {
                let values = grid.leaf_values(leaf).flat_map(bits).collect();
                (origin, 0, *active, values)
            }
            Piece::Tile { edge, tile } => {
                let active = [tile.active.into(); 8];
                (origin, edge, active, bits(tile.value).collect())
            }
        });
    });
    Content {
        to_world: grid.to_world(),
        background: bits(grid.background()).collect(),
        pieces,
    }
}

/// Numbers of a file.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_bits(u32_at(bytes, at))
}

fn f64_at(bytes: &[u8], at: usize) -> f64 {
    f64::from_bits(u64_at(bytes, at))
}

/// Where the buffer of the only grid of a file begins.
fn buffer_start(file: &[u8]) -> usize {
    HEADER + DESCRIPTION + u32_at(file, HEADER + 136) as usize
}

/// The buffer of the only grid of a file that is packed by zip.
fn unzipped(file: &[u8]) -> Vec<u8> {
    let mut buffer = Vec::new();
    let packed = &file[buffer_start(file) + 8..];
    ZlibDecoder::new(packed).read_to_end(&mut buffer).unwrap();
    buffer
}

/// The same file with what is stored in place of the buffer, and its codec.
fn restored(file: &[u8], stored: &[u8], codec: u16) -> Vec<u8> {
    let mut file = file[..buffer_start(file)].to_vec();
    file[14..16].copy_from_slice(&codec.to_le_bytes());
    file[HEADER + 8..HEADER + 16].copy_from_slice(&(stored.len() as u64).to_le_bytes());
    file.extend_from_slice(stored);
    file
}

fn fixture(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scene_io/nano_vdb");
    std::fs::read(format!("{folder}/{name}.nvdb")).unwrap()
}
