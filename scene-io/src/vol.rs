//! Mitsuba's `.vol` files: a regular grid of 32-bit floats.

use crate::Error;
use glam::DVec3;
use std::path::Path;

/// The contents of a `.vol` file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Voxels {
    /// Voxels in each axis.
    pub(crate) resolution: [usize; 3],
    /// Values a voxel.
    pub(crate) channels: usize,
    /// The box that the file names: smallest and largest corner.
    pub(crate) bounds: [DVec3; 2],
    /// x fastest, then y, then z; the channels of a voxel together.
    pub(crate) values: Vec<f32>,
}

const HEADER: usize = 48;

/// Reads a `.vol` file: `VOL`, version 3, then little-endian: encoding 1 (`float32`), resolution
/// in x, y and z, channels (five `i32`), the box (six `f32`), the values.
///
/// Source: documentation of `gridvolume`, Mitsuba 3.
pub(crate) fn read(path: &Path) -> Result<Voxels, Error> {
    let bytes = std::fs::read(path).map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })?;
    parse(&bytes).map_err(|problem| Error::Build {
        path: path.to_owned(),
        problem,
    })
}

fn parse(bytes: &[u8]) -> Result<Voxels, String> {
    let Some((header, data)) = bytes.split_at_checked(HEADER) else {
        return Err(format!("{} bytes are no .vol file", bytes.len()));
    };
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
    let total = counts.iter().try_fold(1_usize, |n, &m| n.checked_mul(m));
    let values: Vec<f32> = (data.chunks_exact(4))
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    let [x, y, z, channels] = counts;
    if total.is_none_or(|n| n == 0 || n * 4 != data.len()) {
        let found = data.len();
        return Err(format!(
            "the header promises {x} × {y} × {z} voxels of {channels} floats, {found} bytes follow: the file is cut off or not a .vol file"
        ));
    }
    let corner = |i| f64::from(f32::from_le_bytes(word(i)));
    Ok(Voxels {
        resolution: [x, y, z],
        channels,
        bounds: [
            DVec3::new(corner(5), corner(6), corner(7)),
            DVec3::new(corner(8), corner(9), corner(10)),
        ],
        values,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn reads_what_mitsuba_writes() {
        let values: Vec<_> = (0..24).map(|i| i as f32).collect();
        let voxels = parse(&file([4, 3, 2], 1, &values)).unwrap();
        assert_eq!(voxels.resolution, [4, 3, 2]);
        assert_eq!(voxels.bounds[1], DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(voxels.values, values);
    }

    #[test]
    fn broken_files_are_errors() {
        let good = file([2, 2, 2], 3, &[0.5; 24]);
        assert!(parse(&good).is_ok());
        assert!(
            parse(&good[..good.len() - 1])
                .unwrap_err()
                .contains("cut off")
        );
        assert!(parse(&good[..20]).is_err());
        assert!(parse(b"PK").is_err());
        for (byte, value) in [(0, b'W'), (3, 2), (4, 2), (8, 0), (11, 0x80)] {
            let mut bad = good.clone();
            bad[byte] = value;
            assert!(parse(&bad).is_err(), "byte {byte}");
        }
    }
}
