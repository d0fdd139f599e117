//! Scene files.

use super::case::{Case, replaced};

/// A scene without fault, one statement a line.
pub(crate) const GOOD: &str = "[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
fov = 45
[film]
width = 4
height = 4
[integrator]
kind = 'path'
max_depth = 8
[media.fog]
kind = 'homogeneous'
sigma_a = 0.1
sigma_s = 0.2
phase = { kind = 'henyey_greenstein', g = 0.7 }
[media.smoke]
kind = 'grid'
plume = { resolution = 4 }
min = [0, 0, 0]
max = [1, 1, 1]
scale = 3
albedo = 0.5
[materials.glass]
kind = 'dielectric'
ior = 1.5
inside = 'fog'
[materials.wall]
kind = 'diffuse'
reflectance = 0.6
[[shapes]]
kind = 'sphere'
center = [0, 0, 0]
radius = 1
material = 'glass'
[[shapes]]
kind = 'quad'
corner = [-1, -1, -2]
edge_u = [2, 0, 0]
edge_v = [0, 2, 0]
material = 'wall'
[[lights]]
kind = 'spot'
position = [0, 5, 0]
look_at = [0, 0, 0]
cone_angle = 20
power = 10
[environment]
radiance = 1
";

pub(crate) const RENDER: &str = "render scene.toml -o out.exr --passes 1";

pub(crate) fn good() -> Case {
    Case::new("the scene", RENDER, 0, "").file("scene.toml", GOOD)
}

/// The scene with `new` in place of `old`.
pub(crate) fn broken(name: &'static str, old: &str, new: &str, words: &'static str) -> Case {
    let case = Case::new(name, RENDER, 3, words);
    case.file("scene.toml", replaced(GOOD, old, new))
}

pub(crate) fn cases() -> Vec<Case> {
    [files(), values(), names()].into_iter().flatten().collect()
}

/// What is no scene at all.
fn files() -> Vec<Case> {
    let case = |name, words| Case::new(name, RENDER, 3, words);
    vec![
        case("no scene", "scene.toml … cannot be read … check the name"),
        case(
            "a folder as scene",
            "scene.toml … cannot be read … name a file",
        )
        .file("scene.toml/", ""),
        case("not UTF-8", "scene.toml … UTF-8 … save it")
            .file("scene.toml", b"[camera]\nkind = '\xe9'\n"),
        case("an image as scene", "scene.toml … UTF-8 … save it")
            .file("scene.toml", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"),
        case("truncated TOML", "scene.toml:2: … not TOML … `]`")
            .file("scene.toml", "[camera]\nposition = [0, 1"),
        case(
            "an empty scene",
            "scene.toml:1:1 … `camera` is missing … add it",
        )
        .file("scene.toml", ""),
        Case::new(
            "inspect without a scene",
            "inspect scene.toml --json",
            3,
            "scene.toml … cannot be read … check the name",
        ),
    ]
}

/// Keys and values.
fn values() -> Vec<Case> {
    vec![
        broken(
            "no film",
            "[film]\nwidth = 4\nheight = 4\n",
            "",
            "scene.toml:1:1 … `film` is missing … add it",
        ),
        broken(
            "an unknown key",
            "look_at = [0, 0, 0]\nfov = 45",
            "lok_at = [0, 0, 0]\nfov = 45",
            "scene.toml:3:1 … `camera.lok_at` … did you mean `look_at`?",
        ),
        broken(
            "no look_at",
            "look_at = [0, 0, 0]\nfov",
            "fov",
            "scene.toml:1:1 … `camera` … `look_at` is missing … add it",
        ),
        broken(
            "two unknown keys",
            "fov = 45",
            "fov = 45\nfoo = 1\nbar = 2",
            "scene.toml:5:1 … `camera.foo` … scene.toml:6:1 … `camera.bar` … known here: `kind`",
        ),
        broken(
            "a file name of two lines",
            "radiance = 1",
            "file = \"a\\nerror: b\"",
            "scene.toml:48:8 … `environment.file` … a; error: b … check the name",
        ),
        broken(
            "a tower of arrays",
            "radiance = 1",
            &"[".repeat(10_000).replacen('[', "radiance = [", 1),
            "scene.toml:48:92 … not TOML … max recursion depth",
        ),
        broken(
            "an unknown section",
            "[environment]",
            "[enviroment]",
            "scene.toml:47:2 … `enviroment` … did you mean `environment`?",
        ),
        broken(
            "a key twice",
            "fov = 45",
            "fov = 45\nfov = 50",
            "scene.toml:5:1 … duplicate key … remove one",
        ),
        broken(
            "a wrong type",
            "fov = 45",
            "fov = 'wide'",
            "scene.toml:4:7 … `camera.fov` … expected a number",
        ),
        broken(
            "fov 0",
            "fov = 45",
            "fov = 0",
            "scene.toml:4:7 … `camera.fov` … between 0 and 180",
        ),
        broken(
            "fov 180",
            "fov = 45",
            "fov = 180",
            "scene.toml:4:7 … `camera.fov` … between 0 and 180",
        ),
        broken(
            "up along the view",
            "fov = 45",
            "fov = 45\nup = [0, 0, 1]",
            "scene.toml:5:6 … `camera.up` … choose another direction",
        ),
        broken(
            "width 0",
            "width = 4",
            "width = 0",
            "scene.toml:6:9 … `film.width` … from 1 to 65536",
        ),
        broken(
            "width 70000",
            "width = 4",
            "width = 70000",
            "scene.toml:6:9 … `film.width` … from 1 to 65536",
        ),
        broken(
            "a gigantic picture",
            "width = 4\nheight = 4",
            "width = 65536\nheight = 65536",
            "scene.toml … `film` … lower `width` or `height`",
        ),
        broken(
            "a crop outside the film",
            "height = 4",
            "height = 4\ncrop = [2, 0, 3, 4]",
            "scene.toml:8:8 … `film.crop` … of the 4 × 4 that there are",
        ),
        broken(
            "max_depth 0",
            "max_depth = 8",
            "max_depth = 0",
            "scene.toml:10:13 … `integrator.max_depth` … whole number from 1",
        ),
        broken(
            "negative sigma",
            "sigma_a = 0.1",
            "sigma_a = -0.1",
            "scene.toml:13:11 … `media.fog.sigma_a` … ≥ 0",
        ),
        broken(
            "sigma NaN",
            "sigma_a = 0.1",
            "sigma_a = nan",
            "scene.toml:13:11 … `media.fog.sigma_a` … finite",
        ),
        broken(
            "sigma infinite",
            "sigma_s = 0.2",
            "sigma_s = [0, inf, 0]",
            "scene.toml:14:15 … `media.fog.sigma_s.1` … finite",
        ),
        broken(
            "albedo above 1",
            "albedo = 0.5",
            "albedo = 1.5",
            "scene.toml:22:10 … `media.smoke.albedo` … between 0 and 1",
        ),
        broken(
            "g = 1",
            "g = 0.7",
            "g = 1",
            "scene.toml:15: … `media.fog.phase.g` … at most 0.999",
        ),
        broken(
            "g below −1",
            "g = 0.7",
            "g = -1.5",
            "scene.toml:15: … `media.fog.phase.g` … at most 0.999",
        ),
        broken(
            "a plume of one voxel",
            "resolution = 4",
            "resolution = 1",
            "scene.toml:18: … `media.smoke.plume.resolution` … from 2 to 512",
        ),
        broken(
            "a flat grid",
            "max = [1, 1, 1]",
            "max = [1, 0, 1]",
            "scene.toml:20:7 … `media.smoke.max` … must exceed `min`",
        ),
        broken(
            "ior 0",
            "ior = 1.5",
            "ior = 0",
            "scene.toml:25:7 … `materials.glass.ior` … from 0.1 to 10",
        ),
        broken(
            "reflectance above 1",
            "reflectance = 0.6",
            "reflectance = [1, 1, 2]",
            "scene.toml:29: … `materials.wall.reflectance … between 0 and 1",
        ),
        broken(
            "radius 0",
            "radius = 1",
            "radius = 0",
            "scene.toml:33:10 … `shapes.0.radius` … > 0",
        ),
        broken(
            "a degenerate quad",
            "edge_v = [0, 2, 0]",
            "edge_v = [4, 0, 0]",
            "scene.toml:39:10 … `shapes.1.edge_v` … parallel to `edge_u`",
        ),
        broken(
            "an open body",
            "material = 'wall'",
            "material = 'glass'",
            "scene.toml:40:12 … `shapes.1.material` … use a box",
        ),
        broken(
            "falloff beyond the cone",
            "cone_angle = 20",
            "cone_angle = 20\nfalloff_angle = 30",
            "scene.toml:46:17 … `lights.0.falloff_angle` … from 0 to `cone_angle`",
        ),
        broken(
            "infinite power",
            "power = 10",
            "power = inf",
            "scene.toml:46:9 … `lights.0.power` … finite",
        ),
        broken(
            "power and intensity",
            "power = 10",
            "power = 10\nintensity = 1",
            "scene.toml:47:13 … `lights.0.intensity` … remove one",
        ),
        broken(
            "radiance beyond 32 bits",
            "radiance = 1",
            "radiance = 1e39",
            "scene.toml:48:12 … `environment.radiance` … finite",
        ),
    ]
}

/// Names of what is not there.
fn names() -> Vec<Case> {
    vec![
        broken(
            "an unknown medium",
            "inside = 'fog'",
            "inside = 'frog'",
            "scene.toml:26:10 … `materials.glass.inside` … did you mean \"fog\"?",
        ),
        broken(
            "an unknown material",
            "material = 'wall'",
            "material = 'roof'",
            "scene.toml:40:12 … `shapes.1.material` … `glass`, `wall`",
        ),
        broken(
            "an unknown kind",
            "kind = 'sphere'",
            "kind = 'ball'",
            "scene.toml:31:8 … `shapes.0.kind` … `sphere`",
        ),
        broken(
            "an unknown integrator",
            "kind = 'path'",
            "kind = 'photons'",
            "scene.toml … `integrator.kind` … choose one of path, photon_map, progressive_photon_map, beam_radiance",
        ),
        broken(
            "two radii",
            "kind = 'path'",
            "kind = 'beam_radiance'\nradius = 0.1\nnearest = 30",
            "scene.toml … `integrator.nearest` … `radius` and `nearest` exclude each other: remove one",
        ),
        broken(
            "a radius of nothing",
            "kind = 'path'",
            "kind = 'photon_map'\nradius = 0",
            "scene.toml … `integrator.radius` … a number > 0",
        ),
        broken(
            "an unknown kernel",
            "kind = 'path'",
            "kind = 'photon_map'\nkernel = 'gausian'",
            "scene.toml … `integrator.kernel` … did you mean \"gaussian\"?",
        ),
        broken(
            "radii that grow",
            "kind = 'path'",
            "kind = 'progressive_photon_map'\nalpha = 1.5",
            "scene.toml … `integrator.alpha` … a number above 0 and at most 1",
        ),
        broken(
            "more memory than there is",
            "kind = 'path'",
            "kind = 'beam_radiance'\nmemory = 0",
            "scene.toml … `integrator.memory` … a whole number from 1",
        ),
    ]
}
