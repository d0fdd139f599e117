//! Writes files of version 224: grids of float, half or vec3s, with their active values in zip, which
//! every build of OpenVDB reads.

mod nodes;
mod values;

use super::codec::{ACTIVE_MASK, ZIP};
use super::grid::{HALF_SUFFIX, SEPARATOR, class_name};
use super::{MAGIC, is_half, map};
use crate::volume::message::{UNREAD, in_grid};
use crate::volume::{VolumeGrid, Voxels};
use nodes::Nodes;
use tyndall_core::Spectrum;
use tyndall_media::{Precision, SparseGrid};
use values::Values;

const VERSION: u32 = 224;
/// The first library to write this version as we do.
const LIBRARY: [u32; 2] = [5, 0];
/// Where the name of a file begins, and what stands there until it is known.
const UUID_AT: usize = 21;
const UUID: &[u8] = b"00000000-0000-0000-0000-000000000000";

/// The bytes of a file with these grids, or why one cannot be written.
pub(in crate::volume) fn write(grids: &[VolumeGrid]) -> Result<Vec<u8>, String> {
    let mut out = MAGIC.to_vec();
    for word in [VERSION, LIBRARY[0], LIBRARY[1]] {
        out.extend(word.to_le_bytes());
    }
    out.push(1); // Grids say where they end.
    out.extend(UUID);
    out.extend(1_u32.to_le_bytes());
    metadata("creator", "string", b"tyndall", &mut out);
    out.extend((grids.len() as u32).to_le_bytes());
    for (i, grid) in grids.iter().enumerate() {
        let same = |other: &&VolumeGrid| other.name == grid.name;
        let mut unique = grid.name.clone().into_bytes();
        match grids[..i].iter().filter(same).count() {
            0 => {}
            before => {
                unique.push(SEPARATOR);
                unique.extend(before.to_string().bytes());
            }
        }
        match &grid.voxels {
            Voxels::Scalar(voxels) => write_grid(grid, &unique, "float", voxels, &mut out),
            Voxels::Vector(voxels) => write_grid(grid, &unique, "vec3s", voxels, &mut out),
            Voxels::Unread => return Err(in_grid(grid.name.as_bytes(), UNREAD)),
        }
    }
    let uuid = uuid(&out);
    out[UUID_AT..UUID_AT + UUID.len()].copy_from_slice(uuid.as_bytes());
    Ok(out)
}

/// A name for a file, by which OpenVDB tells whether it has changed: a hash of its other bytes, of
/// version 8 (RFC 9562). The same grids give the same bytes.
fn uuid(bytes: &[u8]) -> String {
    let hash = blake3::hash(bytes);
    let mut id: [u8; 16] = std::array::from_fn(|i| hash.as_bytes()[i]);
    id[6] = 0x80 | (id[6] & 0x0f);
    id[8] = 0x80 | (id[8] & 0x3f);
    let hex = |bytes: &[u8]| -> String { bytes.iter().map(|b| format!("{b:02x}")).collect() };
    [&id[..4], &id[4..6], &id[6..8], &id[8..10], &id[10..]]
        .map(hex)
        .join("-")
}

fn write_grid<T: Spectrum>(
    grid: &VolumeGrid,
    unique: &[u8],
    kind: &str,
    voxels: &SparseGrid<T>,
    out: &mut Vec<u8>,
) {
    let nodes = Nodes::of(voxels);
    let half = voxels.precision() == Precision::Half && nodes.constants().all(is_half);
    let mut kind = format!("Tree_{kind}_5_4_3").into_bytes();
    if half {
        kind.extend(HALF_SUFFIX);
    }
    for text in [unique, &kind, b""] {
        string(text, out);
    }
    let offsets = out.len();
    out.extend([0; 24]);
    let start = out.len();
    out.extend((ACTIVE_MASK | ZIP).to_le_bytes());
    out.extend((2 + u32::from(half)).to_le_bytes());
    metadata("class", "string", class_name(grid.class).as_bytes(), out);
    if half {
        metadata("is_saved_as_half_float", "bool", &[1], out);
    }
    metadata("name", "string", grid.name.as_bytes(), out);
    map::write(voxels.to_world(), out);
    let mut values = Values::new(voxels.background(), half, out);
    nodes.write_topology(&mut values);
    let blocks = values.written();
    nodes.write_voxels(&mut values);
    let ends = [start, blocks, out.len()].map(|at| (at as u64).to_le_bytes());
    out[offsets..start].copy_from_slice(ends.as_flattened());
}

pub(super) fn string(text: &[u8], out: &mut Vec<u8>) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text);
}

fn metadata(name: &str, kind: &str, value: &[u8], out: &mut Vec<u8>) {
    for text in [name.as_bytes(), kind.as_bytes(), value] {
        string(text, out);
    }
}
