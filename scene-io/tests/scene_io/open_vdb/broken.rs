//! Files that are cut off, or whose bits are not what they were.

use super::encoder::{ACTIVE_MASK, BLOSC, File, Grid, Number, ZIP};
use super::read_bytes;
use tyndall_core::Sampler;
use tyndall_scene_io::write_open_vdb;
use tyndall_testkit::rng;

const MUTATIONS: usize = 10_000;

fn files() -> Vec<Vec<u8>> {
    let grid = |flags, kind, number, channels| Grid {
        flags,
        kind,
        number,
        channels,
        code: 5,
        ..Grid::default()
    };
    let shared = Grid {
        name: "other",
        parent: "density",
        ..Grid::default()
    };
    let (single, double) = (Number::Single, Number::Double);
    let grids = [
        vec![
            grid(ACTIVE_MASK | ZIP, "Tree_float_5_4_3", single, 1),
            shared,
        ],
        vec![grid(
            ACTIVE_MASK | BLOSC,
            "Tree_vec3s_5_4_3_HalfFloat",
            single,
            3,
        )],
        vec![grid(ACTIVE_MASK, "Tree_double_5_4_3", double, 1)],
        vec![grid(ZIP, "Tree_vec3d_5_4_3", double, 3)],
    ];
    let stream = File {
        offsets: false,
        ..File::of(grids[0].clone())
    };
    let whole = grids.into_iter().map(File::of);
    let mut files: Vec<_> = whole.chain([stream]).map(|file| file.bytes()).collect();
    // What this crate writes of them.
    for i in [0, 1] {
        let file = tempfile::NamedTempFile::new().unwrap();
        write_open_vdb(file.path(), &read_bytes(&files[i]).unwrap()).unwrap();
        files.push(std::fs::read(file.path()).unwrap());
    }
    files
}

/// That an error is one line with a mend.
fn check_message(why: &str) {
    let mends = ["export", "scale no axis", "write"];
    assert!(mends.iter().any(|mend| why.contains(mend)), "{why}");
    assert!(!why.contains(char::is_control) && why.len() < 700, "{why}");
}

/// Bits, bytes and words anywhere, more of them in the heads; some are cut off too.
#[test]
fn mutations_end_in_errors_or_grids() {
    let files = files();
    let mut random = rng(2026);
    let mut below = |n: usize| ((f64::from(random.next_1d()) * n as f64) as usize).min(n - 1);
    let (mut good, mut bad) = (0, 0);
    for i in 0..MUTATIONS {
        let mut file = files[i % files.len()].clone();
        for _ in 0..=below(4) {
            let range = [file.len(), 400, 1000][below(3)];
            let at = below(range.min(file.len() - 4));
            match below(4) {
                0 => file[at] ^= 1 << below(8),
                1 => file[at] = below(256) as u8,
                2 => file[at..at + 4].copy_from_slice(&[0xff; 4]),
                _ => {
                    let from_end = file.len() - 1 - at;
                    file[from_end] ^= 1 << below(8);
                }
            }
        }
        if below(4) == 0 {
            file.truncate(below(file.len()));
        }
        match read_bytes(&file) {
            Ok(_) => good += 1,
            Err(why) => {
                check_message(&why);
                bad += 1;
            }
        }
    }
    // Neither is rare: else the mutations show nothing.
    assert!(
        good > MUTATIONS / 20 && bad > MUTATIONS / 20,
        "{good}, {bad}"
    );
}

#[test]
fn files_that_are_cut_off_say_so() {
    for file in files() {
        for length in (8..file.len()).step_by(97) {
            let why = read_bytes(&file[..length]).unwrap_err();
            assert!(why.contains("cut off"), "{length}: {why}");
        }
        let why = read_bytes(&file[..7]).unwrap_err();
        assert!(why.contains("neither"), "{why}");
    }
}
