//! A scene of any size, anywhere, is the unit scene: lengths times s, coefficients over s, intensities
//! of points times s², radiances as they are.
//!
//! Independent seeds; a false alarm in 0.27 % of the comparisons.

use std::path::Path as FilePath;
use tyndall_core::Rgb;
use tyndall_driver::{Budget, Film, Render};
use tyndall_path::Path;
use tyndall_scene_io::SceneFile;
use tyndall_testkit::stats::{ImageEstimate, z_test_images};

const FALSE_ALARM: f64 = 0.0027;
const PASSES: u64 = 256;

/// Fog, smoke and a glass ball of milk in a room, under a lamp and two small lights, all lengths
/// times `s` and moved by `offset` along every axis.
fn scene(s: f64, offset: f64) -> String {
    let p = |v: [f64; 3]| {
        let [x, y, z] = v.map(|x| x * s + offset);
        format!("[{x:?}, {y:?}, {z:?}]")
    };
    let v = |v: [f64; 3]| {
        let [x, y, z] = v.map(|x| x * s);
        format!("[{x:?}, {y:?}, {z:?}]")
    };
    let (inverse, square) = (1.0 / s, s * s);
    format!(
        r#"
        camera = {{ kind = "thin_lens", position = {camera}, look_at = {middle}, fov = 60, lens_radius = {lens}, focus_distance = {focus}, medium = "fog" }}
        film = {{ width = 12, height = 12 }}
        [media.fog]
        kind = "homogeneous"
        sigma_a = {fog_a}
        sigma_s = {fog_s}
        phase = {{ kind = "henyey_greenstein", g = 0.5 }}
        [media.milk]
        kind = "homogeneous"
        sigma_a = 0
        sigma_s = [{milk}, {milk}, {fog_s}]
        [media.smoke]
        kind = "grid"
        plume = {{ resolution = 12 }}
        min = {smoke_min}
        max = {smoke_max}
        scale = {smoke}
        albedo = 0.8
        [materials]
        wall = {{ kind = "diffuse", reflectance = [0.7, 0.5, 0.3] }}
        glass = {{ kind = "dielectric", ior = 1.4, inside = "milk" }}
        boundary = {{ kind = "null", inside = "smoke" }}
        [[shapes]]
        kind = "box"
        min = {room_min}
        max = {room_max}
        material = "wall"
        [[shapes]]
        kind = "sphere"
        center = {ball}
        radius = {radius}
        material = "glass"
        [[shapes]]
        kind = "box"
        min = {smoke_min}
        max = {smoke_max}
        material = "boundary"
        [[shapes]]
        kind = "quad"
        corner = {lamp}
        edge_u = {lamp_u}
        edge_v = {lamp_v}
        material = "wall"
        emission = 5
        [[lights]]
        kind = "point"
        position = {point}
        intensity = {intensity}
        [[lights]]
        kind = "spot"
        position = {spot}
        look_at = {middle}
        cone_angle = 30
        intensity = {intensity}
    "#,
        camera = p([0.1, 0.2, 0.9]),
        middle = p([0.0, -0.1, 0.0]),
        lens = 0.02 * s,
        focus = s,
        fog_a = 0.1 * inverse,
        fog_s = 0.3 * inverse,
        milk = 4.0 * inverse,
        smoke = 8.0 * inverse,
        smoke_min = p([0.1, -0.8, -0.5]),
        smoke_max = p([0.7, 0.4, 0.2]),
        room_min = p([-1.0, -1.0, -1.0]),
        room_max = p([1.0, 1.0, 1.0]),
        ball = p([-0.4, -0.5, -0.1]),
        radius = 0.35 * s,
        lamp = p([-0.3, 0.99, -0.3]),
        lamp_u = v([0.6, 0.0, 0.0]),
        lamp_v = v([0.0, 0.0, 0.6]),
        point = p([-0.7, 0.6, 0.5]),
        spot = p([0.8, 0.8, 0.8]),
        intensity = 0.3 * square,
    )
}

fn render(s: f64, offset: f64, seed: u64) -> Film<Rgb> {
    let text = scene(s, offset);
    let file = SceneFile::parse(&text, FilePath::new("scale"), &[]);
    let scene = file.and_then(|file| file.build::<Rgb>());
    let scene = scene.unwrap_or_else(|e| panic!("{e}"));
    let film = Render::new(&scene, &Path::new())
        .seed(seed)
        .run(Budget::Passes(PASSES), |_| {})
        .expect("a film");
    assert_eq!(film.non_finite(), 0, "scale {s}, offset {offset}");
    film
}

#[test]
fn any_scale_and_place_is_the_unit_scene() {
    let variances = |film: &Film<Rgb>| film.variance_of_mean().collect::<Vec<_>>();
    let unit = render(1.0, 0.0, 1);
    assert!(unit.mean().iter().all(|value| *value > 0.0));
    let unit_variances = variances(&unit);
    for (seed, (s, offset)) in [(1e-3, 0.0), (1e6, 0.0), (1.0, 1e5), (1e-3, 1e2)]
        .into_iter()
        .enumerate()
    {
        let other = render(s, offset, 2 + seed as u64);
        let result = z_test_images(
            ImageEstimate {
                mean: unit.mean(),
                variance_of_mean: &unit_variances,
                passes: PASSES,
            },
            ImageEstimate {
                mean: other.mean(),
                variance_of_mean: &variances(&other),
                passes: PASSES,
            },
            FALSE_ALARM,
        );
        result.unwrap_or_else(|e| panic!("scale {s}, offset {offset}: {e}"));
    }
}
