//! Files that a scene names: meshes, textures, grids.

use super::case::{Case, replaced};
use super::scene::{GOOD, RENDER, broken};

const OBJ: &str = "mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
const MTL: &str = "newmtl red\nKd 0.8 0.1 0.1\n";

/// A PNG of one pixel, 69 bytes: its header ends at 33.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\
    \0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90\x77\x53\xde\
    \0\0\0\x0cIDAT\x78\x9c\x63\x60\x64\x62\x06\0\0\x0e\0\x07\xd7\x6f\xe4\x78\
    \0\0\0\0IEND\xae\x42\x60\x82";

/// The header of a PNG of 100000 × 100000 pixels.
const HUGE: &[u8] = b"\0\0\0\rIHDR\0\x01\x86\xa0\0\x01\x86\xa0\x08\x02\0\0\0\x27\x30\x9c\x9f";

/// A `.vol` file.
fn vol(resolution: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for word in [1, resolution[0], resolution[1], resolution[2], channels] {
        bytes.extend(word.to_le_bytes());
    }
    for x in [0.0, 0.0, 0.0, 1.0, 1.0, 1.0].iter().chain(values) {
        bytes.extend(x.to_le_bytes());
    }
    bytes
}

/// Adds the mesh to the scene.
const SHAPE: &str = "[[shapes]]\nkind = 'obj'\nfile = 'mesh.obj'\n[environment]";

pub(crate) fn good() -> Case {
    let scene = replaced(GOOD, "[environment]", SHAPE);
    let scene = replaced(&scene, "plume = { resolution = 4 }", "file = 'smoke.vol'");
    let texture = "reflectance = { file = 'tile.png' }";
    let scene = replaced(&scene, "reflectance = 0.6", texture);
    let case = Case::new("the assets", RENDER, 0, "");
    case.file("scene.toml", scene)
        .file("mesh.obj", OBJ)
        .file("mesh.mtl", MTL)
        .file("tile.png", PNG)
        .file("smoke.vol", vol([1, 1, 2], 1, &[0.5, 1.0]))
}

pub(crate) fn cases() -> Vec<Case> {
    [meshes(), textures(), grids()]
        .into_iter()
        .flatten()
        .collect()
}

fn meshes() -> Vec<Case> {
    let case =
        |name, obj: &str, words| broken(name, "[environment]", SHAPE, words).file("mesh.obj", obj);
    vec![
        broken(
            "no OBJ",
            "kind = 'sphere'",
            "kind = 'obj'\nfile = 'mesh.obj'",
            "scene.toml:32:8 … `shapes.0.file` … mesh.obj … check the name",
        ),
        case(
            "an OBJ without faces",
            "v 0 0 0\nv 1 0 0\n",
            "scene.toml:49:8 … `shapes.2.file` … mesh.obj … export the mesh",
        ),
        case(
            "an OBJ of a vertex too few",
            &OBJ.replace("f 1 2 3", "f 1 2 4"),
            "scene.toml:49:8 … `shapes.2.file` … mesh.obj … out of bounds … export it again",
        )
        .file("mesh.mtl", MTL),
        case(
            "an OBJ of no numbers",
            &OBJ.replace("v 1 0 0", "v one 0 0"),
            "scene.toml:49:8 … `shapes.2.file` … mesh.obj … export it again",
        )
        .file("mesh.mtl", MTL),
        case(
            "a vertex at infinity",
            &OBJ.replace("v 1 0 0", "v 1 inf 0"),
            "scene.toml:49:8 … `shapes.2.file` … mesh.obj … finite … export it again",
        )
        .file("mesh.mtl", MTL),
        case(
            "no MTL",
            OBJ,
            "scene.toml:49:8 … `shapes.2.file` … mesh.mtl … give `material`",
        ),
        case(
            "half a colour in an MTL",
            OBJ,
            "scene.toml:49:8 … `shapes.2.file` … mesh.mtl … line 2 … `Kd r g b`",
        )
        .file("mesh.mtl", "newmtl red\nKd 0.8\n"),
        case(
            "no texture of an MTL",
            OBJ,
            "scene.toml:49:8 … `shapes.2.file` … \"red\" … tile.png … mend the MTL file",
        )
        .file("mesh.mtl", format!("{MTL}map_Kd tile.png\n")),
    ]
}

fn textures() -> Vec<Case> {
    let case = |name, words| {
        let texture = "reflectance = { file = 'tile.png' }";
        broken(name, "reflectance = 0.6", texture, words)
    };
    let mut cases = vec![
        case(
            "no texture",
            "scene.toml:29: … `materials.wall.reflectance.file` … tile.png … check the name",
        ),
        broken(
            "a folder as texture",
            "reflectance = 0.6",
            "reflectance = { file = '.' }",
            "scene.toml:29: … `materials.wall.reflectance.file` … cannot be read … name a file",
        ),
        case(
            "a text as texture",
            "scene.toml:29: … `materials.wall.reflectance.file` … tile.png … convert it",
        )
        .file("tile.png", "a brick"),
        case(
            "an empty texture",
            "scene.toml:29: … `materials.wall.reflectance.file` … tile.png … convert it",
        )
        .file("tile.png", ""),
        case(
            "a truncated PNG",
            "scene.toml:29: … `materials.wall.reflectance.file` … tile.png … export it again",
        )
        .file("tile.png", &PNG[..50]),
        case(
            "a PNG of absurd size",
            "scene.toml:29: … `materials.wall.reflectance.file` … tile.png … scale it down",
        )
        .file("tile.png", [&PNG[..8], HUGE, &PNG[33..]].concat()),
        broken(
            "an unknown channel",
            "kind = 'diffuse'",
            "kind = 'diffuse'\nalpha = { file = 'tile.png', channel = 'grey' }",
            "scene.toml:29: … `materials.wall.alpha.channel` … `red`, `green`",
        )
        .file("tile.png", PNG),
        broken(
            "a texture without alpha",
            "reflectance = 0.6",
            "reflectance = { file = 'tile.png' }\nalpha_cutoff = 0.5",
            "scene.toml:30:16 … `materials.wall.alpha_cutoff` … needs `alpha`",
        )
        .file("tile.png", PNG),
    ];
    if cfg!(unix) {
        cases.push(broken(
            "a texture without end",
            "reflectance = 0.6",
            "reflectance = { file = '/dev/zero' }",
            "scene.toml:29: … `materials.wall.reflectance.file` … /dev/zero … name a file",
        ));
    }
    cases
}

fn grids() -> Vec<Case> {
    let case = |name, bytes: Vec<u8>, words| {
        let case = broken(
            name,
            "plume = { resolution = 4 }",
            "file = 'smoke.vol'",
            words,
        );
        case.file("smoke.vol", bytes)
    };
    let good = vol([2, 1, 1], 1, &[0.5, 1.0]);
    vec![
        broken(
            "no VOL",
            "plume = { resolution = 4 }",
            "file = 'smoke.vol'",
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … check the name",
        ),
        broken(
            "a folder as VOL",
            "plume = { resolution = 4 }",
            "file = 'smoke.vol'",
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … name a file",
        )
        .file("smoke.vol/", ""),
        case(
            "a VOL of wrong magic",
            [b"VOX", &good[3..]].concat(),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … write it with Mitsuba 3",
        ),
        case(
            "an empty VOL",
            Vec::new(),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … write it again",
        ),
        case(
            "a VOL of three channels",
            vol([1, 1, 1], 3, &[0.5; 3]),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … write one of 1",
        ),
        case(
            "a truncated VOL",
            good[..good.len() - 3].to_vec(),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … write it again",
        ),
        case(
            "a VOL that promises too much",
            vol([2_000_000_000; 3], 1, &[1.0]),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … write it again",
        ),
        case(
            "a VOL of no voxels",
            vol([0, 1, 1], 1, &[]),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … write it again",
        ),
        case(
            "a NaN voxel",
            vol([2, 1, 1], 1, &[0.5, f32::NAN]),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … finite",
        ),
        case(
            "a negative voxel",
            vol([2, 1, 1], 1, &[-0.5, 1.0]),
            "scene.toml:18:8 … `media.smoke.file` … smoke.vol … at least 0",
        ),
        broken(
            "a grid of albedo above 1",
            "albedo = 0.5",
            "albedo = 'albedo.vol'",
            "scene.toml:22:10 … `media.smoke.albedo` … albedo.vol … at most 1",
        )
        .file("albedo.vol", vol([1, 1, 1], 1, &[1.5])),
        broken(
            "a grid of two colours",
            "albedo = 0.5",
            "albedo = 'albedo.vol'",
            "scene.toml:22:10 … `media.smoke.albedo` … albedo.vol … 1 or 3 channels",
        )
        .file("albedo.vol", vol([1, 1, 1], 2, &[0.5, 0.5])),
    ]
}
