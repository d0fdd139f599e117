//! The scene as a host: what every host must hold, for every material, shape and light.
//!
//! False alarms: 1e-6 a test (see `tyndall_testkit::conformance`).

use crate::support::sky::Sky;
use image::{ImageBuffer, Rgb as Rgb8};
use std::f32::consts::PI;
use std::path::Path;
use std::sync::OnceLock;
use tyndall_core::{Rgb, Spectrum};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::host_conformance;

fn scene<S: Spectrum>(text: &str) -> Scene<S> {
    let head = "
        [film]
        width = 16
        height = 12
        [camera]
        position = [0, 0, 3]
        look_at = [0, 0, 0]
        fov = 60
    ";
    let path = Path::new("conformance.toml");
    let file = SceneFile::parse(&format!("{head}{text}"), path, &[]);
    file.and_then(|f| f.build())
        .unwrap_or_else(|e| panic!("{e}"))
}

/// A sphere of one material that fills most of the picture, lit by a lamp and the sky.
fn ball(material: &str) -> Scene<f32> {
    scene(&format!(
        "
        [environment]
        radiance = 0.5
        [materials.black]
        kind = 'diffuse'
        reflectance = 0
        [materials.it]
        {material}
        [[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 1
        material = 'it'
        [[shapes]]
        kind = 'quad'
        corner = [-1, 2, -1]
        edge_u = [2, 0, 0]
        edge_v = [0, 0, 2]
        material = 'black'
        emission = 3
        "
    ))
}

/// Emitted by the lamp and arriving from the sky at the sphere around both.
fn power_of_ball(scene: &Scene<f32>) -> f32 {
    let size = tyndall_core::Geometry::bounds(scene).size();
    let radius = 0.5 * size.length() * 1.001;
    PI * 4.0 * 3.0 + 4.0 * PI * PI * radius * radius * 0.5
}

macro_rules! balls {
    ($($name:ident: $material:expr;)+) => {
        $(host_conformance! {
            name: $name,
            host: ball($material),
            power: power_of_ball(&ball($material)),
        })+
    };
}

balls! {
    diffuse: "kind = 'diffuse'\n reflectance = 0.7";
    mirror: "kind = 'mirror'\n reflectance = 0.9";
    smooth_glass: "kind = 'dielectric'\n ior = 1.5";
    frosted_glass: "kind = 'dielectric'\n ior = 1.5\n roughness = 0.3";
    etched_glass: "kind = 'dielectric'\n ior = 1.33\n roughness = 0.08";
    bubble: "kind = 'dielectric'\n ior = 0.7\n roughness = 0.5";
    chalky_glass: "kind = 'dielectric'\n ior = 2.4\n roughness = 1";
    polished_metal: "kind = 'conductor'\n eta = 0.2\n k = 3.9";
    brushed_metal: "kind = 'conductor'\n eta = 1.4\n k = 7.5\n roughness = 0.1";
    cast_metal: "kind = 'conductor'\n eta = 2.9\n k = 3.1\n roughness = 0.8";
    invisible: "kind = 'null'";
    plastic: "kind = 'metallic_roughness'\n base_color = 0.8\n roughness = 0.4";
    polished_wood: "kind = 'metallic_roughness'\n base_color = 0.5\n roughness = 0";
    alloy: "kind = 'metallic_roughness'\n base_color = 0.9\n roughness = 0.6\n metallic = 0.5";
    cast_iron: "kind = 'metallic_roughness'\n base_color = 0.6\n roughness = 1\n metallic = 1";
    chrome: "kind = 'metallic_roughness'\n base_color = 0.7\n roughness = 0\n metallic = 1";
    opal: "kind = 'metallic_roughness'\n base_color = 0.9\n roughness = 0.5\n transmission = 0.6";
    tinted: "kind = 'metallic_roughness'\n base_color = 0.5\n roughness = 0\n transmission = 1\n ior = 1.33";
    parchment: "kind = 'metallic_roughness'\n base_color = 0.8\n roughness = 0.7\n transmission = 0.4\n thin = true";
    pane: "kind = 'metallic_roughness'\n base_color = 0.8\n roughness = 0\n transmission = 1\n thin = true";
    everything: "kind = 'metallic_roughness'\n base_color = 0.7\n roughness = 0.3\n metallic = 0.3\n transmission = 0.5\n ior = 1.8";
}

/// A ball whose every property comes from a texture, with a relief that is weak for the
/// same reason as in [`roof`], under a lamp of bands.
fn painted() -> Scene<f32> {
    static FOLDER: OnceLock<String> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("painted");
        std::fs::create_dir_all(&folder).unwrap();
        let noise = |x: u32, y: u32, c: u32| (x * 97 + y * 57 + c * 131) as u8;
        let image = ImageBuffer::from_fn(8, 8, |x, y| Rgb8([0, 1, 2].map(|c| noise(x, y, c))));
        image.save(folder.join("noise.png")).unwrap();
        let relief = ImageBuffer::from_fn(8, 8, |x, y| {
            Rgb8([96 + noise(x, y, 0) / 4, 96 + noise(x, y, 1) / 4, 240])
        });
        relief.save(folder.join("relief.png")).unwrap();
        let bands = ImageBuffer::from_fn(3, 1, |x, _| Rgb8([[255_u8, 0, 255][x as usize]; 3]));
        bands.save(folder.join("bands.png")).unwrap();
        folder.display().to_string()
    });
    scene(&format!(
        "
        [materials.lamp]
        kind = 'diffuse'
        reflectance = 0
        emission = {{ file = '{folder}/bands.png', filter = 'nearest', factor = 3 }}
        [materials.it]
        kind = 'metallic_roughness'
        base_color = {{ file = '{folder}/noise.png', factor = 0.5 }}
        metallic_roughness = {{ file = '{folder}/noise.png', scale = 2 }}
        transmission = {{ file = '{folder}/noise.png', factor = 0.5, rotation = 30 }}
        normal_map = {{ file = '{folder}/relief.png', scale = [4, 2], strength = 0.2 }}
        [[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 1
        material = 'it'
        [[shapes]]
        kind = 'quad'
        corner = [-1, 2, -1]
        edge_u = [2, 0, 0]
        edge_v = [0, 0, 2]
        material = 'lamp'
        "
    ))
}

host_conformance! {
    name: painted,
    host: painted(),
    power: PI * 4.0 * 3.0 * 2.0 / 3.0,
}

/// A coloured room whose lights are all of those that rays cannot find, and one mesh of each kind.
const ROOM: &str = "
    [media.fog]
    kind = 'homogeneous'
    sigma_a = [0.1, 0.2, 0.3]
    sigma_s = 0.2
    phase = { kind = 'henyey_greenstein', g = 0.5 }
    [materials.wall]
    kind = 'diffuse'
    reflectance = [0.7, 0.5, 0.3]
    [materials.fog]
    kind = 'null'
    inside = 'fog'
    [materials.frost]
    kind = 'dielectric'
    ior = 1.5
    roughness = 0.4
    [[shapes]]
    kind = 'box'
    min = [-4, -4, -4]
    max = [4, 4, 4]
    material = 'wall'
    [[shapes]]
    kind = 'box'
    min = [-2, -2, -2]
    max = [2, 2, 3.5]
    material = 'fog'
    [[shapes]]
    kind = 'box'
    min = [-0.5, -0.5, -0.5]
    max = [0.5, 0.5, 0.5]
    transform = { rotate = { axis = [1, 2, 3], degrees = 40 }, translate = [0.3, 0, 0] }
    material = 'frost'
    [[shapes]]
    kind = 'disk'
    center = [0, 3, 0]
    normal = [0, -1, 0.2]
    radius = 1
    material = 'wall'
    emission = [4, 3, 2]
    [[lights]]
    kind = 'point'
    position = [1, 1, 1]
    power = [10, 20, 30]
    [[lights]]
    kind = 'spot'
    position = [-3, 3, 0]
    look_at = [0, 0, 0]
    cone_angle = 30
    falloff_angle = 20
    power = [5, 0, 5]
    [[lights]]
    kind = 'beam'
    position = [-3.5, 0, 1]
    direction = [1, 0.1, 0]
    radius = 0.2
    power = [0, 7, 0]
";

host_conformance! {
    name: room,
    host: scene::<Rgb>(ROOM),
    power: Rgb::new(10.0 + 5.0, 20.0 + 7.0, 30.0 + 5.0) + Rgb::new(4.0, 3.0, 2.0) * (PI * PI),
}

host_conformance! {
    name: room_in_one_channel,
    host: scene::<f32>(ROOM),
    power: (15.0 + 27.0 + 35.0) / 3.0 + 3.0 * PI * PI,
}

host_conformance! {
    name: thin_lens_under_the_sun,
    host: scene::<f32>("
        [materials.ground]
        kind = 'diffuse'
        reflectance = 0.5
        [[shapes]]
        kind = 'quad'
        corner = [-1, -0.5, 1]
        edge_u = [2, 0, 0]
        edge_v = [0, 0, -2]
        material = 'ground'
        [[lights]]
        kind = 'directional'
        direction = [0.1, -1, 0.3]
        irradiance = 2
    "),
    power: 2.0 * PI * (2.0_f32.sqrt() * 1.001).powi(2),
}

/// Noise.
fn clouds() -> Sky {
    Sky::exr(24, 12, |x, y| {
        let hash = |k: usize| ((x * 7919 + y * 104_729 + k * 31) % 97) as f32 / 97.0;
        Rgb::new(hash(1), hash(2), 3.0 * hash(3).powi(4))
    })
}

/// A row above the horizon and one below: each has half of the solid angle.
fn two_rows() -> Sky {
    Sky::exr(6, 2, |x, y| Rgb::new((x % 2) as f32, y as f32, 0.5))
}

/// A ball and a lamp under an image.
fn under<S: Spectrum>(sky: &Sky) -> Scene<S> {
    let path = sky.path();
    scene(&format!(
        "
        [environment]
        file = '{path}'
        scale = 2
        up = [0.1, 0.9, 0.3]
        rotate = 20
        [materials.matt]
        kind = 'diffuse'
        reflectance = 0.5
        [[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 1
        material = 'matt'
        [[lights]]
        kind = 'point'
        position = [0, 0.5, 2]
        power = 5
        "
    ))
}

fn power_under_two_rows() -> Rgb {
    let size = tyndall_core::Geometry::bounds(&under::<Rgb>(&two_rows())).size();
    let disc = PI * (0.5 * size.length() * 1.001).powi(2);
    Rgb::splat(5.0 + 0.5 * 2.0 * 4.0 * PI * disc)
}

host_conformance! { name: sky_of_clouds, host: under::<Rgb>(&clouds()) }

host_conformance! { name: sky_of_clouds_in_one_channel, host: under::<f32>(&clouds()) }

host_conformance! {
    name: sky_of_two_rows,
    host: under::<Rgb>(&two_rows()),
    power: power_under_two_rows(),
}

/// An empty scene seen by this camera, on this film of 16 × 12 pixels.
fn camera(text: &str, film: &str) -> Scene<f32> {
    let text = format!(
        "
        [film]
        width = 16
        height = 12
        {film}
        [camera]
        position = [1, 2, 3]
        look_at = [0, 0, 0]
        {text}"
    );
    let file = SceneFile::parse(&text, Path::new("camera.toml"), &[]);
    file.and_then(|f| f.build())
        .unwrap_or_else(|e| panic!("{e}"))
}

host_conformance! { name: pinhole, host: camera("fov = 60", ""), checks: [sensor, importance] }

host_conformance! {
    name: pinhole_by_height,
    host: camera("vertical_fov = 50", ""),
    checks: [sensor, importance],
}

host_conformance! {
    name: thin_lens,
    host: camera("kind = 'thin_lens'\nfov = 60\nlens_radius = 0.3\nfocus_distance = 2", ""),
    checks: [sensor, importance],
}

host_conformance! {
    name: cropped_pinhole,
    host: camera("fov = 60", "crop = [2, 1, 9, 7]"),
    checks: [sensor, importance],
}

host_conformance! {
    name: cropped_thin_lens,
    host: camera(
        "kind = 'thin_lens'\nfov = 60\nlens_radius = 0.3\nfocus_distance = 2",
        "crop = [7, 5, 9, 7]",
    ),
    checks: [sensor, importance],
}

host_conformance! {
    name: orthographic,
    host: camera("kind = 'orthographic'\nwidth = 4", ""),
    checks: [sensor],
}

host_conformance! {
    name: filtered,
    host: camera("fov = 60", "filter = 'mitchell'"),
    checks: [sensor],
}

/// A roof of two triangles whose smooth normals lean away from the flat ones.
const ROOF: &str = "
v -1 -1 0
v 1 -1 0
v 1 1 0.3
v -1 1 0.3
vn -0.3 -0.4 1
vn 0.5 -0.1 1
vn 0.2 0.4 1
vn -0.4 0.3 1
f 1//1 2//2 3//3
f 1//1 3//3 4//4
";

/// Smooth normals create energy in paths from the light (Veach 1997, §5.3.4), so the materials
/// here keep little of it.
fn roof(material: &str) -> Scene<f32> {
    static PATH: OnceLock<String> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("roof.obj");
        std::fs::write(&path, ROOF).unwrap();
        path.display().to_string()
    });
    scene(&format!(
        "
        [environment]
        radiance = 1
        [materials.it]
        {material}
        [[shapes]]
        kind = 'obj'
        file = '{path}'
        material = 'it'
        "
    ))
}

host_conformance! {
    name: smooth_diffuse_mesh,
    host: roof("kind = 'diffuse'\n reflectance = 0.3"),
}

host_conformance! {
    name: smooth_metal_mesh,
    host: roof("kind = 'conductor'\n eta = 2\n k = 0\n roughness = 0.5"),
}
