//! What a scene file means, seen through the traits of the host.

use glam::{DVec3, Vec3};
use std::fs;
use std::path::Path;
use tyndall_core::{
    Anchor, Geometry, LightEmission, Media, Medium, MediumId, PathFrom, Ray, Rgb, Sensor, Shading,
    Spectrum, SurfaceKind,
};
use tyndall_scene_io::{Hit, Scene, SceneFile};

const HEAD: &str = "
    [film]
    width = 16
    height = 12
    [camera]
    position = [0, 0, 5]
    look_at = [0, 0, 0]
    fov = 60
";

fn file(text: &str) -> SceneFile {
    let text = format!("{HEAD}{text}");
    SceneFile::parse(&text, Path::new("scene.toml"), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn scene<S: Spectrum>(text: &str) -> Scene<S> {
    file(text).build().unwrap_or_else(|e| panic!("{e}"))
}

/// The medium in which the sensor's rays start.
fn at_sensor<S: Spectrum>(scene: &Scene<S>) -> MediumId {
    scene.sensor_ray([0, 0], [0.5; 4]).medium
}

/// Every surface on the line through the scene along −z from z = 5: the z of the hit, its kind, the
/// extinction behind it.
fn crossings(scene: &Scene<f32>) -> Vec<(f32, SurfaceKind, f32)> {
    let mut here = at_sensor(scene);
    let mut ray = Ray::new(Vec3::new(0.01, 0.02, 5.0), Vec3::NEG_Z);
    let mut found = Vec::new();
    while let Some((_, hit)) = scene.intersect(&ray, here) {
        here = scene.medium_across(&hit, ray.direction, here);
        found.push((
            scene.surface(&hit).position.z,
            scene.surface_kind(&hit),
            sigma_t(scene, here),
        ));
        ray = scene.spawn(&Anchor::Surface(hit), ray.direction);
    }
    found
}

fn sigma_t(scene: &Scene<f32>, id: MediumId) -> f32 {
    let medium = scene.medium(id).and_then(|m| m.homogeneous());
    medium.map_or(0.0, |c| c.sigma_t())
}

/// A tumbler of glass (box with a cavity) and water that reaches into its wall, in fog.
const TUMBLER: &str = "
    [media.fog]
    kind = 'homogeneous'
    sigma_a = 1
    sigma_s = 0
    [media.glass]
    kind = 'homogeneous'
    sigma_a = 2
    sigma_s = 0
    [media.water]
    kind = 'homogeneous'
    sigma_a = 3
    sigma_s = 0
    [materials.fog]
    kind = 'null'
    inside = 'fog'
    [materials.glass]
    kind = 'dielectric'
    ior = 1.5
    inside = 'glass'
    priority = 2
    [materials.air]
    kind = 'null'
    priority = 3
    [materials.water]
    kind = 'dielectric'
    ior = 1.33
    inside = 'water'
    priority = 4
    [[shapes]]
    kind = 'box'
    min = [-4, -4, -4]
    max = [4, 4, 4]
    material = 'fog'
    [[shapes]]
    kind = 'box'
    min = [-2, -2, -2]
    max = [2, 2, 2]
    material = 'glass'
    [[shapes]]
    kind = 'box'
    min = [-1, -1, -1]
    max = [1, 1, 1]
    material = 'water'
";

#[test]
fn nested_boundaries_hold_by_priority() {
    use SurfaceKind::{Delta, Null};
    let along = |text: &str| -> Vec<_> {
        (crossings(&scene(text)).into_iter())
            .map(|(z, kind, s)| (z.round(), kind, s))
            .collect()
    };
    let water_wins = [
        (4.0, Null, 1.0),
        (2.0, Delta, 2.0),
        (1.0, Delta, 3.0),
        (-1.0, Delta, 2.0),
        (-2.0, Delta, 1.0),
        (-4.0, Null, 0.0),
    ];
    assert_eq!(along(TUMBLER), water_wins);
    // Of lower priority, the water is not there at all: light passes its faces.
    let glass_wins = water_wins.map(|(z, kind, s)| match z {
        1.0 | -1.0 => (z, Null, 2.0),
        _ => (z, kind, s),
    });
    let text = TUMBLER.replace("priority = 4", "priority = 1");
    assert_eq!(along(&text), glass_wins);
    assert!(scene::<f32>(&text).has_null_surfaces());
}

#[test]
fn glass_refracts_by_the_indices_on_both_its_sides() {
    let scene = scene::<f32>(TUMBLER);
    let mut here = at_sensor(&scene);
    let mut ray = Ray::new(Vec3::new(0.01, 0.02, 5.0), Vec3::NEG_Z);
    let mut etas = Vec::new();
    while let Some((_, hit)) = scene.intersect(&ray, here) {
        // Straight on, never reflected: u = 1 lies beyond the reflectance.
        let u = [0.5, 0.5, 1.0_f32.next_down()];
        let sample = scene
            .bsdf_sample(&hit, -ray.direction, u, PathFrom::Sensor)
            .unwrap();
        assert!((sample.weight * sample.eta * sample.eta - 1.0).abs() < 1e-5);
        etas.push(sample.eta);
        here = scene.medium_across(&hit, sample.wi, here);
        ray = scene.spawn(&Anchor::Surface(hit), sample.wi);
    }
    let expected = [1.0, 1.5, 1.33 / 1.5, 1.5 / 1.33, 1.0 / 1.5, 1.0];
    assert_eq!(etas.len(), expected.len());
    for (eta, expected) in etas.iter().zip(expected) {
        assert!((eta - expected).abs() < 1e-6, "{etas:?}");
    }
}

#[test]
fn light_totally_reflected_stays_in_its_medium() {
    let scene = scene::<f32>(TUMBLER);
    let inside = Ray::new(Vec3::new(0.3, 0.2, 1.5), Vec3::new(0.8, 0.0, 0.6));
    let mut here = at_sensor(&scene);
    for z in [5.0, 3.0] {
        let ray = Ray::new(Vec3::new(0.3, 0.2, z), Vec3::NEG_Z);
        let (_, hit) = scene.intersect(&ray, here).unwrap();
        here = scene.medium_across(&hit, ray.direction, here);
    }
    assert_eq!(sigma_t(&scene, here), 2.0);
    let (_, hit) = scene.intersect(&inside, here).unwrap();
    let wo = -inside.direction;
    // sin θ = 0.8 in glass lies beyond the critical angle, whose sine is 1/1.5.
    let u = [0.5, 0.5, 1.0_f32.next_down()];
    let sample = scene.bsdf_sample(&hit, wo, u, PathFrom::Light).unwrap();
    assert_eq!(sample.eta, 1.0);
    assert_eq!(scene.medium_across(&hit, sample.wi, here), here);
}

#[test]
fn camera_and_lights_know_their_medium() {
    let lit = |position: &str| {
        let lights = format!("[[lights]]\nkind = 'point'\nposition = {position}\npower = 1");
        let scene = scene::<f32>(&format!("{TUMBLER}{lights}"));
        let sample = scene.sample_emission([0.5; 6]).unwrap();
        sigma_t(&scene, sample.medium)
    };
    assert_eq!(
        ["[0, 4.5, 0]", "[3, 0, 0]", "[0, 1.5, 0]", "[0, 0, 0]"].map(lit),
        [0.0, 1.0, 2.0, 3.0]
    );
    let place = |z: &str| {
        let overrides = [("camera.position".to_owned(), format!("[0.1, 0.2, {z}]"))];
        let file = SceneFile::parse(&format!("{HEAD}{TUMBLER}"), Path::new("x.toml"), &overrides);
        let scene = file.unwrap().build::<f32>().unwrap();
        sigma_t(&scene, at_sensor(&scene))
    };
    assert_eq!(["5", "3", "1.5", "0.5"].map(place), [0.0, 1.0, 2.0, 3.0]);
    let fog = "[media.fog]\nkind = 'homogeneous'\nsigma_a = 7\nsigma_s = 0";
    let text = format!("{HEAD}medium = 'fog'\n{fog}");
    let scene = SceneFile::parse(&text, Path::new("x.toml"), &[]).unwrap();
    let scene = scene.build::<f32>().unwrap();
    assert_eq!(sigma_t(&scene, at_sensor(&scene)), 7.0);
}

#[test]
fn beside_a_slanting_slab_is_not_inside_it() {
    let slab = "
        [media.fog]
        kind = 'homogeneous'
        sigma_a = 1
        sigma_s = 0
        [materials.fog]
        kind = 'null'
        inside = 'fog'
        [[shapes]]
        kind = 'box'
        min = [-9, -0.1, -9]
        max = [9, 0.1, 9]
        transform = { rotate = { axis = [0, 0, 1], degrees = -45 } }
        material = 'fog'
    ";
    let at = |p: &str| {
        let lamp = format!("[[lights]]\nkind = 'point'\nposition = {p}\npower = 1");
        let scene = scene::<f32>(&format!("{slab}{lamp}"));
        sigma_t(&scene, scene.sample_emission([0.5; 6]).unwrap().medium)
    };
    let sides = ["[0.3, 0.3, 0]", "[-0.3, -0.3, 0]", "[0.05, 0.05, 0.1]"];
    assert_eq!(sides.map(at), [0.0, 0.0, 1.0]);
}

#[test]
fn scenes_far_from_the_origin_are_moved_there() {
    let at = |x: f64| {
        let text = format!(
            "
            [film]
            width = 8
            height = 8
            [camera]
            position = [{x}, 0, 5]
            look_at = [{x}, 0, 0]
            fov = 30
            [materials.wall]
            kind = 'diffuse'
            reflectance = 0.5
            [[shapes]]
            kind = 'sphere'
            center = [{x}, 0, 0]
            radius = 0.015625
            material = 'wall'
            [[lights]]
            kind = 'point'
            position = [{x}, 1, 0]
            power = 1
            "
        );
        let file = SceneFile::parse(&text, Path::new("x.toml"), &[]).unwrap();
        file.build::<f32>().unwrap()
    };
    let (near, far) = (at(0.0), at(1e9 + 0.125));
    assert_eq!(near.origin(), DVec3::ZERO);
    assert_eq!(far.origin(), DVec3::new(1e9 + 0.125, 0.0, 0.0));
    let ray = |scene: &Scene<f32>| {
        let ray = scene.sensor_ray([4, 4], [0.0; 4]).ray;
        scene.intersect(&ray, MediumId::VACUUM).unwrap().0
    };
    assert_eq!(ray(&near), ray(&far));
    let lamp = |scene: &Scene<f32>| scene.sample_emission([0.5; 6]).unwrap().ray.origin;
    assert_eq!(lamp(&near), lamp(&far));
}

#[test]
fn grey_scenes_are_told_from_coloured_ones() {
    let wall = |c: &str| {
        let wall = format!("[materials.wall]\nkind = 'diffuse'\nreflectance = {c}\n");
        let ball = "[[shapes]]\nkind = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'wall'";
        file(&format!("{wall}{ball}"))
    };
    assert!(wall("0.3").is_grey() && wall("[0.3, 0.3, 0.3]").is_grey());
    let coloured = wall("[0.3, 0.6, 0.9]");
    assert!(!coloured.is_grey());
    let (t, hit) = hit_ahead(&coloured.build::<f32>().unwrap());
    assert_eq!(t, 4.0);
    let f = |s: &Scene<f32>| s.bsdf_eval(&hit, Vec3::Z, Vec3::Z, PathFrom::Sensor);
    assert!((f(&coloured.build().unwrap()) - 0.6 / std::f32::consts::PI).abs() < 1e-6);
    assert!(!file("[environment]\nradiance = [1, 0, 0]").is_grey());
    let fog = "[media.fog]\nkind = 'homogeneous'\nsigma_a = [0, 0, 1]\nsigma_s = 1";
    assert!(!file(fog).is_grey());
}

fn hit_ahead<S: Spectrum>(scene: &Scene<S>) -> (f32, Hit) {
    let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
    scene.intersect(&ray, at_sensor(scene)).unwrap()
}

/// A quad of two triangles, one of them blue by the MTL file, the other without normals.
const OBJ: &str = "mtllib a.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vn 0 0 1
usemtl blue
f 1//1 2//1 3//1
usemtl red
f 1 3 4
";
const MTL: &str = "newmtl blue\nKd 0 0 0.5\nKe 0 0 2\nnewmtl red\nKd 0.5 0 0\n";

#[test]
fn obj_files_bring_or_borrow_materials() {
    let folder = tempfile::tempdir().unwrap();
    let load = |keys: &str| {
        let text = format!(
            "{HEAD}
            [materials.wall]\nkind = 'diffuse'\nreflectance = 1
            [[shapes]]\nkind = 'obj'\nfile = 'a.obj'\n{keys}"
        );
        SceneFile::parse(&text, &folder.path().join("a.toml"), &[])
    };
    let look = |keys: &str, p: Vec3| {
        let scene: Scene<Rgb> = load(keys)
            .and_then(|f| f.build())
            .unwrap_or_else(|e| panic!("{e}"));
        let ray = Ray::new(p + 3.0 * Vec3::Z, Vec3::NEG_Z);
        let (_, hit) = scene.intersect(&ray, MediumId::VACUUM).unwrap();
        let f = scene.bsdf_eval(&hit, Vec3::Z, Vec3::Z, PathFrom::Sensor);
        (f * std::f32::consts::PI, scene.emitted(&hit, Vec3::Z))
    };
    fs::write(folder.path().join("a.obj"), OBJ).unwrap();
    let why = load("").unwrap_err().to_string();
    assert!(
        why.contains("`shapes.0.file`") && why.contains("MTL"),
        "{why}"
    );
    fs::write(folder.path().join("a.mtl"), MTL).unwrap();
    let (blue, red) = (Vec3::new(0.5, -0.5, 0.0), Vec3::new(-0.5, 0.5, 0.0));
    let black = Rgb::default();
    assert_eq!(
        look("", blue),
        (Rgb::new(0.0, 0.0, 0.5), Rgb::new(0.0, 0.0, 2.0))
    );
    assert_eq!(look("", red), (Rgb::new(0.5, 0.0, 0.0), black));
    let white = Rgb::splat(1.0);
    let map = "materials = { red = 'wall' }";
    assert_eq!(look(map, red), (white, black));
    assert_eq!(look(map, blue).0, Rgb::new(0.0, 0.0, 0.5));
    assert_eq!(
        look("material = 'wall'\nemission = 3", blue),
        (white, white * 3.0)
    );
    let moved = "transform = { scale = 2, rotate = { axis = [0, 0, 1], degrees = 180 }, translate = [0, 0, 1] }";
    assert_eq!(look(moved, 2.0 * red).0, Rgb::new(0.0, 0.0, 0.5));
    let why = load("materials = { rod = 'wall' }")
        .unwrap_err()
        .to_string();
    assert!(why.contains("did you mean \"red\"?"), "{why}");
    fs::write(
        folder.path().join("a.obj"),
        OBJ.replace("f 1 3 4", "f 1 3 9"),
    )
    .unwrap();
    let why = load("").unwrap_err().to_string();
    assert!(
        why.contains("a.toml:") && why.contains("a.obj: is no OBJ file"),
        "{why}"
    );
}

#[test]
fn grids_are_read_from_vol_files() {
    let folder = tempfile::tempdir().unwrap();
    let vol = |channels: i32, values: &[f32]| {
        let mut bytes = b"VOL\x03".to_vec();
        for word in [1, 2, 1, 1, channels] {
            bytes.extend(i32::to_le_bytes(word));
        }
        for x in [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0_f32].iter().chain(values) {
            bytes.extend(x.to_le_bytes());
        }
        bytes
    };
    fs::write(folder.path().join("d.vol"), vol(1, &[1.0, 3.0])).unwrap();
    let albedo = [0.5, 0.25, 0.0, 1.0, 0.75, 0.5];
    fs::write(folder.path().join("a.vol"), vol(3, &albedo)).unwrap();
    let text = format!(
        "{HEAD}
        [media.smoke]\nkind = 'grid'\nfile = 'd.vol'\nscale = 2\nalbedo = 'a.vol'
        [materials.air]\nkind = 'null'\ninside = 'smoke'
        [[shapes]]\nkind = 'box'\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nmaterial = 'air'"
    );
    let file = SceneFile::parse(&text, &folder.path().join("a.toml"), &[]).unwrap();
    assert!(!file.is_grey());
    let scene = file.build::<Rgb>().unwrap();
    let (_, hit) = hit_ahead(&scene);
    let smoke = scene.medium_across(&hit, Vec3::NEG_Z, MediumId::VACUUM);
    let at = |x: f32| {
        scene
            .medium(smoke)
            .unwrap()
            .coefficients(Vec3::new(x, 0.0, 0.0))
    };
    assert_eq!(at(-0.5).sigma_s, Rgb::new(1.0, 0.5, 0.0));
    assert_eq!(at(-0.5).sigma_a, Rgb::new(1.0, 1.5, 2.0));
    assert_eq!(at(0.5).sigma_s, Rgb::new(6.0, 4.5, 3.0));
}

/// The candle, whose camera, media and light are in its `.aux`; skipped where it is not.
#[test]
fn the_candle_loads() {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/candle");
    let folder = std::env::var_os("TYNDALL_CANDLE").map_or(default, Into::into);
    if !folder.join("candle.obj").exists() {
        return;
    }
    let text = "
        [film]\nwidth = 8\nheight = 8
        [camera]
        position = [-84.8188, 22.9605, 31.0322]\nlook_at = [-83.9528, 22.9605, 30.5322]
        up = [0, 0, 1]\nfov = 45
        [media.wax]\nkind = 'homogeneous'\nsigma_a = 0\nsigma_s = 2
        [materials.wax]\nkind = 'null'\ninside = 'wax'\npriority = 1
        [materials.flame]\nkind = 'diffuse'\nreflectance = 0\nemission = 100
        [[shapes]]
        kind = 'obj'\nfile = 'candle.obj'\nmaterials = { svicka = 'wax', Svetlo = 'flame' }
    ";
    let file = SceneFile::parse(text, &folder.join("candle.toml"), &[]);
    let scene = file
        .and_then(|f| f.build::<f32>())
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(at_sensor(&scene), MediumId::VACUUM);
    assert!(scene.sample_emission([0.5; 6]).is_some());
}
