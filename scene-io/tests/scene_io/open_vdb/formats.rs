//! What files may be: versions, compressions, types, transforms, several grids.

use super::encoder::{ACTIVE_MASK, BACKGROUND, BLOSC, File, Grid, Number, ZIP, voxel};
use super::read_bytes;
use glam::{DAffine3, DMat3, DVec3, IVec3};
use std::io::Write;
use tyndall_core::Spectrum;
use tyndall_media::{Precision, SparseGrid};
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels, read_volume};

fn one(file: &File) -> VolumeGrid {
    let mut grids = read_bytes(&file.bytes()).unwrap_or_else(|e| panic!("{e}: {file:?}"));
    assert_eq!(grids.len(), 1);
    grids.remove(0)
}

fn error(grid: Grid) -> String {
    read_bytes(&File::of(vec![grid]).bytes()).unwrap_err()
}

/// It holds what the encoder writes, of which inactive values may be `masked` out.
fn check<T: Spectrum>(grid: &SparseGrid<T>, code: u8, masked: bool) {
    let value = |x: f32| T::from_channels(|c| x + c as f32);
    assert_eq!(grid.background(), value(BACKGROUND));
    for slot in 0..512_usize {
        let [x, y, z] = [slot >> 6, slot >> 3 & 7, slot & 7].map(|i| i as i32);
        let mut expected = value(voxel(slot, code));
        if masked && voxel(slot, code) == -BACKGROUND {
            // Minus the background is so in every channel.
            expected = value(BACKGROUND).map(|x| -x);
        }
        let at = IVec3::new(x, y, 16 + z);
        assert_eq!(grid.voxel(at), expected, "slot {slot}");
    }
    assert_eq!(grid.voxel(IVec3::new(7, 7, 15)), value(0.75));
    assert_eq!(grid.voxel(IVec3::new(127, 0, 255)), value(0.5));
    assert_eq!(grid.voxel(IVec3::new(8191, 4095, -1)), value(0.25));
    assert_eq!(grid.voxel(IVec3::new(8, 0, 0)), value(BACKGROUND));
    let active = 256 + 8_u64.pow(3) + 128_u64.pow(3) + 4096_u64.pow(3);
    assert_eq!(grid.statistics().voxels, active);
}

/// Versions, compressions, kinds of inactive values, types, with and without offsets.
#[test]
fn all_formats_are_read() {
    let kinds = [
        ("Tree_float_5_4_3", Number::Single, 1),
        ("Tree_float_5_4_3_HalfFloat", Number::Single, 1),
        ("Tree_half_5_4_3", Number::Half, 1),
        ("Tree_half_5_4_3_HalfFloat", Number::Half, 1),
        ("Tree_double_5_4_3", Number::Double, 1),
        ("Tree_double_5_4_3_HalfFloat", Number::Double, 1),
        ("Tree_vec3s_5_4_3", Number::Single, 3),
        ("Tree_vec3s_5_4_3_HalfFloat", Number::Single, 3),
        ("Tree_vec3d_5_4_3", Number::Double, 3),
    ];
    let compressions = [0, ZIP, BLOSC, ZIP | BLOSC];
    let masks = [0, ACTIVE_MASK];
    let flags: Vec<u32> = (compressions.iter().flat_map(|c| masks.map(|m| c | m))).collect();
    for (i, (kind, number, channels)) in kinds.into_iter().enumerate() {
        for &flags in &flags {
            for code in 0..=6 {
                let version = 222 + (i as u32 + flags + u32::from(code)) % 4;
                let file = File {
                    version,
                    offsets: code % 2 == 0,
                    grids: vec![Grid {
                        kind,
                        flags,
                        code,
                        number,
                        channels,
                        ..Grid::default()
                    }],
                };
                let grid = one(&file);
                assert_eq!(
                    (grid.name.as_str(), grid.class),
                    ("density", GridClass::FogVolume)
                );
                let masked = flags & ACTIVE_MASK != 0;
                match &grid.voxels {
                    Voxels::Scalar(voxels) => {
                        check(voxels, code, masked);
                        let half = kind.contains("alf");
                        assert_eq!(voxels.precision() == Precision::Half, half);
                    }
                    Voxels::Vector(voxels) => check(voxels, code, masked),
                    _ => panic!("{file:?}"),
                }
            }
        }
    }
}

#[test]
fn transforms_are_those_of_the_file() {
    let s = [2.0, -3.0, 4.0];
    let t = [5.0, 6.0, 7.0];
    let derived = [0.5; 12];
    let scale = DVec3::from(s);
    let scaled = DAffine3::from_scale(scale);
    let both = DAffine3::from_translation(t.into()) * scaled;
    let rows = [
        2.0, 1.0, 0.0, 0.0, 0.5, 3.0, 0.0, 0.0, 0.0, 0.25, 4.0, 0.0, 5.0, 6.0, 7.0, 1.0,
    ];
    let affine = DAffine3 {
        matrix3: DMat3::from_cols_array(&[2.0, 1.0, 0.0, 0.5, 3.0, 0.0, 0.0, 0.25, 4.0]),
        translation: t.into(),
    };
    for (map, expected) in [
        (("UniformScaleMap", [&s[..], &derived].concat()), scaled),
        (("ScaleMap", [&s[..], &derived].concat()), scaled),
        (
            ("TranslationMap", t.to_vec()),
            DAffine3::from_translation(t.into()),
        ),
        (("ScaleTranslateMap", [&t[..], &s, &derived].concat()), both),
        (
            ("UniformScaleTranslateMap", [&t[..], &s, &derived].concat()),
            both,
        ),
        (("AffineMap", rows.to_vec()), affine),
        (("UnitaryMap", rows.to_vec()), affine),
    ] {
        let file = File::of(vec![Grid {
            map,
            ..Grid::default()
        }]);
        let Voxels::Scalar(voxels) = one(&file).voxels else {
            panic!("{file:?}");
        };
        assert_eq!(voxels.to_world(), expected, "{:?}", file.grids[0].map);
    }
}

#[test]
fn what_is_not_read_is_named() {
    let projective = (0..16).map(f64::from).collect();
    for (map, mend) in [
        (("NonlinearFrustumMap", vec![0.0; 40]), "resample"),
        (("WarpMap", vec![]), "`WarpMap`"),
        (("AffineMap", projective), "not affine"),
        (("ScaleMap", vec![0.0; 15]), "no inverse"),
        (("ScaleMap", vec![f64::NAN; 15]), "no inverse"),
    ] {
        let why = error(Grid {
            map,
            ..Grid::default()
        });
        assert!(why.contains("`density`") && why.contains(mend), "{why}");
    }
    for (kind, name) in [
        ("Tree_bool_5_4_3", "`bool`"),
        ("Tree_int32_5_4_3", "`int32`"),
        ("Tree_int64_5_4_3", "`int64`"),
        ("Tree_string_5_4_3", "`string`"),
        ("Tree_mask_5_4_3", "`mask`"),
        ("Tree_ptdataidx32_5_4_3", "`ptdataidx32`"),
        ("Tree_float_5_4_4", "`float_5_4_4`"),
        ("Tree_float_4_3", "`float_4_3`"),
    ] {
        let file = File::of(vec![Grid {
            kind,
            ..Grid::default()
        }]);
        let why = read_bytes(&file.bytes()).unwrap_err();
        assert!(
            why.contains(name) && why.contains("`density`") && why.contains("export"),
            "{why}"
        );
        let mut path = tempfile::NamedTempFile::new().unwrap();
        path.write_all(&file.bytes()).unwrap();
        let grids = read_volume(path.path(), |_| false).unwrap();
        assert!(matches!(grids[0].voxels, Voxels::Unread));
        assert_eq!(format!("`{}`", grids[0].kind), name);
    }
    let why = error(Grid {
        flags: 8,
        ..Grid::default()
    });
    assert!(why.contains("0x8") && why.contains("zip"), "{why}");
    for version in [0, 221, 226, u32::MAX] {
        let file = File {
            version,
            ..File::of(vec![Grid::default()])
        };
        let why = read_bytes(&file.bytes()).unwrap_err();
        assert!(
            why.contains(&version.to_string()) && why.contains("222 to 225"),
            "{why}"
        );
    }
}

/// Several grids, some of one name, some that share a tree, before or after it.
#[test]
fn grids_share_trees() {
    let shared = |name, parent, x| Grid {
        name,
        parent,
        map: ("TranslationMap", vec![x, 0.0, 0.0]),
        ..Grid::default()
    };
    for offsets in [true, false] {
        let file = File {
            offsets,
            ..File::of(vec![
                shared("density\x1e1", "density\x1e0", 9.0),
                Grid {
                    name: "density\x1e0",
                    ..Grid::default()
                },
                shared("other", "density\x1e0", 8.0),
            ])
        };
        let grids = read_bytes(&file.bytes()).unwrap();
        for (grid, (name, x)) in
            grids
                .iter()
                .zip([("density", 9.0), ("density", 1.0), ("other", 8.0)])
        {
            assert_eq!(grid.name, name);
            let Voxels::Scalar(voxels) = &grid.voxels else {
                panic!()
            };
            check(voxels, 0, true);
            assert_eq!(voxels.to_world().translation.x, x);
        }
    }
    // Of what is not there, of another that shares, or of itself.
    for parent in ["nowhere", "b", "a"] {
        let grids = vec![
            shared("a", parent, 0.0),
            shared("b", "c", 0.0),
            Grid::default(),
        ];
        let why = read_bytes(&File::of(grids).bytes())
            .err()
            .unwrap_or_default();
        assert!(
            why.contains("grid `a`: it shares") && why.contains(parent),
            "{why}"
        );
    }
    // They hold one tree, which is read once.
    let mut many = vec![shared("a", "density", 0.0); 2000];
    many.push(Grid::default());
    let grids = read_bytes(&File::of(many).bytes()).unwrap();
    assert_eq!(grids.len(), 2001);
    let Voxels::Scalar(last) = &grids[1999].voxels else {
        panic!()
    };
    check(last, 0, true);
}

/// Of a file that does not say where grids end, one that is not read hides those behind it.
#[test]
fn streams_are_read_as_far_as_they_can_be() {
    let mask = Grid {
        name: "mask",
        kind: "Tree_bool_5_4_3",
        ..Grid::default()
    };
    let stream = |grids| File {
        offsets: false,
        ..File::of(grids)
    };
    let read = |file: &File, wanted: &dyn Fn(&str) -> bool| {
        let path = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(path.path(), file.bytes()).unwrap();
        read_volume(path.path(), wanted).map_err(|e| e.to_string())
    };
    let last = stream(vec![Grid::default(), mask.clone()]);
    let grids = read(&last, &|name| name == "density").unwrap();
    let Voxels::Scalar(density) = &grids[0].voxels else {
        panic!()
    };
    check(density, 0, true);
    assert_eq!((grids.len(), grids[1].name.as_str()), (2, "mask"));
    assert!(grids[1].unsupported.is_some());
    let why = read(&last, &|_| true).unwrap_err();
    assert!(why.contains("grid `mask`: it is of type `bool`"), "{why}");
    let first = stream(vec![mask, Grid::default()]);
    let why = read(&first, &|name| name == "density").unwrap_err();
    assert!(
        why.contains("grid `mask`") && why.contains("with offsets") && why.contains("hides 1"),
        "{why}"
    );
}

/// OpenVDB takes the mask that is written with the voxels of a leaf.
#[test]
fn the_second_mask_of_a_leaf_counts() {
    let mut file = File::of(vec![Grid::default()]).bytes();
    let mask = [0x55; 64];
    let first = file.windows(64).position(|bytes| bytes == mask).unwrap();
    file[first..first + 64].fill(0xff);
    let grids = read_bytes(&file).unwrap();
    let Voxels::Scalar(voxels) = &grids[0].voxels else {
        panic!()
    };
    check(voxels, 0, true);
}

/// Background beyond halves, or between them: the grid is kept in single precision, to the bit.
#[test]
fn precision_is_that_of_the_file_where_it_loses_nothing() {
    let precision = |kind| {
        let file = File::of(vec![Grid {
            kind,
            ..Grid::default()
        }]);
        let mut bytes = file.bytes();
        let [before, after] = [1.5_f32, 0.1].map(f32::to_le_bytes);
        let at = bytes.windows(4).position(|word| word == before).unwrap();
        let exact = read_bytes(&bytes).unwrap();
        bytes[at..at + 4].copy_from_slice(&after);
        let odd = read_bytes(&bytes).unwrap();
        [exact, odd].map(|grids| match &grids[0].voxels {
            Voxels::Scalar(voxels) => (voxels.precision(), voxels.background()),
            _ => panic!(),
        })
    };
    let (half, single) = (Precision::Half, Precision::Single);
    let expected = [(half, 1.5), (single, 0.1)];
    assert_eq!(precision("Tree_float_5_4_3_HalfFloat"), expected);
    assert_eq!(
        precision("Tree_float_5_4_3"),
        [(single, 1.5), (single, 0.1)]
    );
}
