//! What both writers of volumes refuse.

use glam::DAffine3;
use std::path::Path;
use tyndall_media::SparseBuilder;
use tyndall_scene_io::{
    Error, GridClass, NanoCodec, VolumeGrid, Voxels, read_volume, write_nano_vdb, write_open_vdb,
};

type Writer = fn(&Path, &[VolumeGrid]) -> Result<(), Error>;

const WRITERS: [(&str, Writer); 2] = [
    ("a.vdb", write_open_vdb),
    ("a.nvdb", |path, grids| {
        write_nano_vdb(path, grids, NanoCodec::Zip)
    }),
];

fn grid(name: &str) -> VolumeGrid {
    let voxels = SparseBuilder::new(0.5_f32).build(DAffine3::IDENTITY);
    let voxels = Voxels::Scalar(voxels.unwrap());
    VolumeGrid::new(name, GridClass::FogVolume, voxels)
}

/// Neither writes what the other does not, and what was there stays.
#[test]
fn what_cannot_be_written_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let unread = VolumeGrid::new("heat", GridClass::Unknown, Voxels::Unread);
    let long = "x".repeat(256);
    let cases: [(&[VolumeGrid], &str); 6] = [
        (&[], "no grid to write: name one"),
        (
            &[grid("a"), unread],
            "grid `heat`: its voxels were not read: ask",
        ),
        (&[grid(&long)], "256 bytes: give it one of at most 255"),
        (&[grid(&"ä".repeat(128))], "256 bytes"),
        (&[grid("a\0b")], "grid `a\u{fffd}b`: its name"),
        (&[grid("a\x1eb")], "grid `a\u{fffd}b`: its name"),
    ];
    for (file, write) in WRITERS {
        let path = folder.path().join(file);
        for (grids, problem) in cases {
            let e = write(&path, grids).unwrap_err().to_string();
            assert!(e.contains(problem) && e.contains(file), "{e}");
            assert!(!path.exists());
        }
        std::fs::write(&path, "before").unwrap();
        assert!(write(&path, &[]).is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"before");
    }
}

#[test]
fn other_names_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let names = [&"x".repeat(255), "", "a b", "ä\n", "density", "density"];
    let grids = names.map(grid);
    for (file, write) in WRITERS {
        let path = folder.path().join(file);
        write(&path, &grids).unwrap();
        let back = read_volume(&path, |name| name.len() == 255).unwrap();
        let read = back.iter().map(|grid| grid.name.as_str());
        assert_eq!(read.collect::<Vec<_>>(), names);
        assert!(matches!(back[0].voxels, Voxels::Scalar(_)));
    }
}
