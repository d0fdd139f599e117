//! Files byte by byte, of any version, compression and type, as far as OpenVDB's own module does not
//! write them.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;
use std::io::Write;

pub(crate) const ZIP: u32 = 1;
pub(crate) const ACTIVE_MASK: u32 = 2;
pub(crate) const BLOSC: u32 = 4;
pub(crate) const BACKGROUND: f32 = 1.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    Half,
    Single,
    Double,
}

/// A file of one or more grids.
#[derive(Clone, Debug)]
pub(crate) struct File {
    pub(crate) version: u32,
    pub(crate) offsets: bool,
    pub(crate) grids: Vec<Grid>,
}

#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) name: &'static str,
    pub(crate) kind: &'static str,
    /// The name of the grid whose tree it shares.
    pub(crate) parent: &'static str,
    pub(crate) flags: u32,
    /// How inactive values are written.
    pub(crate) code: u8,
    pub(crate) number: Number,
    pub(crate) channels: usize,
    pub(crate) map: (&'static str, Vec<f64>),
    /// Whether there is some that no library knows.
    pub(crate) metadata: bool,
}

impl Default for Grid {
    fn default() -> Self {
        Self {
            name: "density",
            kind: "Tree_float_5_4_3",
            parent: "",
            flags: ACTIVE_MASK | ZIP,
            code: 0,
            number: Number::Single,
            channels: 1,
            map: ("TranslationMap", vec![1.0, 2.0, 3.0]),
            metadata: true,
        }
    }
}

impl File {
    pub(crate) fn of(grids: Vec<Grid>) -> Self {
        Self {
            version: 224,
            offsets: true,
            grids,
        }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut out = b" BDV\0\0\0\0".to_vec();
        for word in [self.version, 8, 1] {
            out.extend(word.to_le_bytes());
        }
        out.push(self.offsets.into());
        out.extend(b"00000000-0000-0000-0000-000000000000");
        out.extend(1_u32.to_le_bytes());
        metadata("future", "type of no library", &[7; 5], &mut out);
        out.extend((self.grids.len() as u32).to_le_bytes());
        for grid in &self.grids {
            grid.encode(self.offsets, &mut out);
        }
        out
    }
}

impl Grid {
    fn encode(&self, offsets: bool, out: &mut Vec<u8>) {
        for text in [self.name, self.kind, self.parent] {
            string(text.as_bytes(), out);
        }
        let at = out.len();
        out.extend([0; 24]);
        let start = out.len();
        out.extend(self.flags.to_le_bytes());
        out.extend(if self.metadata { 5_u32 } else { 3 }.to_le_bytes());
        metadata("class", "string", b"fog volume", out);
        let name = self.name.split('\x1e').next().unwrap();
        metadata("name", "string", name.as_bytes(), out);
        let half = self.kind.ends_with("_HalfFloat");
        metadata("is_saved_as_half_float", "bool", &[half.into()], out);
        if self.metadata {
            metadata("file_delayed_load", "__delayedload", &[1; 77], out);
            metadata("odd", "", &[], out);
        }
        string(self.map.0.as_bytes(), out);
        out.extend(self.map.1.iter().flat_map(|x| x.to_le_bytes()));
        if self.parent.is_empty() {
            self.tree(out);
        }
        if offsets {
            let ends = [start, start, out.len()].map(|end| (end as u64).to_le_bytes());
            out[at..start].copy_from_slice(ends.as_flattened());
        }
    }

    /// Tiles of 4096³, 128³ and 8³ voxels, a leaf of which nothing is active, and one.
    fn tree(&self, out: &mut Vec<u8>) {
        out.extend(1_u32.to_le_bytes());
        self.value(BACKGROUND, self.number, out);
        out.extend([1_u32, 1].into_iter().flat_map(u32::to_le_bytes));
        out.extend([4096, 0, -4096].into_iter().flat_map(i32::to_le_bytes));
        self.value(0.25, self.number, out);
        out.push(1);
        out.extend([0; 12]);
        for (slots, children, tile) in [(32_usize.pow(3), 1, 0.5), (16_usize.pow(3), 5, 0.75)] {
            // A child in the first slot, the tile in the second, of lower nodes a child in the third.
            for word in [children, 2] {
                let mut mask = vec![0; slots / 8];
                mask[0] = word;
                out.extend(mask);
            }
            let mut values = vec![BACKGROUND; slots];
            values[1] = tile;
            self.values(&values, |slot| slot == 1, 0, out);
        }
        let mask = [0x55; 64];
        let off = [0; 64];
        out.extend([off, mask, off].as_flattened());
        self.values(&[BACKGROUND; 512], |_| false, 0, out);
        out.extend(mask);
        let values: Vec<_> = (0..512).map(|slot| voxel(slot, self.code)).collect();
        self.values(&values, |slot| slot % 2 == 0, self.code, out);
    }

    fn values(&self, values: &[f32], active: impl Fn(usize) -> bool, code: u8, out: &mut Vec<u8>) {
        out.push(code);
        let others: &[f32] = match code {
            2 | 4 => &[7.0],
            5 => &[7.0, 9.0],
            _ => &[],
        };
        for other in others {
            self.value(*other, self.number, out);
        }
        if (3..=5).contains(&code) {
            let is_second = |slot: usize| u8::from(inactive(slot, code) == inactive(3, code));
            let byte = |first: usize| (0..8).map(|bit| is_second(first + bit) << bit).sum::<u8>();
            out.extend((0..values.len() / 8).map(|i| byte(8 * i)));
        }
        let all = self.flags & ACTIVE_MASK == 0 || code == 6;
        // OpenVDB writes halves that are saved as halves as if they were not.
        let half = self.kind.ends_with("_HalfFloat") && self.number != Number::Half;
        let number = if half { Number::Half } else { self.number };
        let mut bytes = Vec::new();
        for (slot, value) in values.iter().enumerate() {
            if all || active(slot) {
                self.value(*value, number, &mut bytes);
            }
        }
        // Of none, halves have no block.
        if !(half && bytes.is_empty()) {
            self.block(&bytes, out);
        }
    }

    /// Channels are value, value + 1, …
    fn value(&self, value: f32, number: Number, out: &mut Vec<u8>) {
        for c in 0..self.channels {
            let x = value + c as f32;
            match number {
                Number::Half => out.extend(f16::from_f32(x).to_le_bytes()),
                Number::Single => out.extend(x.to_le_bytes()),
                Number::Double => out.extend(f64::from(x).to_le_bytes()),
            }
        }
    }

    fn block(&self, bytes: &[u8], out: &mut Vec<u8>) {
        let packed = if self.flags & BLOSC != 0 {
            // Not compressed, in a container.
            let mut packed = vec![2, 1, 2, 4];
            for word in [bytes.len(), bytes.len(), bytes.len() + 16] {
                packed.extend((word as u32).to_le_bytes());
            }
            packed.extend(bytes);
            packed
        } else if self.flags & ZIP != 0 {
            let mut zip = ZlibEncoder::new(Vec::new(), Compression::best());
            zip.write_all(bytes).unwrap();
            zip.finish().unwrap()
        } else {
            out.extend(bytes);
            return;
        };
        out.extend((packed.len() as i64).to_le_bytes());
        out.extend(packed);
    }
}

/// What a slot of the leaf holds.
pub(crate) fn voxel(slot: usize, code: u8) -> f32 {
    if slot.is_multiple_of(2) {
        slot as f32
    } else {
        inactive(slot, code)
    }
}

/// What it holds if it is inactive.
fn inactive(slot: usize, code: u8) -> f32 {
    let second = slot % 4 == 3;
    match code {
        1 => -BACKGROUND,
        2 => 7.0,
        3 if !second => -BACKGROUND,
        4 | 5 if !second => 7.0,
        5 => 9.0,
        6 => slot as f32 / 4.0,
        _ => BACKGROUND,
    }
}

pub(crate) fn string(text: &[u8], out: &mut Vec<u8>) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text);
}

fn metadata(name: &str, kind: &str, value: &[u8], out: &mut Vec<u8>) {
    for text in [name.as_bytes(), kind.as_bytes(), value] {
        string(text, out);
    }
}
