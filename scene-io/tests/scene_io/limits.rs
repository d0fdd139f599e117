//! What a scene file may hold at most, and what becomes of it beyond.

use glam::Vec3;
use std::fs;
use std::path::Path;
use tyndall_core::{Geometry, Media, Medium, MediumId, Ray, Rgb, Shading, SurfaceKind};
use tyndall_scene_io::{Error, Scene, SceneFile, read_vol};
use tyndall_testkit::rng;

const HEAD: &str = "
    [film]
    width = 8
    height = 8
    [camera]
    position = [0, 0, 5]
    look_at = [0, 0, 0]
    fov = 60
";

fn load(text: &str, path: &Path) -> Result<Scene<f32>, Error> {
    SceneFile::parse(&format!("{HEAD}{text}"), path, &[])?.build()
}

fn scene(text: &str) -> Scene<f32> {
    load(text, Path::new("scene.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// Places are found in logarithmic time: a table of a million numbers in one line loads.
#[test]
fn long_lines_load() {
    let ones = "1, ".repeat(500_000);
    let text = format!(
        "[media.fog]\nkind = 'homogeneous'\nsigma_a = 1\nsigma_s = 1
        phase = {{ kind = 'tabulated', cosines = [{ones}], values = [{ones}] }}"
    );
    let why = load(&text, Path::new("x.toml")).err().unwrap().to_string();
    assert!(why.contains("cosines"), "{why}");
}

#[test]
fn meshes_without_triangles_are_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nf 1 2\n").unwrap();
    let text = "[materials.wall]\nkind = 'diffuse'\nreflectance = 1
        [[shapes]]\nkind = 'obj'\nfile = 'a.obj'\nmaterial = 'wall'\nemission = 3";
    let why = load(text, &folder.path().join("a.toml")).err().unwrap();
    assert!(why.to_string().contains("has no faces"), "{why}");
}

#[test]
fn vol_files_are_read_for_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("d.vol");
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1, 2, 1, 1, 1].into_iter().flat_map(i32::to_le_bytes));
    let floats = [0.0, 0.0, 0.0, 2.0, 1.0, 1.0, 0.25, 0.75];
    bytes.extend(floats.into_iter().flat_map(f32::to_le_bytes));
    fs::write(&path, bytes).unwrap();
    let volume = read_vol(&path).unwrap();
    assert_eq!((volume.resolution, volume.channels), ([2, 1, 1], 1));
    assert_eq!(volume.values, [0.25, 0.75]);
    let missing = read_vol(&folder.path().join("none.vol"));
    assert!(matches!(missing, Err(Error::Read { .. })));
}

#[test]
fn regular_tracking_has_no_noise() {
    let spread = |key: &str| {
        let scene = scene(&format!(
            "[media.smoke]\nkind = 'grid'\nplume = {{ resolution = 16 }}
            min = [-1, -1, -1]\nmax = [1, 1, 1]\nscale = 1\nalbedo = 0.5\n{key}
            [materials.air]\nkind = 'null'\ninside = 'smoke'
            [[shapes]]\nkind = 'box'\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nmaterial = 'air'"
        ));
        let ray = Ray::new(Vec3::new(0.05, -5.0, 0.05), Vec3::Y);
        let (t, hit) = scene.intersect(&ray, MediumId::VACUUM).unwrap();
        let smoke = scene.medium_across(&hit, ray.direction, MediumId::VACUUM);
        let inside = Ray::new(ray.at(t), Vec3::Y).up_to(2.0);
        let mut sampler = rng(1);
        let medium = scene.medium(smoke).unwrap();
        let found: Vec<f32> = (0..64)
            .map(|_| medium.transmittance(&inside, &mut sampler))
            .collect();
        assert!(found.iter().any(|t| *t > 0.0 && *t < 1.0), "{found:?}");
        found.iter().any(|t| *t != found[0])
    };
    assert!(spread("") && spread("transmittance = 'ratio'"));
    assert!(!spread("transmittance = 'regular'"));
}

/// Frosted glass of nearly the index around it lets light pass straight, and says so.
#[test]
fn frosted_glass_of_nearly_equal_index_is_not_there() {
    let ball = |ior: f32| {
        let scene = scene(&format!(
            "[materials.frost]\nkind = 'dielectric'\nior = {ior}\nroughness = 0.5
            [[shapes]]\nkind = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'frost'"
        ));
        let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
        let (_, hit) = scene.intersect(&ray, MediumId::VACUUM).unwrap();
        (scene.surface_kind(&hit), scene.has_null_surfaces())
    };
    assert_eq!(ball(1.0005), (SurfaceKind::Null, true));
    assert_eq!(ball(1.01), (SurfaceKind::Finite, false));
}

#[test]
fn unbounded_glow_is_named() {
    let glow = |sigma_a: &str| {
        let text = format!(
            "medium = 'fog'\n[media.fog]\nkind = 'homogeneous'\nsigma_a = {sigma_a}
            sigma_s = 0\nemission = [0, 1, 0]"
        );
        let file = SceneFile::parse(&format!("{HEAD}{text}"), Path::new("x.toml"), &[]);
        file.unwrap().build::<Rgb>().err().map(|e| e.to_string())
    };
    let why = glow("[1, 0, 1]").unwrap();
    assert!(why.contains("`camera.medium`: glows"), "{why}");
    assert_eq!(glow("[0, 1, 0]"), None);
}
