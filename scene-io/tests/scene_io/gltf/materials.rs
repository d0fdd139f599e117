//! Materials, their textures, and what fills the shapes that they close.

use super::builder::{Builder, Folder, meet};
use base64::Engine;
use glam::Vec3;
use image::{ImageFormat, Rgba, RgbaImage};
use serde_json::{Value, json};
use std::io::Cursor;
use tyndall_core::{
    Coefficients, Geometry, Media, Medium, MediumId, PathFrom, Rgb, Shading, SurfaceKind,
};
use tyndall_scene_io::{Hit, Scene, SceneFile};

/// A square or a cube of one material.
fn scene_of(material: Value, closed: bool) -> Builder {
    let mut b = Builder::new();
    b.camera();
    let material = b.push("materials", material);
    let mesh = if closed {
        b.cube(Some(material))
    } else {
        b.square(Some(material))
    };
    b.node(json!({ "mesh": mesh }));
    b
}

fn add_texture(b: &mut Builder, image: RgbaImage) {
    let mut bytes = Vec::new();
    image
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .unwrap();
    let data = base64::engine::general_purpose::STANDARD.encode(bytes);
    let image = b.push(
        "images",
        json!({ "uri": format!("data:image/png;base64,{data}") }),
    );
    let sampler = b.push("samplers", json!({ "magFilter": 9728 }));
    b.push("textures", json!({ "source": image, "sampler": sampler }));
}

fn hit(scene: &Scene<Rgb>, x: f32, y: f32) -> Hit {
    meet(scene, [x, y, 5.0], [0.0, 0.0, -1.0]).unwrap().1
}

/// The medium behind the front of the cube.
fn inside(scene: &Scene<Rgb>) -> (MediumId, Option<Coefficients<Rgb>>) {
    let id = scene.medium_across(&hit(scene, 0.1, 0.1), Vec3::NEG_Z, MediumId::VACUUM);
    (id, scene.medium(id).and_then(|m| m.homogeneous()))
}

fn assert_close(found: Rgb, expected: [f32; 3]) {
    let apart = (found.0 - Vec3::from(expected)).abs().max_element();
    assert!(apart < 1e-5, "{found:?} {expected:?}");
}

#[test]
fn emission_is_its_factor_times_its_strength_on_one_side() {
    let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 8 } });
    let material = json!({ "emissiveFactor": [1, 0.5, 0], "extensions": strength });
    let scene = scene_of(material, false).scene();
    let hit = hit(&scene, 0.0, 0.1);
    assert_close(scene.emitted(&hit, Vec3::Z), [8.0, 4.0, 0.0]);
    assert_close(scene.emitted(&hit, Vec3::NEG_Z), [0.0; 3]);
}

/// The example of the extension: the lower left quarter of the image, turned clockwise by 90°.
#[test]
fn textures_are_turned_and_cut() {
    let transform = json!({ "offset": [0, 1], "rotation": std::f32::consts::FRAC_PI_2,
        "scale": [0.5, 0.5] });
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let material = json!({ "emissiveFactor": [1, 1, 1], "emissiveTexture": texture });
    let mut b = scene_of(material, false);
    let image = RgbaImage::from_fn(4, 4, |x, y| {
        let lit = |there: bool| if there { 255 } else { 0 };
        Rgba([
            lit((x, y) == (0, 3)),
            lit((x, y) == (0, 2)),
            lit((x, y) == (1, 2)),
            255,
        ])
    });
    add_texture(&mut b, image);
    let scene = b.scene();
    let at = |x, y| scene.emitted(&hit(&scene, x, y), Vec3::Z);
    // The corner at the bottom left of the image is at the top left of the square, and so on.
    assert_close(at(-0.4, 0.4), [1.0, 0.0, 0.0]);
    assert_close(at(0.4, 0.4), [0.0, 1.0, 0.0]);
    assert_close(at(0.4, -0.4), [0.0, 0.0, 1.0]);
    assert_close(at(-0.4, -0.4), [0.0; 3]);
}

/// Base colour is sRGB and multiplies its factor; roughness is green, metal blue.
#[test]
fn metal_reflects_in_its_base_color() {
    let pbr = json!({
        "baseColorFactor": [1, 0.5, 1, 1], "baseColorTexture": { "index": 0 },
        "metallicFactor": 1, "roughnessFactor": 1,
    });
    let mut b = scene_of(json!({ "pbrMetallicRoughness": pbr }), false);
    add_texture(
        &mut b,
        RgbaImage::from_pixel(1, 1, Rgba([188, 255, 0, 255])),
    );
    let scene = b.scene();
    let f = scene.bsdf_eval(&hit(&scene, 0.0, 0.1), Vec3::Z, Vec3::Z, PathFrom::Sensor);
    let srgb = ((188.0_f32 / 255.0 + 0.055) / 1.055).powf(2.4);
    assert!(f.0.z < 1e-2 * f.0.y && f.0.y > 0.05, "{f:?}");
    // Both channels nearly equal, srgb ≈ 0.503 against 0.5: what multiplies is the product.
    assert!((f.0.x / f.0.y - srgb / 0.5).abs() < 0.01, "{f:?}");
}

#[test]
fn normal_maps_tilt_by_their_scale() {
    let normal = |scale: f32| {
        let material = json!({ "normalTexture": { "index": 0, "scale": scale } });
        let mut b = scene_of(material, false);
        add_texture(
            &mut b,
            RgbaImage::from_pixel(1, 1, Rgba([191, 166, 217, 255])),
        );
        let scene = b.scene();
        scene.surface(&hit(&scene, 0.0, 0.1)).shading_normal
    };
    for scale in [0.0, 0.5, 1.0] {
        let n = [191.0_f32, 166.0, 217.0].map(|c| 2.0 * c / 255.0 - 1.0);
        let expected = Vec3::new(scale * n[0], scale * n[1], n[2]).normalize();
        assert!(
            (normal(scale) - expected).length() < 1e-3,
            "{scale}: {}",
            normal(scale)
        );
    }
}

#[test]
fn masks_cut_holes() {
    let pbr = json!({ "baseColorTexture": { "index": 0 } });
    let material = json!({ "pbrMetallicRoughness": pbr, "alphaMode": "MASK", "alphaCutoff": 0.25 });
    let mut b = scene_of(material, false);
    let image = RgbaImage::from_fn(2, 1, |x, _| Rgba([255, 255, 255, [63, 65][x as usize]]));
    add_texture(&mut b, image);
    let scene = b.scene();
    assert_eq!(
        scene.surface_kind(&hit(&scene, -0.3, 0.1)),
        SurfaceKind::Null
    );
    assert_eq!(
        scene.surface_kind(&hit(&scene, 0.3, 0.1)),
        SurfaceKind::Finite
    );
}

/// Smooth, frosted and thin glass; −ln(colour)/distance inside.
#[test]
fn glass_absorbs_what_its_attenuation_says() {
    let glass = |roughness: f32, thickness: f32| {
        let volume = json!({ "thicknessFactor": thickness, "attenuationDistance": 2,
            "attenuationColor": [0.5, 1, 0.25] });
        let extensions = json!({
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": volume, "KHR_materials_ior": { "ior": 1.33 },
        });
        let pbr = json!({ "metallicFactor": 0, "roughnessFactor": roughness });
        let material = json!({ "pbrMetallicRoughness": pbr, "extensions": extensions });
        let scene = scene_of(material, true).scene();
        let hit = hit(&scene, 0.1, 0.1);
        (scene.surface_kind(&hit), hit.eta, inside(&scene).1)
    };
    for (roughness, kind) in [(0.0, SurfaceKind::Delta), (0.5, SurfaceKind::Finite)] {
        let (found, eta, medium) = glass(roughness, 1.0);
        assert_eq!((found, eta), (kind, 1.33));
        let medium = medium.unwrap();
        assert_close(medium.sigma_a, [2_f32.ln() / 2.0, 0.0, 4_f32.ln() / 2.0]);
        assert_close(medium.sigma_s, [0.0; 3]);
        assert!(glass(roughness, 0.0).2.is_none());
    }
}

#[test]
fn extras_fill_shapes_with_what_scatters() {
    let extras = json!({ "tyndall": {
        "surface": "none", "sigma_s": [1, 2, 3], "sigma_a": 0.5, "emission": 0.25, "g": 0.7,
        "priority": 3,
    }, "other": [1, "two"] });
    let scene = scene_of(json!({ "extras": extras }), true).scene();
    assert_eq!(
        scene.surface_kind(&hit(&scene, 0.1, 0.1)),
        SurfaceKind::Null
    );
    let fog = inside(&scene).1.unwrap();
    assert_close(fog.sigma_s, [1.0, 2.0, 3.0]);
    assert_close(fog.sigma_a, [0.5; 3]);
    assert_close(fog.emission, [0.25; 3]);
}

/// The draft is read on request alone: σt is that of the attenuation, and what is scattered of it
/// gives the colour after many scatterings (Kulla & Conty 2017).
#[test]
fn drafts_scatter_on_request() {
    let extensions = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 1,
            "attenuationColor": [0.5, 0.5, 0.5] },
        "KHR_materials_volume_scatter": { "multiscatterColor": [0.0, 0.5, 1.0] },
    });
    let mut b = scene_of(json!({ "extensions": extensions }), true);
    b.json["extensionsUsed"] = json!(["KHR_materials_volume_scatter"]);
    let folder = Folder::new();
    let path = folder.write("wax.glb", b.glb());
    let load = |flag: &str| {
        let file = SceneFile::load(&path, &[("include.0.draft_extensions".into(), flag.into())]);
        let file = file.unwrap();
        (
            file.notices().to_vec(),
            inside(&file.build().unwrap()).1.unwrap(),
        )
    };
    let (notices, medium) = load("false");
    assert!(
        notices[0].contains("left out: KHR_materials_volume_scatter"),
        "{notices:?}"
    );
    assert_close(medium.sigma_s, [0.0; 3]);
    let (notices, medium) = load("true");
    assert!(notices.is_empty());
    let sigma_t = 2_f32.ln();
    assert!((medium.sigma_t().0 - Vec3::splat(sigma_t)).length() < 1e-6);
    let albedo = medium.sigma_s.0 / sigma_t;
    // 1 − (6.201435 − √(9.59217 + 20.8404 + 4.42815))² = 0.911.
    assert!(
        albedo.x < 0.01 && (albedo.y - 0.911).abs() < 2e-3 && albedo.z > 0.999,
        "{albedo}"
    );
}

/// One plain white material for primitives without any.
#[test]
fn primitives_without_material_are_there() {
    let mut b = Builder::new();
    b.camera();
    let square = b.square(None);
    b.node(json!({ "mesh": square }));
    let scene = b.scene();
    let f = scene.bsdf_eval(&hit(&scene, 0.0, 0.1), Vec3::Z, Vec3::Z, PathFrom::Sensor);
    assert!(f.0.min_element() > 0.0, "{f:?}");
}
