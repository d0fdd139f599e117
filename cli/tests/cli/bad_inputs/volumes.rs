//! Volumes: what cannot be inspected, converted or rendered.

use super::case::Case;
use super::scene::{GOOD, broken};
use crate::support::volumes::{colour, density, placed, plane, vdb, vol, with_integers};
use glam::{DAffine3, IVec3};
use tyndall_media::{SparseBuilder, TileSize};
use tyndall_scene_io::{GridClass, VolumeGrid, Voxels};

/// A density and a level set.
fn cloud() -> Vec<u8> {
    vdb(&[density(placed()), plane()])
}

fn one(grid: SparseBuilder) -> Vec<u8> {
    let grid = grid.build(DAffine3::IDENTITY).expect("a grid");
    let grid = VolumeGrid::new("density", GridClass::LevelSet, Voxels::Scalar(grid));
    vdb(&[grid])
}

/// A level set that is `value` in one voxel.
fn voxel(background: f32, value: f32) -> Vec<u8> {
    let mut grid = SparseBuilder::new(background);
    grid.voxel(IVec3::new(1, 2, 3), value).expect("a place");
    one(grid)
}

fn case(name: &'static str, command: &'static str, code: i32, words: &'static str) -> Case {
    Case::new(name, command, code, words).file("cloud.vdb", cloud())
}

pub(crate) fn good() -> [Case; 2] {
    [
        case("a volume", "inspect cloud.vdb", 0, ""),
        case(
            "another volume",
            "volume convert cloud.vdb -o b.vol --fog --grid surface",
            0,
            "",
        ),
    ]
}

pub(crate) fn cases() -> Vec<Case> {
    [
        command_lines(),
        files(),
        grids(),
        values(),
        outputs(),
        media(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn command_lines() -> Vec<Case> {
    vec![
        case(
            "an override of a volume",
            "inspect cloud.vdb --set film.width=3",
            2,
            "`--set` … cloud.vdb is a volume … leave it out",
        ),
        case(
            "no output of a conversion",
            "volume convert cloud.vdb",
            2,
            "not provided … --output",
        ),
        case(
            "an output without an extension",
            "volume convert cloud.vdb -o cloud",
            2,
            "cloud … --output … name it OUT.vdb, OUT.nvdb or OUT.vol",
        ),
        case(
            "an image as output of a conversion",
            "volume convert cloud.vdb -o cloud.exr",
            2,
            "cloud.exr … --output … name it OUT.vdb",
        ),
        case(
            "halves in a NanoVDB file",
            "volume convert cloud.vdb -o b.nvdb --half",
            2,
            "`--half` … b.nvdb … leave it out",
        ),
        case(
            "a dense grid of a dense grid",
            "volume convert a.vol -o b.VOL",
            2,
            "`--output` … a.vol … copy it",
        ),
    ]
}

fn files() -> Vec<Case> {
    let whole = cloud();
    let half = whole[..whole.len() / 2].to_vec();
    let inspect = |name, words| Case::new(name, "inspect smoke.vdb", 3, words);
    vec![
        inspect("no volume", "smoke.vdb … cannot be read … check the name"),
        inspect(
            "a folder as volume",
            "smoke.vdb … cannot be read … name a file",
        )
        .file("smoke.vdb/", ""),
        inspect("half a volume", "smoke.vdb … cut off … export it again")
            .file("smoke.vdb", half.clone()),
        inspect(
            "a text as volume",
            "smoke.vdb … neither an OpenVDB nor a NanoVDB … export it",
        )
        .file("smoke.vdb", "smoke"),
        Case::new(
            "a text as dense volume",
            "inspect smoke.vol",
            3,
            "smoke.vol … no .vol file … write it again",
        )
        .file("smoke.vol", "smoke"),
        Case::new(
            "half a dense volume",
            "inspect smoke.vol",
            3,
            "smoke.vol … cut off … write it again",
        )
        .file("smoke.vol", &vol([2, 2, 2], 1, &[0.5; 8])[..60]),
        case(
            "nothing to convert",
            "volume convert smoke.nvdb -o b.vdb",
            3,
            "smoke.nvdb … cannot be read … check the name",
        ),
        case(
            "half a volume to convert",
            "volume convert smoke.vdb -o b.vdb",
            3,
            "smoke.vdb … cut off … export it again",
        )
        .file("smoke.vdb", half),
        case(
            "a scene to convert",
            "volume convert scene.toml -o b.vdb",
            3,
            "scene.toml … neither an OpenVDB nor a NanoVDB … export it",
        )
        .file("scene.toml", GOOD),
        case(
            "a dense volume of two channels",
            "volume convert a.vol -o b.vdb",
            3,
            "a.vol … 2 channels … write one of 1 or 3",
        )
        .file("a.vol", vol([1, 1, 1], 2, &[0.5; 2])),
        case(
            "a dense volume with NaN",
            "volume convert a.vol -o b.vdb",
            3,
            "a.vol … voxel [0, 1, 0] … NaN … make it finite",
        )
        .file("a.vol", vol([1, 2, 1], 1, &[0.5, f32::NAN])),
    ]
}

fn grids() -> Vec<Case> {
    vec![
        case(
            "no such grid",
            "volume convert cloud.vdb -o b.vdb --grid density --grid surfaec",
            3,
            "cloud.vdb … no grid `surfaec` … did you mean `surface`?",
        ),
        case(
            "no grid of a name like this",
            "volume convert cloud.vdb -o b.vdb --grid temperature",
            3,
            "cloud.vdb … no grid `temperature` … choose one of `density`, `surface`",
        ),
        case(
            "two grids in a dense file",
            "volume convert cloud.vdb -o b.vol --fog",
            3,
            "cloud.vdb … `density`, `surface` … choose it with `--grid`",
        ),
        case(
            "a level set in a dense file",
            "volume convert cloud.vdb -o b.vol --grid surface",
            3,
            "cloud.vdb … `surface` is a level set … `--fog`",
        ),
        case(
            "a grid that is not read",
            "volume convert a.vdb -o b.vdb --grid density",
            3,
            "a.vdb … grid `density` … `int32` … export it as float",
        )
        .file(
            "a.vdb",
            with_integers(&[colour("albedo"), density(placed())]),
        ),
        case(
            "no grid that is read",
            "volume convert a.vdb -o b.vdb",
            3,
            "a.vdb … grid `density` … `int32` … export it as float",
        )
        .file("a.vdb", with_integers(&[density(placed())])),
    ]
}

fn values() -> Vec<Case> {
    let fog = "volume convert a.vdb -o b.vdb --fog";
    let mut wide = SparseBuilder::new(0.0);
    wide.tile(IVec3::ZERO, TileSize::Upper, 1.0, true)
        .expect("a place");
    let wide = wide.build(DAffine3::IDENTITY).expect("a grid");
    let wide = VolumeGrid::new("density", GridClass::FogVolume, Voxels::Scalar(wide));
    let turned = density(DAffine3::from_rotation_x(0.5));
    let far = density(DAffine3::from_translation([1e7, 0.0, 0.0].into()));
    let dense = |name, grid: VolumeGrid, words| {
        case(name, "volume convert a.vdb -o b.vol", 4, words).file("a.vdb", vdb(&[grid]))
    };
    vec![
        case(
            "a level set without a band",
            fog,
            3,
            "a.vdb … grid `density` … background … make it positive",
        )
        .file("a.vdb", voxel(0.0, 1.0)),
        case(
            "a level set with NaN",
            fog,
            3,
            "a.vdb … grid `density` … voxel [1, 2, 3] … give it a distance",
        )
        .file("a.vdb", voxel(3.0, f32::NAN)),
        case(
            "too much for halves",
            "volume convert a.vdb -o b.vdb --half",
            3,
            "a.vdb … grid `density` … voxel [1, 2, 3] is 65520 … keep it",
        )
        .file("a.vdb", voxel(3.0, 65520.0)),
        dense(
            "a dense grid that is turned",
            turned,
            "b.vol … grid `density` … turned … write .vdb",
        ),
        dense(
            "a dense grid of 4096³",
            wide,
            "b.vol … grid `density` … 4098 × 4098 × 4098 … keep it sparse",
        ),
        dense(
            "a dense grid far away",
            far,
            "b.vol … grid `density` … too far … write .vdb",
        ),
        dense(
            "a dense grid of nothing",
            VolumeGrid::new(
                "density",
                GridClass::Unknown,
                Voxels::Scalar(
                    SparseBuilder::new(0.0)
                        .build(DAffine3::IDENTITY)
                        .expect("a grid"),
                ),
            ),
            "b.vol … grid `density` … all background",
        ),
    ]
}

fn outputs() -> Vec<Case> {
    let mut cases = vec![
        case(
            "a conversion into nowhere",
            "volume convert cloud.vdb -o no/b.vdb",
            4,
            "no/b.vdb … make the folder",
        ),
        case(
            "a folder as converted volume",
            "volume convert cloud.vdb -o b.vdb",
            4,
            "b.vdb … name a file",
        )
        .file("b.vdb/", ""),
    ];
    if cfg!(target_os = "linux") {
        // Not even the superuser makes files there.
        cases.push(case(
            "a conversion where nobody may write",
            "volume convert cloud.vdb -o /sys/b.vdb",
            4,
            "/sys/b.vdb … cannot be written … name another place",
        ));
    }
    cases
}

/// Of scenes that name them.
fn media() -> Vec<Case> {
    const PLUME: &str = "plume = { resolution = 4 }";
    let bytes = vdb(&[density(placed()), plane(), colour("Cd")]);
    let case = |name, file, bytes: &[u8], words| {
        broken(name, PLUME, &format!("file = {file}"), words).file("cloud.vdb", bytes)
    };
    vec![
        broken(
            "a scene without its volume",
            PLUME,
            "file = 'cloud.vdb'",
            "scene.toml:18:8 … `media.smoke.file` … cloud.vdb … check the name",
        ),
        case(
            "a scene of a truncated volume",
            "'cloud.vdb'",
            &bytes[..bytes.len() / 2],
            "scene.toml:18:8 … `media.smoke.file` … cloud.vdb",
        ),
        case(
            "a scene of a level set",
            "'cloud.vdb'\ngrid = 'surface'",
            &bytes,
            "scene.toml:18:8 … `media.smoke.file` … cloud.vdb … level set … --fog",
        ),
        case(
            "a scene of a grid that is not there",
            "'cloud.vdb'\ngrid = 'densty'",
            &bytes,
            "scene.toml:19:8 … `media.smoke.grid` … did you mean \"density\"?",
        ),
        case(
            "a scene of a density of vectors",
            "'cloud.vdb'\ngrid = 'Cd'",
            &bytes,
            "scene.toml:18:8 … `media.smoke.file` … cloud.vdb … numbers are needed",
        ),
        case(
            "a volume in a box of the scene",
            "'cloud.vdb'",
            &bytes,
            "scene.toml:19:1 … `media.smoke.min` … unknown key",
        ),
    ]
}
