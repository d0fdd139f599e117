//! The command line, outputs, and checkpoints.

use super::case::Case;
use super::scene::GOOD;

pub(crate) fn cases() -> Vec<Case> {
    [values(), overrides(), outputs(), checkpoints()]
        .into_iter()
        .flatten()
        .collect()
}

fn case(name: &'static str, command: &'static str, code: i32, words: &'static str) -> Case {
    Case::new(name, command, code, words).file("scene.toml", GOOD)
}

fn values() -> Vec<Case> {
    vec![
        case(
            "no output",
            "render scene.toml",
            2,
            "not provided … --output",
        ),
        case(
            "a PNG as output",
            "render scene.toml -o out.png",
            2,
            "out.png … --output … name it OUT.exr",
        ),
        case(
            "an EXR as PNG",
            "render scene.toml -o out.exr --png out.exr",
            2,
            "out.exr … --png … name it OUT.png",
        ),
        case(
            "no passes",
            "render scene.toml -o out.exr --passes 0",
            2,
            "--passes … a whole number from 1",
        ),
        case(
            "no threads",
            "render scene.toml -o out.exr --threads 0",
            2,
            "--threads … a whole number from 1",
        ),
        case(
            "error 0",
            "render scene.toml -o out.exr --error 0",
            2,
            "--error … a positive number",
        ),
        case(
            "a time of weeks",
            "render scene.toml -o out.exr --time 3weeks",
            2,
            "--time … none of s, m, h",
        ),
        case(
            "a time without end",
            "render scene.toml -o out.exr --time 1e300h",
            2,
            "--time … too long: lower it",
        ),
        case(
            "two budgets",
            "render scene.toml -o out.exr --passes 1 --time 3s",
            2,
            "--passes … cannot be used with … --time",
        ),
        case(
            "a negative seed",
            "render scene.toml -o out.exr --seed=-1",
            2,
            "-1 … --seed … a whole number from 0",
        ),
        case(
            "tev without a port",
            "render scene.toml -o out.exr --tev localhost",
            2,
            "--tev … expected HOST:PORT",
        ),
        case(
            "no such integrator",
            "render scene.toml -o out.exr --integrator photons",
            2,
            "photons … --integrator … possible values: path",
        ),
        case(
            "an unknown flag",
            "render scene.toml -o out.exr --treads 2",
            2,
            "--treads … --threads",
        ),
        case("no such command", "rendr scene.toml", 2, "rendr … render"),
    ]
}

fn overrides() -> Vec<Case> {
    vec![
        case(
            "an override without a value",
            "render scene.toml -o out.exr --set film.width",
            2,
            "--set … expected KEY=VALUE",
        ),
        case(
            "an override of an unknown key",
            "render scene.toml -o out.exr --set film.widht=3",
            3,
            "override film.widht=3 … `film.widht` … did you mean `width`?",
        ),
        case(
            "an override in an unknown table",
            "render scene.toml -o out.exr --set media.frog.sigma_a=3",
            3,
            "override media.frog.sigma_a=3 … there is no `frog` … did you mean `fog`?",
        ),
        case(
            "an override of a shape too many",
            "render scene.toml -o out.exr --set shapes.2.radius=3",
            3,
            "override shapes.2.radius=3 … a number below 2",
        ),
        case(
            "an override of a wrong type",
            "render scene.toml -o out.exr --set film.width=wide",
            3,
            "override film.width=wide … `film.width` … a whole number from 1 to 65536",
        ),
        case(
            "an override that is no value",
            "inspect scene.toml --set film.width=[3",
            3,
            "override film.width=[3 … as in the scene file",
        ),
    ]
}

fn outputs() -> Vec<Case> {
    let mut cases = vec![
        case(
            "output into nowhere",
            "render scene.toml -o no/out.exr",
            4,
            "no/out.exr … make the folder",
        ),
        case(
            "output below a file",
            "render scene.toml -o scene.toml/out.exr",
            4,
            "scene.toml/out.exr … name another",
        ),
        case(
            "a folder as output",
            "render scene.toml -o folder.exr",
            4,
            "folder.exr … name a file",
        )
        .file("folder.exr/", ""),
        case(
            "a PNG into nowhere",
            "render scene.toml -o out.exr --png no/out.png",
            4,
            "no/out.png … make the folder",
        ),
        case(
            "a folder as PNG",
            "render scene.toml -o out.exr --png folder.png",
            4,
            "folder.png … name a file",
        )
        .file("folder.png/", ""),
    ];
    if cfg!(target_os = "linux") {
        // Not even the superuser makes files there.
        let words = "/sys/out.exr … cannot be written … name another place";
        cases.push(case(
            "output where nobody may write",
            "render scene.toml -o /sys/out.exr",
            4,
            words,
        ));
    }
    cases
}

/// A checkpoint as `render` leaves it, of a render by this version, but for what it has rendered.
fn checkpoint(version: &str) -> Vec<u8> {
    let identity = (version, [7_u8; 32], "path", 0_u64, 0_u64);
    let body = postcard::to_stdvec(&identity).expect("plain data");
    let mut bytes = b"TYNDALL\x1a\x02\0\0\0".to_vec();
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend(blake3::hash(&body).as_bytes());
    bytes.extend(body);
    bytes
}

fn checkpoints() -> Vec<Case> {
    let case = |name, bytes: Vec<u8>, words| {
        let command = "render scene.toml -o out.exr --passes 1 --resume";
        self::case(name, command, 5, words).file("out.exr.checkpoint", bytes)
    };
    let good = checkpoint(env!("CARGO_PKG_VERSION"));
    let mut damaged = good.clone();
    damaged[60] ^= 1;
    vec![
        case(
            "a checkpoint of another scene",
            good.clone(),
            "out.exr.checkpoint … another scene … without --resume",
        ),
        case(
            "a checkpoint of another version",
            checkpoint("0.0.1"),
            "out.exr.checkpoint … tyndall 0.0.1 … without --resume",
        ),
        case(
            "a damaged checkpoint",
            damaged,
            "out.exr.checkpoint … checksum … remove it",
        ),
        case(
            "half a checkpoint",
            good[..good.len() / 2].to_vec(),
            "out.exr.checkpoint … cut off … remove it",
        ),
        case(
            "a text as checkpoint",
            GOOD.into(),
            "out.exr.checkpoint … no checkpoint … remove it",
        ),
        self::case(
            "a folder as checkpoint",
            "render scene.toml -o out.exr --resume",
            5,
            "out.exr.checkpoint … cannot be read … remove it",
        )
        .file("out.exr.checkpoint/", ""),
    ]
}
