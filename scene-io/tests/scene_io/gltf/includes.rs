//! `[[include]]`: glTF files as parts of scene files.

use super::builder::{Builder, Folder, front, meet};
use image::{Rgba, RgbaImage};
use serde_json::json;
use tyndall_core::{Media, Medium, MediumId, Rgb, Sensor, Shading, SurfaceKind};
use tyndall_scene_io::{Error, Scene, SceneFile};

/// A cube of the material `Wall` with a camera, a lamp and a second scene, as `part.glb`.
fn part() -> (Folder, Builder) {
    let folder = Folder::new();
    let mut b = Builder::new();
    b.camera();
    let wall = b.push(
        "materials",
        json!({ "name": "Wall", "emissiveFactor": [1, 0, 0] }),
    );
    let cube = b.cube(Some(wall));
    b.node(json!({ "mesh": cube }));
    let aside = b.push("nodes", json!({ "mesh": cube, "translation": [3, 0, 0] }));
    b.push("scenes", json!({ "name": "aside", "nodes": [aside] }));
    folder.write("part.glb", b.glb());
    (folder, b)
}

fn load(folder: &Folder, text: &str) -> Result<Scene<Rgb>, Error> {
    SceneFile::parse(text, &folder.path().join("scene.toml"), &[])?.build()
}

fn scene(folder: &Folder, text: &str) -> Scene<Rgb> {
    load(folder, text).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn scene_files_add_to_what_they_include() {
    let (folder, _) = part();
    let scene = scene(
        &folder,
        "[camera]
        medium = 'fog'
        [media.fog]
        kind = 'homogeneous'
        sigma_a = 0.5
        sigma_s = 0.25
        [materials.air]
        kind = 'null'
        inside = 'fog'
        [[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 20
        material = 'air'
        [[include]]
        file = 'part.glb'
        [[include]]
        file = 'part.glb'
        transform = { scale = 2, translate = [-4, 0, 0] }",
    );
    assert_eq!(scene.resolution(), [640, 360]);
    let ray = scene.sensor_ray([320, 180], [0.0; 4]);
    assert_eq!(ray.ray.origin.to_array(), [0.0, 0.0, 5.0]);
    let fog = scene
        .medium(ray.medium)
        .and_then(|m| m.homogeneous())
        .unwrap();
    assert_eq!(fog.sigma_s.0.x, 0.25);
    assert_eq!(front(&scene, 0.4, 0.4).unwrap().position.z, 0.5);
    assert_eq!(front(&scene, -4.9, 0.9).unwrap().position.z, 1.0);
}

#[test]
fn a_camera_of_the_scene_file_holds() {
    let (folder, _) = part();
    let scene = scene(
        &folder,
        "[camera]\nposition = [1, 0, 9]\nlook_at = [0, 0, 0]\nfov = 30
        [film]\nwidth = 8\nheight = 6\n[[include]]\nfile = 'part.glb'",
    );
    assert_eq!(scene.resolution(), [8, 6]);
    assert_eq!(
        scene.sensor_ray([0, 0], [0.5; 4]).ray.origin.to_array(),
        [1.0, 0.0, 9.0]
    );
}

#[test]
fn lenses_are_added_to_cameras_of_files() {
    let (folder, _) = part();
    let scene = scene(
        &folder,
        "[camera]\nkind = 'thin_lens'\nlens_radius = 0.5\nfocus_distance = 4
        [[include]]\nfile = 'part.glb'",
    );
    let origin = scene.sensor_ray([0, 0], [0.5, 0.5, 0.9, 0.1]).ray.origin;
    let off = (origin - glam::Vec3::new(0.0, 0.0, 5.0)).length();
    assert!(off > 0.1 && off < 0.5, "{off}");
}

#[test]
fn materials_are_replaced_by_name() {
    let (folder, _) = part();
    let text = |name: &str| {
        format!(
            "[materials.glass]\nkind = 'dielectric'\nior = 1.5
            [[include]]\nfile = 'part.glb'\nmaterials = {{ {name} = 'glass' }}"
        )
    };
    let scene = scene(&folder, &text("Wall"));
    let (_, hit) = meet(&scene, [0.1, 0.1, 5.0], [0.0, 0.0, -1.0]).unwrap();
    assert_eq!(scene.surface_kind(&hit), SurfaceKind::Delta);
    let why = load(&folder, &text("Wal")).err().unwrap().to_string();
    assert!(why.contains("did you mean \"Wall\"?"), "{why}");
}

/// Texture coordinates of glTF run down the image, those of scene files up.
#[test]
fn textures_of_scene_files_stand_upright_on_meshes_of_files() {
    let folder = Folder::new();
    let mut b = Builder::new();
    b.camera();
    let wall = b.push("materials", json!({ "name": "Wall" }));
    let square = b.square(Some(wall));
    b.node(json!({ "mesh": square }));
    folder.write("wall.glb", b.glb());
    let image = RgbaImage::from_fn(2, 2, |x, y| {
        let red = if (x, y) == (0, 0) { 255 } else { 0 };
        Rgba([red, 0, 0, 255])
    });
    image.save(folder.path().join("four.png")).unwrap();
    let scene = scene(
        &folder,
        "[materials.lamp]
        kind = 'diffuse'
        reflectance = 0
        emission = { file = 'four.png', filter = 'nearest' }
        [[include]]
        file = 'wall.glb'
        materials = { Wall = 'lamp' }",
    );
    let red = |x, y| {
        let (_, hit) = meet(&scene, [x, y, 5.0], [0.0, 0.0, -1.0]).unwrap();
        scene.emitted(&hit, glam::Vec3::Z).0.x
    };
    // Red at the upper left alone.
    assert_eq!(red(-0.25, 0.3), 1.0);
    for (x, y) in [(0.25, 0.3), (-0.25, -0.3), (0.25, -0.3)] {
        assert_eq!(red(x, y), 0.0, "{x} {y}");
    }
}

#[test]
fn scenes_are_chosen_by_name_or_number() {
    let (folder, _) = part();
    let camera = "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nfov = 30
        [film]\nwidth = 8\nheight = 6\n[[include]]\nfile = 'part.glb'";
    for choice in ["'aside'", "1"] {
        let scene = scene(&folder, &format!("{camera}\nscene = {choice}"));
        assert!(front(&scene, 3.1, 0.1).is_some() && front(&scene, 0.1, 0.1).is_none());
    }
    for choice in ["'besides'", "2"] {
        let why = load(&folder, &format!("{camera}\nscene = {choice}"))
            .err()
            .unwrap();
        assert!(why.to_string().contains("`scenes`: has no scene"), "{why}");
    }
}

/// A fault within a file names both files.
#[test]
fn faults_name_the_scene_file_too() {
    let (folder, _) = part();
    folder.write("bad.gltf", r#"{ "asset": { "version": "1.0" } }"#);
    for (text, words) in [
        ("file = 'bad.gltf'", "bad.gltf: `asset.version`: is \"1.0\""),
        ("file = 'none.glb'", "none.glb: cannot be read"),
        ("file = 'part.obj'", "use `[[shapes]]`"),
        ("fil = 'part.glb'", "did you mean `file`?"),
        ("file = 'part.glb'\nlight = true", "did you mean `lights`?"),
        ("file = 'part.glb'\nlights = 'no'", "expected true or false"),
        ("file = 'part.glb'\nluminous_efficacy = 0", "a number > 0"),
        ("file = 'part.glb'\ncamera = 'eye'", "has no camera \"eye\""),
    ] {
        let why = load(&folder, &format!("[[include]]\n{text}"))
            .err()
            .unwrap()
            .to_string();
        let at_file = why.contains("scene.toml:2:") || why.contains("scene.toml:3:");
        assert!(
            at_file && why.contains("include.0") && why.contains(words),
            "{text}: {why}"
        );
    }
}

/// The same scene in metres and in centimetres: coefficients of media follow lengths.
#[test]
fn media_follow_the_scale() {
    let sigma = |scale: f32| {
        let folder = Folder::new();
        let mut b = Builder::new();
        b.camera();
        let extras =
            json!({ "tyndall": { "surface": "none", "sigma_a": 2, "sigma_s": [1, 2, 3] } });
        let fog = b.push("materials", json!({ "extras": extras }));
        let cube = b.cube(Some(fog));
        b.node(json!({ "mesh": cube }));
        folder.write("fog.glb", b.glb());
        let scene = scene(
            &folder,
            &format!("[[include]]\nfile = 'fog.glb'\ntransform = {{ scale = {scale} }}"),
        );
        let (_, hit) = meet(&scene, [0.0, 0.0, 5.0 * scale], [0.0, 0.0, -1.0]).unwrap();
        let inside = scene.medium_across(&hit, glam::Vec3::NEG_Z, MediumId::VACUUM);
        let medium = scene.medium(inside).and_then(|m| m.homogeneous()).unwrap();
        (medium.sigma_a.0 * scale, medium.sigma_s.0 * scale)
    };
    let (a, s) = sigma(100.0);
    let (b, t) = sigma(1.0);
    assert!((a - b).length() < 1e-5 && (s - t).length() < 1e-5);
    assert_eq!((b.x, t.y), (2.0, 2.0));
}
