//! What lies in a file: segments of grids, or grids alone.

use super::layout::grid;
use super::{GRID_MAGIC, MAGIC, MAJOR};
use crate::volume::bytes::Bytes;
use crate::volume::message::in_grid;

/// Bytes at the head of a segment: magic, version, number of grids, codec.
pub(super) const HEADER: usize = 16;
/// Bytes of the description of a grid, which its name follows.
pub(super) const DESCRIPTION: usize = 176;

/// Where things stand in the description of a grid.
pub(super) mod description {
    pub(crate) const SIZE: usize = 0;
    pub(crate) const STORED: usize = 8;
    pub(crate) const NAME_KEY: usize = 16;
    pub(crate) const VOXELS: usize = 24;
    pub(crate) const TYPE: usize = 32;
    pub(crate) const CLASS: usize = 36;
    pub(crate) const WORLD_BOX: usize = 40;
    pub(crate) const INDEX_BOX: usize = 88;
    pub(crate) const VOXEL_SIZE: usize = 112;
    pub(crate) const NAME_LENGTH: usize = 136;
    /// Leaves, lower nodes, upper nodes, roots.
    pub(crate) const NODES: usize = 140;
    pub(crate) const TILES: usize = 156;
    pub(crate) const CODEC: usize = 168;
    pub(crate) const VERSION: usize = 172;
}

/// A grid of a file, as it is stored.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    pub(super) name: String,
    pub(super) kind: u32,
    pub(super) class: u32,
    /// Bytes of its buffer.
    pub(super) size: usize,
    pub(super) codec: u16,
    pub(super) stored: &'a [u8],
}

/// All grids of a file.
pub(super) fn entries(bytes: &[u8]) -> Result<Vec<Entry<'_>>, String> {
    let bytes = Bytes(bytes);
    let is_buffer = bytes.0.starts_with(GRID_MAGIC)
        || (check_version(bytes.u32(8)?).is_err()
            && check_version(bytes.u32(grid::VERSION)?).is_ok());
    let mut entries = Vec::new();
    let mut at = 0;
    while at < bytes.0.len() {
        if !bytes.slice(at, MAGIC.len())?.starts_with(MAGIC) {
            return Err(format!(
                "what begins at byte {at} is no NanoVDB: the file is damaged, export it again"
            ));
        }
        at = if is_buffer {
            buffer(bytes, at, &mut entries)?
        } else {
            segment(bytes, at, &mut entries)?
        };
    }
    Ok(entries)
}

/// Whether a file of this version has the layout that we know.
pub(super) fn check_version(version: u32) -> Result<(), String> {
    let (major, minor) = (version >> 21, (version >> 10) & 0x7ff);
    if major == MAJOR {
        return Ok(());
    }
    let mend = if major < MAJOR {
        "export it again with OpenVDB 9 or later"
    } else {
        "it is newer than what is read, write it as .vdb with its own tools"
    };
    Err(format!(
        "it is of NanoVDB {major}.{minor}, not {MAJOR}: {mend}"
    ))
}

/// A grid without a description, and where it ends.
fn buffer<'a>(bytes: Bytes<'a>, at: usize, entries: &mut Vec<Entry<'a>>) -> Result<usize, String> {
    let header = Bytes(bytes.slice(at, grid::END)?);
    let size = header.size(grid::SIZE)?.max(grid::END);
    let name = header.text(grid::NAME, grid::NAME_LENGTH)?;
    let stored = bytes.slice(at, size);
    entries.push(Entry {
        kind: header.u32(grid::TYPE)?,
        class: header.u32(grid::CLASS)?,
        size,
        codec: 0,
        stored: stored.map_err(|problem| in_grid(name.as_bytes(), problem))?,
        name,
    });
    Ok(at + size)
}

/// The grids of a segment, and where it ends.
fn segment<'a>(bytes: Bytes<'a>, at: usize, entries: &mut Vec<Entry<'a>>) -> Result<usize, String> {
    let header = Bytes(bytes.slice(at, HEADER)?);
    check_version(header.u32(8)?)?;
    let (count, codec) = (header.u16(12)?, header.u16(14)?);
    let mut at = at + HEADER;
    let mut described = Vec::new();
    for _ in 0..count {
        let about = Bytes(bytes.slice(at, DESCRIPTION)?);
        let length = about.u32(description::NAME_LENGTH)? as usize;
        let entry = Entry {
            name: bytes.text(at + DESCRIPTION, length)?,
            kind: about.u32(description::TYPE)?,
            class: about.u32(description::CLASS)?,
            size: about.size(description::SIZE)?,
            codec,
            stored: &[],
        };
        described.push((entry, about.size(description::STORED)?));
        at += DESCRIPTION + length;
    }
    for (mut entry, length) in described {
        let stored = bytes.slice(at, length);
        entry.stored = stored.map_err(|problem| in_grid(entry.name.as_bytes(), problem))?;
        entries.push(entry);
        at += length;
    }
    Ok(at)
}
