//! Blosc containers of every shape that is read, packed here anew.

use super::round_trip::random;
use super::{as_scalar, content, read, restored, scalar, unzipped, write};
use tyndall_scene_io::NanoCodec;

/// How a container is packed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) element: usize,
    pub(super) block: usize,
    pub(super) shuffled: bool,
    pub(super) split: bool,
}

/// A container, after its length as NanoVDB stores it.
pub(super) fn blosc(bytes: &[u8], shape: Shape) -> Vec<u8> {
    let Shape {
        element,
        block,
        shuffled,
        split,
    } = shape;
    let count = bytes.len().div_ceil(block);
    let mut starts = Vec::new();
    let mut streams = Vec::new();
    for part in bytes.chunks(block) {
        starts.push(16 + 4 * count + streams.len());
        let part = if shuffled {
            shuffle(part, element)
        } else {
            part.to_vec()
        };
        let splits = if split && part.len() == block {
            element
        } else {
            1
        };
        for stream in part.chunks(part.len() / splits) {
            let mut packed = lz4_flex::block::compress(stream);
            if packed.len() >= stream.len() {
                packed = stream.to_vec();
            }
            streams.extend((packed.len() as u32).to_le_bytes());
            streams.extend(packed);
        }
    }
    let flags = u8::from(shuffled) | (u8::from(!split) << 4) | (1 << 5);
    let mut all = vec![2, 1, flags, element as u8];
    let length = 16 + 4 * count + streams.len();
    for n in [bytes.len(), block, length].into_iter().chain(starts) {
        all.extend((n as u32).to_le_bytes());
    }
    all.extend(streams);
    framed(all)
}

pub(super) fn framed(stored: Vec<u8>) -> Vec<u8> {
    let mut all = (stored.len() as u64).to_le_bytes().to_vec();
    all.extend(stored);
    all
}

fn shuffle(bytes: &[u8], element: usize) -> Vec<u8> {
    let whole = bytes.len() / element * element;
    let byte = |i: usize| bytes[..whole].iter().skip(i).step_by(element);
    let shuffled = (0..element).flat_map(byte);
    shuffled.chain(&bytes[whole..]).copied().collect()
}

#[test]
fn blosc_is_unpacked() {
    let grid = random::<f32>(3, 5);
    let file = write(&[scalar("a", grid.clone())], NanoCodec::Zip);
    let buffer = unzipped(&file);
    for (element, block) in [
        (4, 65_536),
        (4, 10_000),
        (8, 4096),
        (1, 32_768),
        (3, 999),
        (16, 64),
    ] {
        for shuffled in [false, true] {
            let shape = Shape {
                element,
                block,
                shuffled,
                split: element > 1 && block % element == 0 && block / element >= 128,
            };
            let file = restored(&file, &blosc(&buffer, shape), 2);
            let back = read(&file).unwrap_or_else(|e| panic!("{shape:?}: {e}"));
            assert_eq!(content(as_scalar(&back[0])), content(&grid), "{shape:?}");
        }
    }
    // Stored as it is.
    let mut copied = vec![2, 1, 2, 4];
    for n in [buffer.len(), buffer.len(), buffer.len() + 16] {
        copied.extend((n as u32).to_le_bytes());
    }
    copied.extend(&buffer);
    let back = read(&restored(&file, &framed(copied), 2)).unwrap();
    assert_eq!(content(as_scalar(&back[0])), content(&grid));
}
