//! Mitsuba's `.vol` files: a regular grid of 32-bit floats.

use crate::image_out::write_whole;
use crate::open::open;
use crate::volume::write_dense;
use crate::{Error, VolumeGrid};
use glam::DVec3;
use std::io::Read;
use std::path::Path;

/// The contents of a `.vol` file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Volume {
    /// Voxels in each axis.
    pub resolution: [usize; 3],
    /// Values a voxel.
    pub channels: usize,
    /// The box that the file names: smallest and largest corner.
    pub bounds: [DVec3; 2],
    /// x fastest, then y, then z; the channels of a voxel together.
    pub values: Vec<f32>,
}

const HEADER: usize = 48;

/// Reads a `.vol` file of Mitsuba 3: `VOL`, version 3, then little-endian: encoding 1 (`float32`),
/// resolution in x, y and z, channels (five `i32`), the box (six `f32`), the values.
///
/// With one channel, `resolution` and `values` are what `DenseGrid::new` of `tyndall-media` takes.
///
/// Source: documentation of `gridvolume`, Mitsuba 3.
///
/// # Errors
/// [`Error::Read`] if the file cannot be read, [`Error::Build`] if it is not such a file.
pub fn read_vol(path: &Path) -> Result<Volume, Error> {
    let unreadable = |source| Error::Read {
        path: path.to_owned(),
        source,
    };
    let wrong = |problem| Error::Build {
        path: path.to_owned(),
        problem,
    };
    let (mut file, length) = open(path)?;
    let Some(length) = length.checked_sub(HEADER as u64) else {
        return Err(wrong(format!(
            "{length} bytes are no .vol file: write it again"
        )));
    };
    let mut header = [0; HEADER];
    file.read_exact(&mut header).map_err(unreadable)?;
    let (mut volume, size) = parse(&header, length).map_err(wrong)?;
    let mut bytes = vec![0; size];
    file.read_exact(&mut bytes).map_err(unreadable)?;
    volume.values = (bytes.chunks_exact(4))
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    Ok(volume)
}

/// Writes a grid as a `.vol` file, as [`read_vol`] reads it: all that is not background, with one voxel
/// of it around, in 32-bit floats; names, and which voxels are active, are lost. What was at `path`
/// before stays if writing fails.
///
/// # Errors
/// [`Error::Write`] if the file cannot be written, or the grid is a level set, was not read, is all
/// background, would have more than 2³² voxels, is turned, sheared or mirrored, or lies so far from the
/// origin that its box rounds to another by 1 % of a voxel.
pub fn write_vol(path: &Path, grid: &VolumeGrid) -> Result<(), Error> {
    write_whole(path, |out| write_dense(out, grid))
}

/// What stands before the values.
pub(crate) fn header(
    resolution: [usize; 3],
    channels: usize,
    bounds: [[f32; 3]; 2],
) -> [u8; HEADER] {
    let mut header = [0; HEADER];
    header[..4].copy_from_slice(b"VOL\x03");
    let [x, y, z] = resolution;
    let counts = [1, x, y, z, channels].map(|n| (n as i32).to_le_bytes());
    let corners = bounds.as_flattened().iter().map(|x| x.to_le_bytes());
    let words = header[4..].chunks_exact_mut(4);
    for (word, bytes) in words.zip(counts.into_iter().chain(corners)) {
        word.copy_from_slice(&bytes);
    }
    header
}

/// What a header says of the `length` bytes after it, which are not read yet, and their number.
fn parse(header: &[u8; HEADER], length: u64) -> Result<(Volume, usize), String> {
    if &header[..3] != b"VOL" || header[3] != 3 {
        return Err("no .vol file of version 3: write it with Mitsuba 3".into());
    }
    let word = |i: usize| {
        let at = 4 + 4 * i;
        [header[at], header[at + 1], header[at + 2], header[at + 3]]
    };
    let encoding = i32::from_le_bytes(word(0));
    if encoding != 1 {
        return Err(format!(
            "encoding {encoding} is not read: write float32 (1)"
        ));
    }
    let counts = [1, 2, 3, 4].map(|i| usize::try_from(i32::from_le_bytes(word(i))).unwrap_or(0));
    let size = counts.iter().try_fold(4_usize, |n, &m| n.checked_mul(m));
    let [x, y, z, channels] = counts;
    let Some(size) = size.filter(|&n| n > 0 && n as u64 == length) else {
        return Err(format!(
            "the header promises {x} × {y} × {z} voxels of {channels} floats, {length} bytes follow: the file is cut off or not a .vol file, write it again"
        ));
    };
    let corner = |i| f64::from(f32::from_le_bytes(word(i)));
    let volume = Volume {
        resolution: [x, y, z],
        channels,
        bounds: [
            DVec3::new(corner(5), corner(6), corner(7)),
            DVec3::new(corner(8), corner(9), corner(10)),
        ],
        values: Vec::new(),
    };
    Ok((volume, size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// A file as Mitsuba writes it.
    fn file(resolution: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        for word in [1, resolution[0], resolution[1], resolution[2], channels] {
            bytes.extend(word.to_le_bytes());
        }
        for x in [-1.0_f32, -2.0, -3.0, 1.0, 2.0, 3.0].iter().chain(values) {
            bytes.extend(x.to_le_bytes());
        }
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Volume, String> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(bytes).unwrap();
        read_vol(file.path()).map_err(|e| e.to_string())
    }

    #[test]
    fn reads_what_mitsuba_writes() {
        let values: Vec<_> = (0..24).map(|i| i as f32).collect();
        let voxels = read(&file([4, 3, 2], 1, &values)).unwrap();
        assert_eq!(voxels.resolution, [4, 3, 2]);
        assert_eq!(voxels.bounds[1], DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(voxels.values, values);
    }

    #[test]
    fn broken_files_are_errors() {
        let good = file([2, 2, 2], 3, &[0.5; 24]);
        assert!(read(&good).is_ok());
        assert!(
            read(&good[..good.len() - 1])
                .unwrap_err()
                .contains("cut off")
        );
        assert!(read(&good[..20]).is_err());
        assert!(read(b"PK").is_err());
        for (byte, value) in [(0, b'W'), (3, 2), (4, 2), (8, 0), (11, 0x80)] {
            let mut bad = good.clone();
            bad[byte] = value;
            assert!(read(&bad).is_err(), "byte {byte}");
        }
        // 2⁶² floats: their bytes are 2⁶⁴, which is 0 in 64 bits.
        let huge = file([1 << 16, 1 << 16, 1 << 15], 1 << 15, &[]);
        assert!(read(&huge).unwrap_err().contains("cut off"));
    }
}
