//! Media that volume files fill, and several in the same place.

use glam::{DAffine3, DMat3, DVec3, IVec3, Vec3};
use tempfile::TempDir;
use tyndall_core::{Coefficients, Geometry, Media, Medium, Ray, Rgb, Sensor, Spectrum};
use tyndall_media::{BlackBody, SparseBuilder, SparseGrid};
use tyndall_scene_io::{
    GridClass, NanoCodec, Scene, SceneFile, Summary, VolumeGrid, Voxels, write_nano_vdb,
    write_open_vdb,
};

/// The camera, and what is around it.
const VIEW: &str = "
    [camera]
    position = [0, 0, 50]
    look_at = [0, 0, 0]
    fov = 40
    medium = 'cloud'
    [film]
    width = 4
    height = 4
    [environment]
    radiance = 1
";
const CLOUD: &str = "
    [media.cloud]
    kind = 'grid'
    file = 'cloud.vdb'
    scale = 2
    albedo = 0.5
";

/// A tenth of a unit a voxel, half a unit off.
fn to_world() -> DAffine3 {
    DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(0.1)), DVec3::splat(0.5))
}

/// Voxels (i, j, k) of 1 + i + 10·j, from 0 to 3.
fn ramp(to_world: DAffine3) -> SparseGrid {
    let mut grid = SparseBuilder::new(0.0);
    for i in 0..64 {
        let ijk = IVec3::new(i % 4, i / 4 % 4, i / 16);
        grid.voxel(ijk, (1 + ijk.x + 10 * ijk.y) as f32).unwrap();
    }
    grid.build(to_world).unwrap()
}

fn colours() -> SparseGrid<Rgb> {
    let mut grid = SparseBuilder::new(Rgb::default());
    for i in 0..64 {
        let ijk = IVec3::new(i % 4, i / 4 % 4, i / 16);
        let colour = Rgb::new(0.5, 0.25 * ijk.x as f32, 0.125);
        grid.voxel(ijk, colour).unwrap();
    }
    grid.build(to_world()).unwrap()
}

fn fog(name: &str, grid: SparseGrid) -> VolumeGrid {
    VolumeGrid::new(name, GridClass::FogVolume, Voxels::Scalar(grid))
}

/// A folder with a volume of density, colour, temperature and velocity, and others.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let vector = |name| VolumeGrid::new(name, GridClass::Unknown, Voxels::Vector(colours()));
    let level = VolumeGrid::new(
        "surface",
        GridClass::LevelSet,
        Voxels::Scalar(ramp(to_world())),
    );
    let mut bad = SparseBuilder::new(0.0);
    bad.voxel(IVec3::new(1, 2, 3), -4.0).unwrap();
    let bad = fog("bad", bad.build(to_world()).unwrap());
    let (density, heat) = (
        fog("density", ramp(to_world())),
        fog("temperature", ramp(to_world())),
    );
    let all = [
        density.clone(),
        heat,
        vector("Cd"),
        vector("vel"),
        level.clone(),
        bad,
    ];
    let path = |name| folder.path().join(name);
    write_open_vdb(&path("cloud.vdb"), &all).unwrap();
    write_open_vdb(&path("surface.vdb"), &[level]).unwrap();
    write_open_vdb(&path("twice.vdb"), &[density.clone(), density.clone()]).unwrap();
    write_nano_vdb(&path("cloud.nvdb"), &[density], NanoCodec::Zip).unwrap();
    folder
}

fn load(folder: &TempDir, text: &str, overrides: &[(&str, &str)]) -> Result<SceneFile, String> {
    let overrides: Vec<_> = (overrides.iter())
        .map(|(k, v)| (k.to_string(), v.to_string()))
        .collect();
    let path = folder.path().join("scene.toml");
    SceneFile::parse(text, &path, &overrides).map_err(|e| e.to_string())
}

fn scene(folder: &TempDir, text: &str, overrides: &[(&str, &str)]) -> Scene<Rgb> {
    let file = load(folder, text, overrides).unwrap();
    file.build().unwrap()
}

/// What there is around the camera, at a point of the file.
fn at(scene: &Scene<Rgb>, p: DVec3) -> Coefficients<Rgb> {
    let p = (p - scene.origin()).as_vec3();
    let start = scene.sensor_ray([0, 0], [0.5; 4]);
    let medium = scene.medium(start.medium);
    medium.map_or(Coefficients::default(), |m| m.coefficients(p))
}

fn near(a: f32, b: f32) {
    assert!((a - b).abs() <= 1e-5 * b.abs().max(1e-3), "{a}, not {b}");
}

#[test]
fn densities_are_where_the_file_and_the_transformation_put_them() {
    let folder = folder();
    for name in ["cloud.vdb", "cloud.nvdb"] {
        let file = format!("'{name}'");
        let scene = scene(
            &folder,
            &[VIEW, CLOUD].concat(),
            &[("media.cloud.file", &file)],
        );
        let here = at(&scene, DVec3::new(0.65, 0.6, 0.55));
        // Voxel 1.5, 1, 0.5: a density of 12.5.
        near(here.sigma_s.0.x, 12.5);
        near(here.sigma_a.0.x, 12.5);
        assert!(
            scene
                .bounds()
                .contains(Vec3::splat(0.65) - scene.origin().as_vec3()),
            "without a shape"
        );
    }
    let turned = "
        transform = { scale = 2, rotate = { axis = [0, 0, 1], degrees = 90 }, translate = [0, 0, 7] }
        filter = 'nearest'
    ";
    let scene = scene(&folder, &[VIEW, CLOUD, turned].concat(), &[]);
    // Voxel 2, 1, 0 at (.7, .6, .5), then (1.4, 1.2, 1), then (−1.2, 1.4, 8).
    near(
        at(&scene, DVec3::new(-1.25, 1.45, 7.95)).sigma_t().0.x,
        26.0,
    );
}

#[test]
fn colours_and_temperatures_are_those_of_the_grids() {
    let folder = folder();
    let fire = "
        temperature = { factor = 100, relative_to = 1900, luminance = 5 }
    ";
    let scene = scene(&folder, &[VIEW, CLOUD, fire].concat(), &[]);
    // Voxel 3, 1, 2: a density of 14, and so 1400 K.
    let p = DVec3::new(0.8, 0.6, 0.7);
    let here = at(&scene, p);
    let body = BlackBody::relative_to(1900.0).unwrap();
    let expected = here.sigma_a * body.colour(1400.0) * 5.0;
    for c in 0..3 {
        let (seen, expected) = (here.emission.channel(c), expected.channel(c));
        assert!(
            (seen - expected).abs() < 1e-4 * expected.max(1.0),
            "{c}: {seen}, {expected}"
        );
    }
    let text = [
        VIEW,
        &CLOUD.replace("albedo = 0.5", "albedo = { grid = 'Cd', factor = 1.25 }"),
    ];
    let coloured = load(&folder, &text.concat(), &[]).unwrap();
    assert!(!coloured.is_grey());
    let here = at(&coloured.build().unwrap(), p);
    let Rgb(share) = here.sigma_s / 28.0;
    assert!(
        (share - 1.25 * Vec3::new(0.5, 0.75, 0.125))
            .abs()
            .max_element()
            < 1e-4
    );
}

#[test]
fn media_in_the_same_place_add() {
    let folder = folder();
    let haze = "
        [media.haze]
        kind = 'atmosphere'
        sigma_a = 1
        sigma_s = [0, 1, 2]
        scale_height = 2
        origin = [0, -1, 0]
        [media.fog]
        kind = 'homogeneous'
        sigma_a = 0.125
        sigma_s = 0
    ";
    let both = ("camera.medium", "['haze', 'cloud']");
    let scene = scene(&folder, &[VIEW, CLOUD, haze].concat(), &[both]);
    let p = DVec3::new(0.8, 0.6, 0.7);
    let Coefficients {
        sigma_a, sigma_s, ..
    } = at(&scene, p);
    let thin = (-0.8_f32).exp();
    for c in 0..3 {
        near(sigma_a.channel(c), 14.0 + thin);
        near(sigma_s.channel(c), 14.0 + thin * c as f32);
    }
    // Outside of the cloud there is haze alone.
    near(
        at(&scene, DVec3::new(9.0, 1.0, 0.0)).sigma_a.0.x,
        (-1.0_f32).exp(),
    );
}

/// Two null boxes that overlap in fog: both add, and the camera looks through all.
#[test]
fn null_shapes_that_add_fill_what_they_overlap() {
    let folder = folder();
    let boxes = "
        [media.fog]
        kind = 'homogeneous'
        sigma_a = 0.125
        sigma_s = 0
        [media.ink]
        kind = 'homogeneous'
        sigma_a = 3
        sigma_s = 0
        [materials.cloud]
        kind = 'null'
        inside = 'cloud'
        adds = true
        [materials.ink]
        kind = 'null'
        inside = 'ink'
        adds = true
        [[shapes]]
        kind = 'box'
        min = [0, 0, 0]
        max = [1, 1, 1]
        material = 'cloud'
        [[shapes]]
        kind = 'box'
        min = [0.5, -1, 0.25]
        max = [2, 2, 0.75]
        material = 'ink'
    ";
    let text = [VIEW, CLOUD, boxes].concat();
    let in_fog = ("camera.medium", "'fog'");
    let seen = scene(&folder, &text, &[in_fog]);
    let p = DVec3::new(0.8, 0.6, 0.7);
    let mut ray = Ray::new(Vec3::new(0.8, 0.6, 50.0), -Vec3::Z);
    let mut medium = seen.sensor_ray([0, 0], [0.5; 4]).medium;
    let mut met = Vec::new();
    while let Some((_, hit)) = seen.intersect(&ray, medium) {
        medium = seen.medium_across(&hit, ray.direction, medium);
        met.push(
            seen.medium(medium)
                .unwrap()
                .coefficients(p.as_vec3())
                .sigma_t()
                .0
                .x,
        );
        ray = seen.spawn(&tyndall_core::Anchor::Surface(hit), ray.direction);
    }
    let expected = [28.125, 31.125, 28.125, 0.125];
    assert_eq!(met.len(), expected.len());
    met.into_iter().zip(expected).for_each(|(a, b)| near(a, b));
    // Inside both, the camera knows where it is.
    let inside = [
        ("camera.position", "[0.8, 0.6, 0.7]"),
        ("camera.medium", "['fog', 'cloud', 'ink']"),
    ];
    let within = load(&folder, &text, &inside).unwrap();
    let error = within.build::<f32>().map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("filled with \"cloud + ink\""), "{error}");
    let text = text.replace("medium = 'cloud'", "");
    let within = scene(&folder, &text, &inside[..1]);
    near(at(&within, p).sigma_t().0.x, 31.0);
}

/// A volume alone, farther away than `f32` can tell its voxels apart.
#[test]
fn far_volumes_are_moved_to_the_origin() {
    let folder = folder();
    let far = "transform = { translate = [1e7, 2e7, -3e7] }";
    let position = ("camera.position", "[10000000, 20000000, -29999950]");
    let target = ("camera.look_at", "[10000000, 20000000, -30000000]");
    let file = load(&folder, &[VIEW, CLOUD, far].concat(), &[position, target]).unwrap();
    let scene: Scene<Rgb> = file.build().unwrap();
    let here = at(&scene, DVec3::new(1e7 + 0.8, 2e7 + 0.6, -3e7 + 0.7));
    assert!((here.sigma_t().0.x - 28.0).abs() < 1e-3, "{here:?}");
}

#[test]
fn files_are_listed_and_what_is_left_out_is_said() {
    let folder = folder();
    let file = load(&folder, &[VIEW, CLOUD].concat(), &[]).unwrap();
    assert_eq!(file.sources(), [folder.path().join("cloud.vdb")]);
    let [notice] = file.notices() else {
        panic!("{:?}", file.notices());
    };
    assert!(notice.contains("temperature, Cd, vel"), "{notice}");
    assert!(notice.contains("velocity"), "{notice}");
    assert!(file.is_grey());
    let scene = file.build::<f32>().unwrap();
    let summary = Summary::new(&file, &scene);
    let [cloud] = summary.media.as_slice() else {
        panic!("{summary:?}");
    };
    assert_eq!((cloud.kind, cloud.active_voxels), ("sparse grid", Some(64)));
    // Along x through the densest row, of 31, 32, 33 and 34 and half a voxel's slope on each side.
    assert!(cloud.fills_space && cloud.grid_bytes > 2048);
    assert!(
        cloud.optical_depth > 2.0 * 0.1 * 100.0,
        "{}",
        cloud.optical_depth
    );
}

#[test]
fn two_media_may_name_one_grid() {
    let folder = folder();
    let again = CLOUD.replace("media.cloud", "media.again") + "transform = { scale = 3 }";
    let text = [VIEW, CLOUD, &again].concat();
    let one = load(&folder, &[VIEW, CLOUD].concat(), &[]).unwrap();
    let two = load(&folder, &text, &[("camera.medium", "['cloud', 'again']")]).unwrap();
    let scene: Scene<Rgb> = two.build().unwrap();
    near(at(&scene, DVec3::new(2.4, 1.8, 2.1)).sigma_t().0.x, 28.0);
    assert_eq!(one.sources(), two.sources());
}

/// Keys, values, and what the message must hold.
#[test]
fn what_is_wrong_with_a_volume_is_said() {
    let folder = folder();
    for (overrides, words) in [
        (
            &[("media.cloud.file", "'none.vdb'")][..],
            ["media.cloud.file", "none.vdb"],
        ),
        (
            &[("media.cloud.file", "'scene.toml'")],
            ["media.cloud.file", "scene.toml"],
        ),
        (
            &[("media.cloud.grid", "'densty'")],
            ["media.cloud.grid", "did you mean \"density\"?"],
        ),
        (
            &[("media.cloud.grid", "'smoke'")],
            ["media.cloud.grid", "`Cd`"],
        ),
        (
            &[("media.cloud.grid", "'Cd'")],
            ["cloud.vdb", "vectors where numbers"],
        ),
        (&[("media.cloud.grid", "'surface'")], ["level set", "--fog"]),
        (
            &[("media.cloud.file", "'surface.vdb'")],
            ["level set", "--fog"],
        ),
        (
            &[("media.cloud.grid", "'bad'")],
            ["cloud.vdb", "voxel [1, 2, 3] of a grid is -4"],
        ),
        (
            &[("media.cloud.file", "'twice.vdb'")],
            ["2 grids \"density\"", "different names"],
        ),
        (
            &[("media.cloud.min", "[0, 0, 0]")],
            ["media.cloud.min", "unknown key"],
        ),
        (
            &[("media.cloud.transmittance", "'regular'")],
            ["media.cloud.transmittance", "unknown key"],
        ),
        (
            &[("media.cloud.transform", "{ scale = 0 }")],
            ["media.cloud", "above 0"],
        ),
        (
            &[("media.cloud.filter", "'cubic'")],
            ["media.cloud.filter", "cubic"],
        ),
        (
            &[("media.cloud.albedo", "{ grid = 'Cd', factor = 2 }")],
            ["media.cloud.albedo", "at most 1 by `factor`"],
        ),
        (
            &[("media.cloud.albedo", "'cloud.vdb'")],
            ["media.cloud.albedo", "`grid`"],
        ),
        (
            &[
                ("media.cloud.emission", "1"),
                ("media.cloud.temperature", "{}"),
            ],
            ["media.cloud.temperature", "exclude"],
        ),
        (
            &[("media.cloud.temperature", "{ relative_to = 20 }")],
            ["relative_to", "500"],
        ),
        (
            &[("media.cloud.temperature", "{ luminance = 2 }")],
            ["luminance", "unknown key"],
        ),
        (
            &[("camera.medium", "['cloud', 'vacuum']")],
            ["camera.medium", "vacuum"],
        ),
        (
            &[("camera.medium", "['cloud', 'cloud']")],
            ["camera.medium", "twice"],
        ),
    ] {
        let message = load(&folder, &[VIEW, CLOUD].concat(), overrides).map(|_| ());
        let message = message.expect_err(&format!("{overrides:?}"));
        for word in words {
            assert!(message.contains(word), "{overrides:?}: {message}");
        }
    }
}
