//! What is wrong with a scene file is said in one message: file, line, key and the mend.

use std::path::Path;
use tyndall_core::Rgb;
use tyndall_scene_io::SceneFile;

/// A scene without fault, one statement a line.
const GOOD: &str = "[camera]
position = [0, 1, 5]
look_at = [0, 0, 0]
fov = 45
medium = 'fog'
[film]
width = 8
height = 8
[integrator]
max_depth = 8
scattering = 'single'
[media.fog]
kind = 'homogeneous'
sigma_a = 0.1
sigma_s = [0.1, 0.2, 0.3]
phase = { kind = 'henyey_greenstein', g = 0.7 }
[media.smoke]
kind = 'grid'
plume = { resolution = 8 }
min = [0, 0, 0]
max = [1, 1, 1]
scale = 3
albedo = 0.5
[materials.wall]
kind = 'diffuse'
reflectance = 0.5
[materials.glass]
kind = 'dielectric'
ior = 1.5
roughness = 0.1
inside = 'smoke'
priority = 1
[[shapes]]
kind = 'sphere'
center = [0, 0, 0]
radius = 1
material = 'glass'
[[shapes]]
kind = 'quad'
corner = [-1, -1, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
material = 'wall'
emission = 5
[[lights]]
kind = 'spot'
position = [0, 5, 0]
look_at = [0, 0, 0.5]
cone_angle = 20
power = 10
[environment]
radiance = [0, 0, 1]
";

fn message(text: &str, overrides: &[(&str, &str)]) -> String {
    let overrides: Vec<_> = (overrides.iter())
        .map(|(k, v)| (k.to_string(), v.to_string()))
        .collect();
    let file = SceneFile::parse(text, Path::new("dir/scene.toml"), &overrides);
    match file.and_then(|f| f.build::<Rgb>().map(|_| ())) {
        Ok(()) => String::new(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn the_good_scene_is_good() {
    assert_eq!(message(GOOD, &[]), "");
}

/// Old line, new line, the key and the words that the message must hold.
const BAD: &[(&str, &str, &str, &str)] = &[
    ("fov = 45", "fov = 45 45", "", "not TOML"),
    ("fov = 45", "fow = 45", "camera.fow", "did you mean `fov`?"),
    ("fov = 45", "fov = 180", "camera.fov", "between 0 and 180"),
    (
        "fov = 45",
        "fov = 'wide'",
        "camera.fov",
        "expected a number, found the string",
    ),
    ("fov = 45", "fov = nan", "camera.fov", "finite"),
    ("fov = 45", "", "camera", "`fov` is missing: add it"),
    (
        "look_at = [0, 0, 0]",
        "look_at = [0, 1, 5]",
        "camera.look_at",
        "must differ from `position`",
    ),
    (
        "look_at = [0, 0, 0]",
        "look_at = [0, 0]",
        "camera.look_at",
        "[x, y, z]",
    ),
    (
        "medium = 'fog'",
        "medium = 'frog'",
        "camera.medium",
        "did you mean \"fog\"?",
    ),
    (
        "medium = 'fog'",
        "up = [0, -1, -5]",
        "camera.up",
        "parallel",
    ),
    ("[camera]", "[cammera]", "cammera", "did you mean `camera`?"),
    ("width = 8", "width = 0", "film.width", "from 1 to 65536"),
    ("width = 8", "width = 8.5", "film.width", "a whole number"),
    (
        "width = 8",
        "width = 8\ncrop = [4, 0, 5, 8]",
        "film.crop",
        "of the 8 × 8 that there are",
    ),
    (
        "width = 8",
        "width = 8\ncrop = [0, 0, 8]",
        "film.crop",
        "[x, y, width, height]",
    ),
    (
        "width = 8",
        "width = 8\nfilter = 'gausian'",
        "film.filter",
        "did you mean \"gaussian\"?",
    ),
    (
        "width = 8",
        "width = 8\nfilter = { kind = 'tent', radius = 0 }",
        "film.filter.radius",
        "from 0.05 to 16",
    ),
    (
        "width = 8",
        "width = 8\nfilter = { kind = 'tent', stddev = 1 }",
        "film.filter.stddev",
        "unknown key",
    ),
    (
        "width = 8",
        "width = 8\nfilter = { kind = 'mitchell', b = 0, c = 2 }",
        "film.filter.c",
        "from 0 to 1",
    ),
    (
        "fov = 45",
        "kind = 'orthographic'",
        "camera",
        "elsewhere: `width` is missing",
    ),
    (
        "fov = 45",
        "fov = 45\nvertical_fov = 45",
        "camera.vertical_fov",
        "exclude each other",
    ),
    (
        "radiance = [0, 0, 1]",
        "file = 'sky.exr'",
        "environment.file",
        "sky.exr: cannot be read",
    ),
    (
        "max_depth = 8",
        "max_deph = 8",
        "integrator.max_deph",
        "did you mean `max_depth`?",
    ),
    (
        "scattering = 'single'",
        "scattering = 'singel'",
        "integrator.scattering",
        "\"single\"",
    ),
    (
        "scattering = 'single'",
        "surface_radius = 0.1\nsurface_nearest = 20",
        "integrator.surface_nearest",
        "`surface_radius` and `surface_nearest` exclude each other: remove one",
    ),
    ("sigma_a = 0.1", "sigma_a = -1", "media.fog.sigma_a", "≥ 0"),
    (
        "sigma_a = 0.1",
        "sigma_a = inf",
        "media.fog.sigma_a",
        "finite",
    ),
    (
        "sigma_a = 0.1",
        "sigma_t = 0.1",
        "media.fog.sigma_t",
        "did you mean `sigma_a`?",
    ),
    (
        "sigma_a = 0.1",
        "sigma_a = [1, 2]",
        "media.fog.sigma_a",
        "a number or [r, g, b]",
    ),
    (
        "phase = { kind = 'henyey_greenstein', g = 0.7 }",
        "phase = { kind = 'henyey_greenstein', g = 1.5 }",
        "media.fog.phase.g",
        "0.999",
    ),
    (
        "phase = { kind = 'henyey_greenstein', g = 0.7 }",
        "phase = 'isotopic'",
        "media.fog.phase",
        "\"isotropic\"",
    ),
    (
        "phase = { kind = 'henyey_greenstein', g = 0.7 }",
        "phase = { kind = 'tabulated', cosines = [-1, 0.5], values = [1, 1] }",
        "media.fog.phase",
        "cosines",
    ),
    (
        "phase = { kind = 'henyey_greenstein', g = 0.7 }",
        "phase = { kind = 'blend', parts = [] }",
        "media.fog.phase",
        "weights",
    ),
    (
        "plume = { resolution = 8 }",
        "file = 'none.vol'",
        "media.smoke.file",
        "none.vol",
    ),
    (
        "plume = { resolution = 8 }",
        "plume = { resolution = 1 }",
        "media.smoke.plume.resolution",
        "from 2",
    ),
    (
        "plume = { resolution = 8 }",
        "plume = { resolution = 513 }",
        "media.smoke.plume.resolution",
        "to 512",
    ),
    (
        "scale = 3",
        "scale = 3\ntransmittance = 'regulr'",
        "media.smoke.transmittance",
        "did you mean \"regular\"?",
    ),
    ("max = [1, 1, 1]", "", "media.smoke.min", "add the other"),
    (
        "max = [1, 1, 1]",
        "max = [1, 1, 0]",
        "media.smoke.max",
        "must exceed `min`",
    ),
    (
        "albedo = 0.5",
        "albedo = 1.5",
        "media.smoke.albedo",
        "between 0 and 1",
    ),
    (
        "albedo = 0.5",
        "albedo = 'none.vol'",
        "media.smoke.albedo",
        "none.vol",
    ),
    (
        "reflectance = 0.5",
        "reflectance = [0.5, 0.5, 1.5]",
        "materials.wall.reflectance",
        "between 0 and 1",
    ),
    (
        "reflectance = 0.5",
        "reflectance = 0.5\ninside = 'fog'",
        "materials.wall.inside",
        "unknown key",
    ),
    (
        "ior = 1.5",
        "ior = 0",
        "materials.glass.ior",
        "from 0.1 to 10",
    ),
    (
        "roughness = 0.1",
        "roughness = 1e-4",
        "materials.glass.roughness",
        "from 0.001 to 1",
    ),
    (
        "reflectance = 0.5",
        "reflectance = 0.5\n[materials.gold]\nkind = 'conductor'\nk = 3\neta = 1e20",
        "materials.gold.eta",
        "between 1e-6 and 1000",
    ),
    (
        "reflectance = 0.5",
        "reflectance = 0.5\n[materials.gold]\nkind = 'conductor'\neta = 1\nk = [0, 0, 1e20]",
        "materials.gold.k",
        "between 0 and 1000",
    ),
    (
        "inside = 'smoke'",
        "inside = 'smok'",
        "materials.glass.inside",
        "did you mean \"smoke\"?",
    ),
    (
        "priority = 1",
        "priority = 'high'",
        "materials.glass.priority",
        "whole number",
    ),
    (
        "kind = 'dielectric'",
        "kind = 'glas'",
        "materials.glass.kind",
        "`dielectric`",
    ),
    ("radius = 1", "radius = -1", "shapes.0.radius", "> 0"),
    ("radius = 1", "radius = 0.0", "shapes.0.radius", "> 0"),
    (
        "material = 'glass'",
        "material = 'gloss'",
        "shapes.0.material",
        "did you mean \"glass\"?",
    ),
    (
        "material = 'glass'",
        "",
        "shapes.0",
        "`material` is missing",
    ),
    (
        "material = 'wall'",
        "material = 'glass'",
        "shapes.1.material",
        "must be closed, which a quad is not: use a box",
    ),
    (
        "edge_v = [0, 1, 0]",
        "edge_v = [2, 0, 0]",
        "shapes.1.edge_v",
        "parallel",
    ),
    (
        "kind = 'quad'",
        "kind = 'obj'\nfile = 'none.obj'",
        "shapes.1.file",
        "none.obj",
    ),
    (
        "emission = 5",
        "emision = 5",
        "shapes.1.emision",
        "did you mean `emission`?",
    ),
    (
        "emission = 5",
        "emission = [0, -1, 0]",
        "shapes.1.emission.1",
        "≥ 0",
    ),
    (
        "cone_angle = 20",
        "cone_angle = 200",
        "lights.0.cone_angle",
        "up to 180",
    ),
    (
        "cone_angle = 20",
        "cone_angle = 20\nfalloff_angle = 30",
        "lights.0.falloff_angle",
        "20 degrees",
    ),
    (
        "power = 10",
        "power = 10\nintensity = 3",
        "lights.0.intensity",
        "remove one",
    ),
    ("power = 10", "", "lights.0", "`power` is missing"),
    (
        "[environment]",
        "[environments]",
        "environments",
        "did you mean `environment`?",
    ),
    (
        "[media.smoke]",
        "[media.vacuum]",
        "media.vacuum",
        "choose another name",
    ),
];

#[test]
fn every_fault_is_named_with_file_line_key_and_mend() {
    let mut faults = Vec::new();
    for (old, new, key, words) in BAD {
        assert_eq!(GOOD.matches(&format!("{old}\n")).count(), 1, "{old}");
        let message = message(&GOOD.replace(old, new), &[]);
        // The line of the change, or that of the table where a key is missing.
        let start = GOOD.find(&format!("{old}\n")).unwrap();
        let changed = 1 + GOOD[..start].matches('\n').count();
        let last = changed + new.matches('\n').count();
        let elsewhere = new.is_empty() || words.starts_with("elsewhere: ");
        let line = message.split(':').nth(1).and_then(|l| l.parse().ok());
        let right = message.starts_with("dir/scene.toml:")
            && message.contains(words.trim_start_matches("elsewhere: "))
            && (key.is_empty() || message.contains(&format!("`{key}`")))
            && line.is_some_and(|l: usize| elsewhere || l == changed || l == last);
        if !right {
            faults.push(format!("{new:?} (line {changed}): {message:?}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn all_unknown_keys_of_a_table_are_named() {
    let text = GOOD.replace("max_depth = 8", "max_deph = 8\nfoo = 1");
    let message = message(&text, &[]);
    let lines: Vec<_> = message.lines().collect();
    assert_eq!(lines.len(), 2, "{message}");
    assert!(lines[0].starts_with("dir/scene.toml:10:1") && lines[0].contains("max_deph"));
    assert!(lines[1].starts_with("dir/scene.toml:11:1") && lines[1].contains("foo"));
}

#[test]
fn a_picture_too_large_is_named() {
    let large = |width| message(GOOD, &[("film.width", "65536"), ("film.height", width)]);
    let why = large("4097");
    assert!(
        why.contains("`film`: has more than 268435456 pixels"),
        "{why}"
    );
}

#[test]
fn overrides_replace_and_add() {
    for (key, value) in [
        ("film.width", "4"),
        ("camera.medium", "fog"),
        ("shapes.0.material", "'wall'"),
        ("shapes.1.emission", "[1, 2, 3]"),
        ("media.fog.emission", "0.1"),
        ("integrator.passes", "3"),
        ("environment.radiance", "0"),
    ] {
        assert_eq!(message(GOOD, &[(key, value)]), "", "{key}");
    }
    let overrides = [("film.width".to_owned(), "4".to_owned())];
    let file = SceneFile::parse(GOOD, Path::new("x.toml"), &overrides).unwrap();
    let scene = file.build::<Rgb>().unwrap();
    assert_eq!(tyndall_core::Sensor::resolution(&scene), [4, 8]);
}

#[test]
fn faulty_overrides_are_named() {
    for (key, value, words) in [
        ("film.with", "4", "did you mean `width`?"),
        ("media.fgo.sigma_a", "4", "did you mean `fog`?"),
        ("cammera.fov", "4", "did you mean `camera`?"),
        ("camera.fov", "400", "between 0 and 180"),
        ("camera.fov", "[1, 2", "written as in the scene file"),
        ("shapes.9.material", "wall", "below 2"),
        ("camera.fov.x", "1", "table"),
        ("", "1", "unknown key"),
    ] {
        let message = message(GOOD, &[(key, value)]);
        assert!(message.contains(words), "{key}: {message:?}");
        assert!(
            message.starts_with(&format!("override {key}={value}: ")),
            "{message:?}"
        );
    }
}

#[test]
fn a_camera_in_another_medium_than_it_says_is_named() {
    let text = GOOD.replace("position = [0, 1, 5]", "position = [0, 0.5, 0]");
    let message = message(&text, &[]);
    assert!(
        message.starts_with("dir/scene.toml:5:10: `camera.medium`"),
        "{message}"
    );
    assert!(
        message.contains("\"fog\"") && message.contains("\"smoke\""),
        "{message}"
    );
}
