//! Samples of chosen channels, read within what the file can hold.

use super::channels::Selection;
use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::{compute_chunk_count, header::Header};
use exr::prelude::f16;
use std::collections::BTreeMap;
use std::io::{Read, Seek};

/// Bytes that any file may ask for.
const FREE: u64 = 1 << 26;

/// Bytes of pixels that a byte of a file may ask for beyond: deflate compresses to 1/1032 at most,
/// and samples of 16 bits become 32.
const COMPRESSION: u64 = 2064;

/// Bytes of an entry in the table of chunks.
const OFFSET: u64 = 8;

/// One plane a channel, by the channel's index.
pub(super) struct Planes(BTreeMap<usize, Vec<f32>>);

impl Planes {
    pub(super) fn take(&mut self, channels: &[usize]) -> Vec<Vec<f32>> {
        channels.iter().map(|&c| self.take_one(c)).collect()
    }

    pub(super) fn take_one(&mut self, channel: usize) -> Vec<f32> {
        self.0.remove(&channel).unwrap_or_default()
    }
}

/// Reads the selected channels of a file of `length` bytes.
pub(super) fn read(
    reader: Reader<impl Read + Seek>,
    length: u64,
    selection: &Selection,
) -> Result<Planes, String> {
    for header in reader.headers() {
        check_chunks(header, length)?;
    }
    let header = &reader.headers()[selection.part];
    let wanted: Vec<_> = selection.channels().collect();
    check_size(header, length, wanted.len())?;
    let size = header.layer_size;
    let types: BTreeMap<_, _> = (wanted.iter())
        .map(|&c| (c, header.channels.list[c].sample_type))
        .collect();
    // What no chunk fills stays NaN, and is counted by who looks.
    let plane = || vec![f32::NAN; size.area()];
    let mut planes: BTreeMap<_, _> = wanted.iter().map(|&c| (c, plane())).collect();
    let mut pixels = 0;
    let chunks = reader.filter_chunks(true, |_, tile, block| {
        block.layer == selection.part && tile.level_index == Vec2(0, 0)
    });
    let damaged = |e: exr::error::Error| format!("is damaged or cut off: {e}: copy it again");
    (chunks.map_err(damaged)?)
        .decompress_sequential(false, |meta, block| {
            pixels += block.index.pixel_size.area();
            for line in block.lines(&meta.headers[selection.part].channels) {
                let channel = line.location.channel;
                if let Some(plane) = planes.get_mut(&channel) {
                    fill(plane, size.width(), &line, types[&channel])?;
                }
            }
            Ok(())
        })
        .map_err(damaged)?;
    if pixels != size.area() {
        return Err(format!(
            "is damaged or cut off: it holds {pixels} of its {} pixels: copy it again",
            size.area()
        ));
    }
    Ok(Planes(planes))
}

/// The table of chunks must be in the file, and as long as the pixels need.
fn check_chunks(header: &Header, length: u64) -> Result<(), String> {
    let needed = compute_chunk_count(header.compression, header.layer_size, header.blocks);
    if needed != header.chunk_count || needed as u64 > length / OFFSET {
        return Err(format!(
            "is damaged or cut off: {} × {} pixels need {needed} chunks: copy it again",
            header.layer_size.width(),
            header.layer_size.height()
        ));
    }
    Ok(())
}

fn check_size(header: &Header, length: u64, planes: usize) -> Result<(), String> {
    if header
        .channels
        .list
        .iter()
        .any(|c| c.sampling != Vec2(1, 1))
    {
        return Err("has channels of fewer pixels than the picture: write R, G, B".into());
    }
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let a_pixel = (header.channels.bytes_per_pixel).max(planes * size_of::<f32>());
    let bytes = width as u128 * height as u128 * a_pixel as u128;
    if bytes > u128::from(FREE.max(length.saturating_mul(COMPRESSION))) {
        return Err(format!(
            "is damaged or cut off: it promises {width} × {height} pixels of {a_pixel} bytes, and has {length} bytes: copy it again"
        ));
    }
    Ok(())
}

/// Copies a line of a block to its place.
fn fill(
    plane: &mut [f32],
    width: usize,
    line: &LineRef<'_>,
    samples: SampleType,
) -> exr::error::UnitResult {
    let Vec2(x, y) = line.location.position;
    let start = y * width + x;
    let target = plane.get_mut(start..start + line.location.sample_count);
    let target = target.ok_or(exr::error::Error::Invalid(
        "a block lies beside the picture".into(),
    ))?;
    match samples {
        SampleType::F32 => {
            for (to, from) in target.iter_mut().zip(line.read_samples::<f32>()) {
                *to = from?;
            }
        }
        SampleType::F16 => {
            for (to, from) in target.iter_mut().zip(line.read_samples::<f16>()) {
                *to = from?.to_f32();
            }
        }
        SampleType::U32 => {
            for (to, from) in target.iter_mut().zip(line.read_samples::<u32>()) {
                *to = from? as f32;
            }
        }
    }
    Ok(())
}
