//! `tyndall inspect` and `tyndall completions`.

use serde_json::Value;
use std::fs;
use std::process::{Command, Output};

fn tyndall(arguments: &[&str]) -> Output {
    let output = Command::new(assert_cmd::cargo::cargo_bin("tyndall"))
        .args(arguments)
        .output()
        .expect("the command runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    output
}

/// A box of fog (σt 0.5, 2·2·2) around a ball of glass, under what `rest` adds.
const SCENE: &str = r#"
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
fov = 40
[film]
width = 8
height = 6
[media.fog]
kind = "homogeneous"
sigma_a = SIGMA_A
sigma_s = SIGMA_S
phase = { kind = "henyey_greenstein", g = 0.7 }
[materials.fog]
kind = "null"
inside = "fog"
[materials.glass]
kind = "dielectric"
ior = 1.5
[materials.white]
kind = "diffuse"
reflectance = 0.8
[[shapes]]
kind = "box"
min = [-1, -1, -1]
max = [1, 1, 1]
material = "fog"
"#;

const BALL: &str = "
[[shapes]]
kind = 'sphere'
center = [0, 0, 0]
radius = 0.5
material = 'glass'
";

const SMALL_LAMP: &str = "
[[shapes]]
kind = 'sphere'
center = [0, 4, 0]
radius = 0.1
material = 'white'
emission = 10
";

const POINT: &str = "
[[lights]]
kind = 'point'
position = [0, 4, 0]
power = 12
";

fn inspect(sigma: [&str; 2], rest: &str) -> (Value, String) {
    inspect_scene(SCENE, sigma, rest)
}

fn inspect_scene(scene: &str, sigma: [&str; 2], rest: &str) -> (Value, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    let scene = scene
        .replace("SIGMA_A", sigma[0])
        .replace("SIGMA_S", sigma[1]);
    fs::write(&path, scene + rest).expect("a file");
    let path = path.display().to_string();
    let json = tyndall(&["inspect", &path, "--json"]).stdout;
    let text = tyndall(&["inspect", &path]).stdout;
    (
        serde_json::from_slice(&json).expect("JSON"),
        String::from_utf8(text).expect("text"),
    )
}

fn close(value: &Value, expected: f64) {
    let value = value.as_f64().expect("a number");
    assert!(
        (value / expected - 1.0).abs() < 1e-5,
        "{value}, not {expected}"
    );
}

#[test]
fn what_a_scene_holds_is_told_with_numbers() {
    let (json, text) = inspect(["0.1", "0.4"], &(BALL.to_owned() + POINT));
    assert_eq!(json["channels"], 1);
    assert_eq!(json["bounds"][0], serde_json::json!([-1.0, -1.0, -1.0]));
    assert_eq!(
        json["bounds"][1],
        serde_json::json!([1.0, 4.0, 1.0]),
        "with the lamp"
    );
    assert_eq!(json["camera"]["resolution"], serde_json::json!([8, 6]));
    assert_eq!(json["camera"]["medium"], Value::Null);
    let geometry = &json["geometry"];
    assert_eq!(
        geometry["shapes"],
        serde_json::json!({ "mesh": 1, "sphere": 1 })
    );
    assert_eq!(
        (&geometry["triangles"], &geometry["unique_triangles"]),
        (&12.into(), &12.into())
    );
    assert_eq!(
        (&geometry["delta_shapes"], &geometry["null_shapes"]),
        (&1.into(), &1.into())
    );
    let light = &json["lights"][0];
    assert_eq!(
        (&light["kind"], &light["count"]),
        (&"point".into(), &1.into())
    );
    close(&light["power"], 12.0);
    let fog = &json["media"][0];
    assert_eq!((&fog["name"], &fog["shapes"]), (&"fog".into(), &1.into()));
    close(&fog["albedo"][0], 0.8);
    close(&fog["anisotropy"], 0.7);
    close(&fog["mean_free_path"], 2.0);
    close(&fog["optical_depth"], 0.5 * 12.0_f64.sqrt());
    let share = 0.8 * (1.0 - (-0.5 * 12.0_f64.sqrt()).exp());
    close(&json["transport"]["scattered_share"], share);
    for told in [
        "8×6 pixels",
        "1 point, 12",
        "mean free path 2.0000",
        "shapes      1 mesh, 1 sphere",
    ] {
        assert!(text.contains(told), "{told} in\n{text}");
    }
}

#[test]
fn the_transport_that_a_scene_needs_is_told() {
    for (sigma, needed, advice) in [
        (["0", "0"], "vacuum", "media cost nothing"),
        (["0.3", "0"], "absorption", "scattering = \"none\""),
        (["0.003", "0.005"], "single", "scattering = \"single\""),
        (["0", "3"], "multiple", "multiple scattering counts"),
    ] {
        let (json, text) = inspect(sigma, POINT);
        assert_eq!(json["transport"]["needed"], needed);
        assert_eq!(json["transport"]["null_surfaces"], true);
        assert!(text.contains(advice), "{advice} in\n{text}");
    }
    let sky = "[environment]\nradiance = 1";
    let large = "[[shapes]]\nkind = 'sphere'\ncenter = [0, 4, 0]\nradius = 2\nmaterial = 'white'\nemission = 1";
    for (rest, caustics) in [
        (vec![POINT], "none"),
        (vec![BALL, POINT], "missing"),
        (vec![BALL, SMALL_LAMP], "noisy"),
        (vec![BALL, large], "found"),
        (vec![BALL, sky], "found"),
        (vec![BALL], "none"),
    ] {
        let (json, _) = inspect(["0.1", "0.4"], &rest.concat());
        assert_eq!(json["transport"]["caustics"], caustics, "{rest:?}");
    }
    // A sphere of radius 0.1 at distance 4: 4π·0.01/(4π·16).
    let (json, _) = inspect(["0.1", "0.4"], &[BALL, SMALL_LAMP].concat());
    close(&json["transport"]["lamp_share"], 0.01 / 16.0);
}

#[test]
fn a_medium_without_a_shape_around_it_has_no_end() {
    let thin = ["0.0003", "0.0005"];
    let in_fog = |scene: &str| scene.replace("fov = 40", "fov = 40\nmedium = 'fog'");
    let outside = "
[materials.lid]
kind = 'null'
outside = 'fog'
[[shapes]]
kind = 'sphere'
center = [0, 0, 0]
radius = 0.2
material = 'lid'
";
    for (scene, rest) in [(in_fog(SCENE), ""), (SCENE.to_owned(), outside)] {
        let (json, text) = inspect_scene(&scene, thin, rest);
        assert_eq!(json["media"][0]["fills_space"], true);
        assert_eq!(json["media"][0]["extent"], Value::Null, "infinite");
        // All of the light that never leaves is met: albedo 5/8.
        close(&json["transport"]["scattered_share"], 0.625);
        assert_eq!(json["transport"]["needed"], "multiple");
        assert!(text.contains("over endless space"), "{text}");
    }
}

#[test]
fn what_is_left_out_of_a_file_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    let scene = SCENE.replace("SIGMA_A", "0").replace("SIGMA_S", "0");
    write("scene.toml", &(scene + "[[include]]\nfile = 'a.gltf'\n"));
    write(
        "a.gltf",
        r#"{ "asset": { "version": "2.0" }, "extensionsUsed": ["KHR_materials_clearcoat"],
             "materials": [{ "extensions": { "KHR_materials_clearcoat": {} } }] }"#,
    );
    let path = folder.path().join("scene.toml").display().to_string();
    let output = tyndall(&["inspect", &path, "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let said = String::from_utf8_lossy(&output.stderr);
    let notice = json["notices"][0].as_str().expect("a notice");
    assert!(notice.contains("KHR_materials_clearcoat"), "{notice}");
    assert!(said.contains(notice), "{said}");
}

#[test]
fn colours_and_grids_are_told() {
    let scene = format!("{}/../scenes/spot_smoke.toml", env!("CARGO_MANIFEST_DIR"));
    let json = tyndall(&["inspect", &scene, "--json"]).stdout;
    let json: Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(json["channels"], 3);
    assert_eq!(json["grid_bytes"], 96 * 96 * 96 * 4);
    assert_eq!(json["media"][0]["voxels"], serde_json::json!([96, 96, 96]));
    // σt is 12 where the smoke is densest, and the box is 2 wide.
    let depth = json["media"][0]["optical_depth"]
        .as_f64()
        .expect("a number");
    assert!(depth > 1.0 && depth < 12.0 * 12.0_f64.sqrt(), "{depth}");
}

#[test]
fn every_shell_gets_completions() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = tyndall(&["completions", shell]).stdout;
        let script = String::from_utf8(script).expect("text");
        assert!(script.contains("resume"), "{shell}");
        assert!(script.contains("inspect"), "{shell}");
    }
}

#[test]
fn help_tells_the_exit_codes() {
    let help = tyndall(&["--help"]).stdout;
    let help = String::from_utf8(help).expect("text");
    for code in ["  0 ", "  1 ", "  2 ", "  3 ", "  4 ", "  5 ", "  130 "] {
        assert!(help.contains(code), "{code} in\n{help}");
    }
    let help = String::from_utf8(tyndall(&["help", "render"]).stdout).expect("text");
    assert!(help.contains(".gltf") && help.contains("albedo"), "{help}");
}
