//! Lights of `KHR_lights_punctual`, against closed forms.

use super::builder::{Builder, Folder};
use glam::Vec3;
use serde_json::{Value, json};
use tyndall_core::{LightDirect, Rgb, Spectrum};
use tyndall_scene_io::SceneFile;

/// Irradiance at a point on a plane that faces the one light of a scene.
fn irradiance(light: Value, node: Value, at: Vec3, include: &str) -> Rgb {
    let folder = Folder::new();
    let mut b = Builder::new();
    b.camera();
    let square = b.square(None);
    b.node(json!({ "mesh": square }));
    b.light(light, node);
    folder.write("lamp.glb", b.glb());
    let text = format!("[[include]]\nfile = 'lamp.glb'\n{include}");
    let file = SceneFile::parse(&text, &folder.path().join("x.toml"), &[]);
    let scene = file
        .and_then(|f| f.build::<Rgb>())
        .unwrap_or_else(|e| panic!("{e}"));
    scene
        .sample_direct(at, [0.5; 4])
        .map_or(Rgb::default(), |s| s.weight)
}

fn assert_close(found: Rgb, expected: Rgb) {
    let close = |i| (found.channel(i) - expected.channel(i)).abs() <= 2e-6 * expected.channel(i);
    assert!((0..3).all(close), "{found:?} {expected:?}");
}

/// 683 candela are a watt to the steradian, and fall with the squared distance.
#[test]
fn points_light_by_the_squared_distance() {
    let light = json!({ "type": "point", "intensity": 1366.0, "color": [1.0, 0.5, 0.25] });
    let node = json!({ "translation": [0, 3, 0], "scale": [2, 2, 2] });
    let found = irradiance(light, node, Vec3::new(4.0, 0.0, 0.0), "");
    assert_close(found, Rgb::new(2.0, 1.0, 0.5) * (1.0 / 25.0));
}

#[test]
fn the_luminous_efficacy_is_chosen() {
    let light = json!({ "type": "point", "intensity": 3.0 });
    let node = json!({ "translation": [0, 1, 0] });
    let found = irradiance(light, node, Vec3::ZERO, "luminous_efficacy = 1");
    assert_close(found, Rgb::new(3.0, 3.0, 3.0));
}

/// Full inside the inner cone, nothing outside the outer, linear in the cosine between.
#[test]
fn spots_fall_off_between_their_cones() {
    let (inner, outer) = (0.3_f32, 0.6_f32);
    let at = |angle: f32| {
        let spot = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        let light = json!({ "type": "spot", "intensity": 683.0, "spot": spot });
        // Down from y = 2: −z turned by −90° about x.
        let half = std::f32::consts::FRAC_PI_4;
        let node = json!({
            "translation": [0, 2, 0], "rotation": [-half.sin(), 0, 0, half.cos()],
        });
        let point = Vec3::new(angle.sin(), 2.0 - angle.cos(), 0.0);
        irradiance(light, node, point, "").0.x
    };
    let near = |found: f32, expected: f32| assert!((found - expected).abs() < 1e-5, "{found}");
    near(at(0.0), 1.0);
    near(at(0.29), 1.0);
    near(at(0.61), 0.0);
    let between = (0.45_f32.cos() - outer.cos()) / (inner.cos() - outer.cos());
    near(at(0.45), between);
}

#[test]
fn directional_light_is_lux_along_minus_z() {
    let light = json!({ "type": "directional", "intensity": 683.0 });
    let found = irradiance(light, json!({}), Vec3::ZERO, "");
    assert_close(found, Rgb::new(1.0, 1.0, 1.0));
    let folder = Folder::new();
    let mut b = Builder::new();
    b.camera();
    b.light(
        json!({ "type": "directional", "intensity": 683.0 }),
        json!({}),
    );
    let path = folder.write("sun.gltf", b.text());
    let scene = SceneFile::load(&path, &[]).unwrap().build::<Rgb>().unwrap();
    let wi = scene.sample_direct(Vec3::ZERO, [0.5; 4]).unwrap().wi;
    assert_eq!(wi, Vec3::Z);
}

/// Ten times as large, seen from ten times as far, a lamp looks the same.
#[test]
fn intensities_grow_with_the_square_of_lengths() {
    let lit = |include: &str, at: f32| {
        let light = json!({ "type": "point", "intensity": 683.0 });
        irradiance(
            light,
            json!({ "translation": [0, 1, 0] }),
            Vec3::new(at, 0.0, 0.0),
            include,
        )
    };
    assert_close(lit("transform = { scale = 10 }", 20.0), lit("", 2.0));
}

#[test]
fn lights_are_left_out_on_request() {
    let light = json!({ "type": "point", "intensity": 683.0 });
    let found = irradiance(light, json!({}), Vec3::X, "lights = false");
    assert!(found.is_black());
}
