//! White furnaces made of scene files: in a sky of radiance 1, what loses no light is not to be seen.
//!
//! Every shape, boundary and medium of the command's own host, by `path`. False alarms: 0.27 % a
//! test (three standard errors of a normal distribution), Šidák-corrected within it; fixed seeds.

use std::path::Path as FilePath;
use tyndall_core::{Rgb, Sensor};
use tyndall_path::Path;
use tyndall_scene_io::SceneFile;
use tyndall_testkit::measure_mean;
use tyndall_testkit::stats::check_means;

const FALSE_ALARM: f64 = 0.0027;
const PRECISION: f64 = 0.003;

const HEAD: &str = r#"
[camera]
position = [0.3, 0.4, 4]
look_at = [0, 0, 0]
fov = 30
[film]
width = 8
height = 8
[environment]
radiance = 1 # not seen from between walls
[media.milk]
kind = "homogeneous"
sigma_a = 0
sigma_s = [0.4, 1.5, 3.0]
phase = { kind = "henyey_greenstein", g = 0.6 }
[media.smoke]
kind = "grid"
plume = { resolution = 16 }
min = [-1, -1, -1]
max = [1, 1, 1]
scale = 5
albedo = 1
phase = { kind = "blend", parts = [{ weight = 1, phase = "rayleigh" }, { weight = 2, phase = { kind = "henyey_greenstein", g = -0.4 } }] }
"#;

#[test]
fn walls_that_glow() {
    // Walls that reflect ρ and emit 1 − ρ are a furnace too, one whose light is found at surfaces:
    // by direct sampling, by scattering, and in milk by both at two distances.
    let walls: String = (0..3)
        .flat_map(|axis| [-1.0, 1.0].map(|side| wall(axis, side)))
        .collect();
    let shapes = format!(
        r#"
        materials.wall = {{ kind = "diffuse", reflectance = [0.5, 0.2, 0.8], emission = [0.5, 0.8, 0.2] }}
        materials.boundary = {{ kind = "null", inside = "milk" }}
        materials.glass = {{ kind = "dielectric", ior = 1.5 }}
        shapes = [
            {{ kind = "sphere", center = [0, 0, 0], radius = 2, material = "boundary" }},
            {{ kind = "sphere", center = [0.5, 0, 0], radius = 0.5, material = "glass" }},
            {walls}
        ]
    "#
    );
    is_white("walls that glow", &shapes, 8_000);
}

#[test]
fn a_null_surface_may_glow() {
    // Light passes the boundary of nothing, and what the boundary emits is added.
    let shapes = r#"
        materials.boundary = { kind = "null", emission = 0.5 }
        shapes = [{ kind = "sphere", center = [0, 0, 0], radius = 1, material = "boundary" }]
        environment.radiance = 0.5
    "#;
    let head = HEAD.replace(
        "[environment]\nradiance = 1 # not seen from between walls\n",
        "",
    );
    let head = head.replace("fov = 30", "fov = 10");
    let text = format!("{shapes}{head}");
    let file =
        SceneFile::parse(&text, FilePath::new("glow"), &[]).unwrap_or_else(|e| panic!("{e}"));
    let scene = file.build::<Rgb>().unwrap_or_else(|e| panic!("{e}"));
    for estimate in measure_mean(&scene, &Path::new(), 2, 1) {
        // Every ray meets the sky and the front of the sphere, and nothing else.
        assert!((estimate.mean - 1.0).abs() < 1e-6, "{estimate:?}");
    }
}

/// One wall of a box of side 10 around the origin, whose normal points inwards.
fn wall(axis: usize, side: f64) -> String {
    let unit = |i: usize, length: f64| {
        let mut v = [0.0; 3];
        v[i % 3] = length;
        v
    };
    let mut corner = [-5.0; 3];
    corner[axis] = 5.0 * side;
    // u × v is along the axis; against the side it points inwards.
    let (u, v) = if side < 0.0 {
        (axis + 1, axis + 2)
    } else {
        (axis + 2, axis + 1)
    };
    format!(
        r#"{{ kind = "quad", corner = {corner:?}, edge_u = {:?}, edge_v = {:?}, material = "wall" }},"#,
        unit(u, 10.0),
        unit(v, 10.0)
    )
}

/// Of the scene with these materials and shapes; inline keys must stand before the tables.
fn is_white(name: &str, shapes: &str, passes: u64) {
    is_white_text(name, &format!("{shapes}{HEAD}"), passes);
}

fn is_white_text(name: &str, text: &str, passes: u64) {
    let file = SceneFile::parse(text, FilePath::new(name), &[]).unwrap_or_else(|e| panic!("{e}"));
    let scene = file.build::<Rgb>().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(scene.resolution(), [8, 8]);
    let figures = measure_mean(&scene, &Path::new(), passes, 1);
    let cases: Vec<_> = figures
        .into_iter()
        .map(|estimate| {
            let precision = estimate.relative_standard_error();
            assert!(precision <= PRECISION, "{name}: {precision:.4}");
            (name, estimate, 1.0)
        })
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn milk_without_walls() {
    let shapes = r#"
        materials.boundary = { kind = "null", inside = "milk" }
        shapes = [{ kind = "sphere", center = [0, 0, 0], radius = 1, material = "boundary" }]
    "#;
    is_white("milk without walls", shapes, 4_000);
}

#[test]
fn milk_in_glass() {
    let shapes = r#"
        materials.glass = { kind = "dielectric", ior = 1.5, inside = "milk" }
        shapes = [{ kind = "sphere", center = [0, 0, 0], radius = 1, material = "glass" }]
    "#;
    is_white("milk in glass", shapes, 8_000);
}

#[test]
fn smoke_in_a_box() {
    let shapes = r#"
        materials.boundary = { kind = "null", inside = "smoke" }
        shapes = [{ kind = "box", min = [-1, -1, -1], max = [1, 1, 1], material = "boundary" }]
    "#;
    is_white("smoke in a box", shapes, 4_000);
}

#[test]
fn milk_that_reaches_into_the_wall_of_its_glass() {
    let shapes = r#"
        materials.glass = { kind = "dielectric", ior = 1.5, priority = 2 }
        materials.air = { kind = "dielectric", ior = 1.0, priority = 3 }
        materials.milk = { kind = "dielectric", ior = 1.33, inside = "milk", priority = 4 }
        shapes = [
            { kind = "sphere", center = [0, 0, 0], radius = 1, material = "glass" },
            { kind = "sphere", center = [0, 0.1, 0], radius = 0.8, material = "air" },
            { kind = "sphere", center = [0, -0.3, 0], radius = 0.6, material = "milk" },
        ]
    "#;
    is_white("milk in a glass", shapes, 8_000);
}

#[test]
fn white_walls_in_milk() {
    let shapes = r#"
        materials.boundary = { kind = "null", inside = "milk" }
        materials.white = { kind = "diffuse", reflectance = 1 }
        materials.mirror = { kind = "mirror" }
        shapes = [
            { kind = "sphere", center = [0, 0, 0], radius = 1, material = "boundary" },
            { kind = "box", min = [-0.5, -0.5, -0.5], max = [0, 0, 0], material = "white" },
            { kind = "quad", corner = [0.2, -0.4, 0.2], edge_u = [0.5, 0, 0], edge_v = [0, 0.5, 0.2], material = "mirror" },
            { kind = "disk", center = [0, 0.5, 0], normal = [0.2, 1, 0.1], radius = 0.4, material = "white" },
        ]
    "#;
    is_white("white walls in milk", shapes, 8_000);
}

#[test]
fn smoke_and_milk_that_overlap() {
    // Two boundaries that add, one of them half in glass, which smoke fills as well.
    let shapes = r#"
        materials.milk = { kind = "null", inside = "milk", adds = true }
        materials.smoke = { kind = "null", inside = "smoke", adds = true, priority = 1 }
        materials.glass = { kind = "dielectric", ior = 1.5, inside = "milk" }
        shapes = [
            { kind = "sphere", center = [0, 0.5, 0], radius = 0.8, material = "milk" },
            { kind = "box", min = [-1, -1, -1], max = [1, 1, 1], material = "smoke" },
            { kind = "sphere", center = [-0.5, -0.4, 0.4], radius = 0.4, material = "glass" },
        ]
    "#;
    is_white("smoke and milk", shapes, 8_000);
}

#[test]
fn smoke_without_a_shape_and_haze_with_one() {
    let haze = r#"
        materials.haze = { kind = "null", inside = "haze", adds = true }
        shapes = [{ kind = "sphere", center = [0.5, 0, 0], radius = 1.2, material = "haze" }]
        [media.haze]
        kind = "atmosphere"
        origin = [0, -2, 0]
        sigma_a = 0
        sigma_s = [0.2, 0.6, 1.8]
        scale_height = 1.5
        phase = { kind = "henyey_greenstein", g = 0.5 }
    "#;
    let head = HEAD.replace("fov = 30", "fov = 30\nmedium = 'smoke'");
    is_white_text("smoke in haze", &format!("{haze}{head}"), 4_000);
}
