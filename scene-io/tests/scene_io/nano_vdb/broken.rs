//! What is not read is one clear error.

use super::packed::{Shape, blosc, framed};
use super::round_trip::random;
use super::{
    HEADER, TREE, as_scalar, buffer_start, content, fixture, read, read_wanted, restored, scalar,
    u32_at, u64_at, unzipped, write,
};
use glam::{DAffine3, IVec3};
use tyndall_media::{SparseBuilder, SparseGrid};
use tyndall_scene_io::{NanoCodec, Voxels};

fn one_voxel() -> SparseGrid<f32> {
    let mut builder = SparseBuilder::new(0.0);
    builder.voxel(IVec3::ZERO, 1.0).unwrap();
    builder.build(DAffine3::IDENTITY).unwrap()
}

/// A file of one voxel, not packed, and where its buffer begins.
fn small() -> (Vec<u8>, usize) {
    let file = write(&[scalar("smoke", one_voxel())], NanoCodec::None);
    let buffer = buffer_start(&file);
    (file, buffer)
}

fn patched(file: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    file[at..at + bytes.len()].copy_from_slice(bytes);
    file
}

/// That a file is an error which says all of this.
#[track_caller]
fn fails(file: &[u8], says: &[&str]) {
    let problem = read(file).unwrap_err();
    for part in says {
        assert!(problem.contains(part), "{problem}");
    }
}

#[test]
fn types_without_use_are_named() {
    fails(
        &fixture("int32"),
        &["grid `int32`", "type int32", "export it as float"],
    );
    let unread = read_wanted(&fixture("int32"), |_| false).unwrap();
    assert!(matches!(unread[0].voxels, Voxels::Unread));
    assert_eq!(unread[0].kind, "int32");
    let (file, _) = small();
    for code in (0..30_u32).filter(|code| ![1, 2, 6, 7, 13, 14, 15, 16].contains(code)) {
        let file = patched(&file, HEADER + 32, &code.to_le_bytes());
        fails(
            &file,
            &["grid `smoke`", &format!("({code})"), "export it as float"],
        );
    }
    let contradiction = patched(&file, HEADER + 32, &2_u32.to_le_bytes());
    fails(
        &contradiction,
        &["grid `smoke`", "described as double and holds float"],
    );
}

#[test]
fn other_versions_and_codecs_are_named() {
    let (file, buffer) = small();
    for (major, mend) in [(31_u32, "export it again"), (33, "newer")] {
        let version = (major << 21).to_le_bytes();
        fails(
            &patched(&file, 8, &version),
            &[&format!("NanoVDB {major}.0"), mend],
        );
        let inner = patched(&file, buffer + 16, &version);
        fails(&inner, &["grid `smoke`", &format!("NanoVDB {major}.0")]);
    }
    fails(
        &patched(&file, 14, &[7, 0]),
        &["grid `smoke`", "compression 7"],
    );
    fails(
        &patched(&file, buffer, b"NanoXXX"),
        &["grid `smoke`", "no NanoVDB grid"],
    );
    let flat = patched(&file, buffer + 296 + 88, &[0; 72]);
    fails(&flat, &["grid `smoke`", "no inverse"]);
    let mut trailing = file.clone();
    trailing.extend([0; 40]);
    fails(&trailing, &["what begins at byte"]);
}

#[test]
fn other_blosc_is_named() {
    let (file, start) = small();
    let shape = Shape {
        element: 4,
        block: 65_536,
        shuffled: true,
        split: false,
    };
    let stored = blosc(&file[start..], shape);
    for (flags, says) in [(4, "shuffled by bits"), (0x80, "Zstandard"), (0, "BloscLZ")] {
        let file = restored(&file, &patched(&stored, 8 + 2, &[flags]), 2);
        fails(&file, &["grid `smoke`", says, "export it"]);
    }
    let tiny = framed(vec![0; 3]);
    fails(&restored(&file, &tiny, 2), &["grid `smoke`", "damaged"]);
}

#[test]
fn claims_beyond_the_file_are_refused() {
    let (file, start) = small();
    let zipped = write(&[scalar("smoke", one_voxel())], NanoCodec::Zip);
    for size in [1_u64 << 28, 1 << 40, u64::MAX] {
        fails(
            &patched(&zipped, HEADER, &size.to_le_bytes()),
            &["grid `smoke`", "cannot hold"],
        );
        fails(
            &patched(&file, HEADER, &size.to_le_bytes()),
            &["grid `smoke`", "cut off"],
        );
        let stored = patched(&file, HEADER + 8, &size.to_le_bytes());
        fails(&stored, &["grid `smoke`", "cut off"]);
    }
    // A stream that is longer or shorter than claimed.
    let size = u64_at(&zipped, HEADER);
    for size in [size - 1, size + 1] {
        fails(
            &patched(&zipped, HEADER, &size.to_le_bytes()),
            &["does not hold"],
        );
    }
    // A name, then more grids and root tiles than there are.
    let long = patched(&file, HEADER + 136, &u32::MAX.to_le_bytes());
    fails(&long, &["cut off"]);
    fails(&patched(&file, 12, &[255; 2]), &["cut off"]);
    let tiles = start + TREE + 64 + 24;
    assert_eq!(u32_at(&file, tiles), 1);
    fails(&patched(&file, tiles, &[255; 4]), &["grid `smoke`"]);
}

/// All slots of a node lead to the same child: 4096 leaves, or 2²⁷, of a file that holds one.
#[test]
fn shared_nodes_are_refused() {
    let (file, start) = small();
    let place = |i: usize| start + TREE + u64_at(&file, start + TREE + 8 * i) as usize;
    let [lower, upper] = [place(1), place(2)];
    let share = |file: &mut [u8], node: usize, slots: usize, table: usize| {
        let child = file[node + table..node + table + 8].to_vec();
        file[node + 32 + slots / 8..][..slots / 8].fill(255);
        for slot in file[node + table..][..8 * slots].chunks_exact_mut(8) {
            slot.copy_from_slice(&child);
        }
    };
    let mut shared = file.clone();
    share(&mut shared, lower, 4096, 1088);
    fails(&shared, &["grid `smoke`", "overlap"]);
    share(&mut shared, upper, 32_768, 8256);
    fails(&shared, &["grid `smoke`", "overlap"]);
}

/// Two lower nodes that share bytes, and one that is not where nodes may begin.
#[test]
fn overlapping_nodes_are_refused() {
    let (file, start) = small();
    let upper = start + TREE + u64_at(&file, start + TREE + 16) as usize;
    let masks = upper + 32 + 4096;
    let table = upper + 8256;
    // Of the voxel (0, 0, 0).
    assert_eq!(file[masks] & 3, 1);
    let first = u64_at(&file, table);
    for (off, says) in [
        (0, "overlap"),
        (32, "overlap"),
        (-32, "overlap"),
        (8, "multiple of 32"),
    ] {
        let offset = first.checked_add_signed(off).unwrap().to_le_bytes();
        let second = patched(&patched(&file, masks, &[3]), table + 8, &offset);
        // Room for a node that reaches further.
        let mut second = [second, vec![0; 32]].concat();
        for at in [HEADER, HEADER + 8, start + 32] {
            let size = (u64_at(&file, at) + 32).to_le_bytes();
            second[at..at + 8].copy_from_slice(&size);
        }
        fails(&second, &["grid `smoke`", says]);
    }
}

/// What files call grids stays one short line.
#[test]
fn names_are_shown_plainly() {
    let name = format!("\x1b[31mred\n{}", "x".repeat(200));
    let file = write(&[scalar(&name, one_voxel())], NanoCodec::None);
    let start = buffer_start(&file);
    let segment = patched(&file, start + 16, &[0; 4]);
    let cut = file[..file.len() - 1].to_vec();
    let bare = file[start..file.len() - 1].to_vec();
    for file in [segment, cut, bare] {
        let problem = read(&file).unwrap_err();
        let line = "grid `\u{fffd}[31mred\u{fffd}xxx";
        assert!(problem.starts_with(line), "{problem}");
        let plain = !problem.contains(char::is_control) && problem.len() < 300;
        assert!(plain, "{problem}");
    }
}

/// Of a segment of several grids: all descriptions, then all buffers.
fn spliced(files: [&[u8]; 2]) -> Vec<u8> {
    let [(a, b), (c, d)] = files.map(|file| file[HEADER..].split_at(buffer_start(file) - HEADER));
    let mut all = [&files[0][..HEADER], a, c, b, d].concat();
    all[12] = 2;
    all
}

#[test]
fn segments_hold_several_grids() {
    for codec in [NanoCodec::None, NanoCodec::Zip] {
        let grids = [random::<f32>(3, 4), random::<f32>(4, 2)];
        let names = ["a longer name", "b"];
        let files = [0, 1].map(|i| write(&[scalar(names[i], grids[i].clone())], codec));
        let file = spliced([&files[0], &files[1]]);
        let back = read(&[file.clone(), file].concat()).unwrap();
        assert_eq!(back.len(), 4);
        for (i, back) in back.iter().enumerate() {
            assert_eq!(back.name, names[i % 2]);
            assert_eq!(content(as_scalar(back)), content(&grids[i % 2]));
        }
    }
}

/// Blind data lie behind the nodes of a grid, and are its last bytes.
#[test]
fn blind_data_are_passed_over() {
    let grids = [random::<f32>(5, 3), random::<f32>(6, 3)];
    let files = [0, 1].map(|i| write(&[scalar("a", grids[i].clone())], NanoCodec::None));
    let blind = files.each_ref().map(|file| {
        let start = buffer_start(file);
        let buffer = &file[start..];
        let mut with = [buffer, &[0xab; 320]].concat();
        let length = with.len() as u64;
        let metadata = buffer.len() as u64;
        with[32..40].copy_from_slice(&length.to_le_bytes());
        with[640..648].copy_from_slice(&metadata.to_le_bytes());
        with[648..652].copy_from_slice(&1_u32.to_le_bytes());
        let mut file = restored(file, &with, 0);
        file[HEADER..HEADER + 8].copy_from_slice(&length.to_le_bytes());
        file
    });
    let bare = blind.each_ref().map(|file| &file[buffer_start(file)..]);
    for file in [
        blind.concat(),
        spliced([&blind[0], &blind[1]]),
        bare.concat(),
    ] {
        let back = read(&file).unwrap();
        assert_eq!(back.len(), 2);
        for (back, grid) in back.iter().zip(&grids) {
            assert_eq!(content(as_scalar(back)), content(grid));
        }
    }
}

/// As versions from 32.6 on write them.
#[test]
fn later_magics_and_bare_buffers_are_read() {
    let grid = random::<f32>(9, 3);
    let file = write(&[scalar("smoke", grid.clone())], NanoCodec::Zip);
    let buffer = unzipped(&file);
    let segments = patched(&file, 7, b"2");
    let bare = patched(&buffer, 7, b"1");
    let two = [bare.clone(), bare.clone()].concat();
    for (file, count) in [(segments, 1), (bare, 1), (buffer, 1), (two, 2)] {
        let back = read(&file).unwrap();
        assert_eq!(back.len(), count);
        for back in &back {
            assert_eq!((back.name.as_str(), back.kind.as_str()), ("smoke", "float"));
            assert_eq!(content(as_scalar(back)), content(&grid));
        }
    }
}
