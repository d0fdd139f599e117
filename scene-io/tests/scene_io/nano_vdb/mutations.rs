//! Damaged files end in errors or in grids: never in a panic, never late.

use super::packed::{Shape, blosc};
use super::round_trip::random;
use super::{buffer_start, fixture, read, restored, scalar, unzipped, write};
use glam::{DAffine3, IVec3};
use std::time::{Duration, Instant};
use tyndall_core::Sampler;
use tyndall_media::{SparseBuilder, TileSize};
use tyndall_scene_io::NanoCodec;
use tyndall_testkit::rng;

const MUTATIONS: usize = 10_000;
/// A sound file of these takes a few milliseconds.
const LIMIT: Duration = Duration::from_secs(10);

/// Files of one upper node, in every way of packing, and of every kind of leaf.
fn sources() -> Vec<Vec<u8>> {
    let mut builder = SparseBuilder::new(0.5_f32);
    for i in 0..20 {
        builder.voxel(IVec3::new(i, 9 * i, 100), i as f32).unwrap();
    }
    let tile = IVec3::new(512, 0, 128);
    builder.tile(tile, TileSize::Lower, 2.0, true).unwrap();
    let grid = builder.build(DAffine3::IDENTITY).unwrap();
    let grids = [scalar("smoke", grid.clone()), scalar("heat", random(2, 1))];
    let zipped = write(&[scalar("smoke", grid)], NanoCodec::Zip);
    let shape = Shape {
        element: 4,
        block: 65_536,
        shuffled: true,
        split: true,
    };
    let packed = restored(&zipped, &blosc(&unzipped(&zipped), shape), 2);
    let mut sources = vec![
        write(&grids[..1], NanoCodec::None),
        packed,
        write(&grids, NanoCodec::Zip),
    ];
    for name in ["Fp4", "FpN", "Vec3d"] {
        let file = fixture(name);
        sources.push(restored(&file, &unzipped(&file), 0));
    }
    sources
}

struct Mutator {
    next: Box<dyn FnMut() -> f32>,
}

impl Mutator {
    fn below(&mut self, n: usize) -> usize {
        (((self.next)() as f64 * n as f64) as usize).min(n - 1)
    }

    /// A place in a file: in its headers, where it is not zero, or anywhere.
    fn place(&mut self, file: &[u8]) -> usize {
        match self.below(3) {
            0 => self.below((buffer_start(file) + 1000).min(file.len())),
            1 => {
                let start = self.below(file.len());
                let filled = file[start..].iter().position(|&byte| byte != 0);
                start + filled.unwrap_or(0)
            }
            _ => self.below(file.len()),
        }
    }

    /// Cut off, or with a few bits, numbers or offsets changed.
    fn mutated(&mut self, file: &[u8]) -> Vec<u8> {
        let mut mutated = file.to_vec();
        if self.below(8) == 0 {
            mutated.truncate(self.place(file));
            return mutated;
        }
        for _ in 0..=self.below(3) {
            let at = self.place(file);
            let word = (at & !7).min(file.len() - 8);
            match self.below(3) {
                0 => mutated[at] ^= 1 << self.below(8),
                1 => {
                    let numbers = [0, 1, u64::MAX, 1 << 63, 1 << 31, 1 << 20, i64::MAX as u64];
                    let number = numbers[self.below(numbers.len())];
                    mutated[word..word + 8].copy_from_slice(&number.to_le_bytes());
                }
                _ => {
                    let other = (self.place(file) & !7).min(file.len() - 8);
                    mutated.copy_within(other..other + 8, word);
                }
            }
        }
        mutated
    }
}

#[test]
fn damaged_files_are_errors_or_grids() {
    let mut u = rng(11);
    let mut mutator = Mutator {
        next: Box::new(move || u.next_1d()),
    };
    let sources = sources();
    let mut errors = 0;
    for i in 0..MUTATIONS {
        let file = mutator.mutated(&sources[i % sources.len()]);
        let start = Instant::now();
        if let Err(problem) = read(&file) {
            errors += 1;
            let mend = ["export", "scale no axis", "write it as"];
            assert!(mend.iter().any(|mend| problem.contains(mend)), "{problem}");
            let plain = !problem.contains(char::is_control) && problem.len() < 700;
            assert!(plain, "{problem}");
        }
        assert!(start.elapsed() < LIMIT, "mutation {i}");
    }
    // Most bits are values, which may be anything; but many are not.
    assert!(errors > MUTATIONS / 10 && errors < MUTATIONS, "{errors}");
}
