//! What textures do, seen through the traits of the host.
//!
//! False alarms of the statistical tests: 1e-6 each.

use crate::support::textured::*;
use glam::{Vec2, Vec3};
use image::{ImageBuffer, Rgba};
use tyndall_core::{
    Anchor, Geometry, LightDirect, LightEmission, Media, MediumId, PathFrom, Ray, Rgb, Sampler,
    Shading, SurfaceKind,
};
use tyndall_scene_io::Scene;
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, assert_mean};

const FALSE_ALARM: f64 = 1e-6;

fn write16(test: &str, name: &str, texel: [f32; 3]) {
    let [r, g, b] = texel.map(|c| (65535.0 * c).round() as u16);
    let image = ImageBuffer::from_pixel(2, 2, Rgba([r, g, b, u16::MAX]));
    image.save(path(test, name)).unwrap();
}

#[test]
fn images_stand_upright_on_quads() {
    write8("quads", "four.png", 2, &[RED, GREEN, BLUE, WHITE]);
    let texture =
        "kind = 'diffuse'\nreflectance = { file = 'four.png', filter = 'nearest', factor = 0.5 }";
    let scene: Scene<Rgb> = scene("quads", &square(texture));
    let at = |x, y| reflectance(&scene, &hit(&scene, x, y));
    assert!(close(at(0.2, 0.8), [0.5, 0.0, 0.0]));
    assert!(close(at(0.8, 0.8), [0.0, 0.5, 0.0]));
    assert!(close(at(0.2, 0.2), [0.0, 0.0, 0.5]));
    assert!(close(at(0.8, 0.2), [0.5, 0.5, 0.5]));
}

#[test]
fn coordinates_are_scaled_turned_and_moved() {
    write8("moved", "four.png", 2, &[RED, GREEN, BLUE, WHITE]);
    let texture = "kind = 'diffuse'\nreflectance = { file = 'four.png', filter = 'nearest', \
                   scale = [2, 1], rotation = 90, offset = [1, 0.5] }";
    let scene: Scene<Rgb> = scene("moved", &square(texture));
    // (u, v) = (0.1, 0.2) becomes (0.2, 0.2), then (−0.2, 0.2), then (0.8, 0.7): upper right.
    assert!(close(
        reflectance(&scene, &hit(&scene, 0.1, 0.2)),
        [0.0, 1.0, 0.0]
    ));
}

#[test]
fn spheres_are_globes_and_boxes_show_upright_faces() {
    write8("globe", "map.png", 4, &[RED, GREEN, BLUE, WHITE]);
    write8("globe", "four.png", 2, &[RED, GREEN, BLUE, WHITE]);
    let scene: Scene<Rgb> = scene(
        "globe",
        "
        [materials.map]
        kind = 'diffuse'
        reflectance = { file = 'map.png', filter = 'nearest' }
        [materials.four]
        kind = 'diffuse'
        reflectance = { file = 'four.png', filter = 'nearest' }
        [[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 1
        material = 'map'
        [[shapes]]
        kind = 'box'
        min = [9, -1, -1]
        max = [11, 1, 1]
        material = 'four'
        ",
    );
    let towards = |from: Vec3, direction: Vec3| {
        let ray = Ray::new(from, direction.normalize());
        let (_, hit) = scene.intersect(&ray, MediumId::VACUUM).expect("in the way");
        reflectance(&scene, &hit)
    };
    // Longitudes from −z over −x, z and x.
    let globe = |d: Vec3| towards(5.0 * d, -d);
    assert!(close(globe(Vec3::new(-1.0, 0.1, -1.0)), [1.0, 0.0, 0.0]));
    assert!(close(globe(Vec3::new(-1.0, 0.1, 1.0)), [0.0, 1.0, 0.0]));
    assert!(close(globe(Vec3::new(1.0, 0.1, 1.0)), [0.0, 0.0, 1.0]));
    assert!(close(globe(Vec3::new(1.0, 0.1, -1.0)), [1.0, 1.0, 1.0]));
    // The upper left of each side, as seen by someone who stands before it.
    let center = Vec3::new(10.0, 0.0, 0.0);
    for out in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let left = out.cross(Vec3::Y);
        let seen = towards(center + 3.0 * out + 0.5 * (left + Vec3::Y), -out);
        assert!(close(seen, [1.0, 0.0, 0.0]), "{out}: {seen:?}");
    }
}

#[test]
fn light_passes_a_leaf_where_it_is_cut() {
    write8("leaf", "leaf.png", 2, &[GONE, WHITE]);
    let leaf = "kind = 'diffuse'\nalpha_cutoff = 0.5\nemission = 2\n\
                reflectance = { file = 'leaf.png', filter = 'nearest' }";
    let scene: Scene<f32> = scene("leaf", &square(leaf));
    assert!(scene.has_null_surfaces());
    let (hole, there) = (hit(&scene, 0.2, 0.5), hit(&scene, 0.8, 0.5));
    assert_eq!(scene.surface_kind(&hole), SurfaceKind::Null);
    assert_eq!(scene.surface_kind(&there), SurfaceKind::Finite);
    let fog = MediumId(7);
    assert_eq!(scene.medium_across(&hole, Vec3::NEG_Z, fog), fog);
    assert_eq!(reflectance(&scene, &hole), 0.0);
    assert_eq!(scene.emitted(&hole, Vec3::Z), 0.0);
    assert_eq!(scene.emitted(&there, Vec3::Z), 2.0);
    let through = scene.bsdf_sample(&hole, Vec3::Z, [0.5; 3], PathFrom::Light);
    let through = through.expect("light passes");
    assert_eq!(
        (through.wi, through.weight, through.delta),
        (Vec3::NEG_Z, 1.0, true)
    );
}

/// A ball of fog, half of whose hull is cut away: who comes through the hole stays outside.
#[test]
fn holes_in_hulls_change_no_medium() {
    write8("hull", "hull.png", 2, &[GONE, WHITE]);
    let scene: Scene<f32> = scene(
        "hull",
        "
        [media.fog]
        kind = 'homogeneous'
        sigma_a = 1
        sigma_s = 1
        [materials.hull]
        kind = 'null'
        inside = 'fog'
        alpha = { file = 'hull.png', filter = 'nearest' }
        alpha_cutoff = 0.5
        [[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 1
        material = 'hull'
        ",
    );
    // The first half of the longitudes is that of −x.
    let enter = |from: Vec3| {
        let ray = Ray::new(from, -from.normalize());
        let (_, hit) = scene.intersect(&ray, MediumId::VACUUM).expect("in the way");
        scene.medium_across(&hit, ray.direction, MediumId::VACUUM)
    };
    assert_eq!(enter(Vec3::new(-3.0, 0.1, 0.2)), MediumId::VACUUM);
    assert_ne!(enter(Vec3::new(3.0, 0.1, 0.2)), MediumId::VACUUM);
}

/// Alpha without a cutoff: that share of the surface is there.
#[test]
fn alpha_is_the_share_that_is_there() {
    let scene: Scene<f32> = scene(
        "veil",
        &square("kind = 'diffuse'\nreflectance = 1\nalpha = 0.3"),
    );
    let mut sampler = rng(1);
    let there: Moments = (0..100_000)
        .map(|_| {
            let [x, y] = sampler.next();
            let hit = hit(&scene, x, y);
            f64::from(u8::from(scene.surface_kind(&hit) != SurfaceKind::Null))
        })
        .collect();
    assert_mean("share", there.estimate(), 0.3, FALSE_ALARM);
}

/// A lamp with bands of linear radiance 1, 0, 0.5 and 0.25 times 3.
fn lamp(test: &str) -> Scene<f32> {
    let grey = |x: u8| [x, x, x, 255];
    // 188 and 137 encode 0.5029 and 0.2502.
    write8(
        test,
        "bands.png",
        4,
        &[grey(255), grey(0), grey(188), grey(137)],
    );
    scene(
        test,
        &square(
            "kind = 'diffuse'\nreflectance = 0\n\
             emission = { file = 'bands.png', filter = 'nearest', factor = 3 }",
        ),
    )
}

const BANDS: [f64; 4] = [3.0, 0.0, 3.0 * 0.502_886_5, 3.0 * 0.250_158_3];

#[test]
fn a_textured_lamp_lights_as_its_texture_says() {
    let lamp = lamp("irradiance");
    let (from, normal) = (
        Vec3::new(0.1, 0.3, 0.6),
        Vec3::new(0.2, 0.1, -1.0).normalize(),
    );
    // ∫ L cos cos′/r² dA by the midpoint rule on 400² points, good to 1e-5.
    let n = 400;
    let mut expected = 0.0;
    for i in 0..n * n {
        let [x, y] = [i / n, i % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
        let to = Vec3::new(x as f32, y as f32, 0.0) - from;
        let (wi, r2) = (to.normalize(), f64::from(to.length_squared()));
        let cosines = f64::from(wi.dot(normal).max(0.0) * -wi.z);
        expected += BANDS[(4.0 * x) as usize] * cosines / r2 / f64::from(n * n);
    }
    let mut sampler = rng(2);
    let irradiance: Moments = (0..200_000)
        .map(|_| {
            let sample = lamp.sample_direct(from, sampler.next());
            sample.map_or(0.0, |s| f64::from(s.weight * s.wi.dot(normal).max(0.0)))
        })
        .collect();
    assert_mean("irradiance", irradiance.estimate(), expected, FALSE_ALARM);
}

#[test]
fn a_textured_lamp_emits_the_power_of_its_texture() {
    let lamp = lamp("power");
    let expected = std::f64::consts::PI * BANDS.iter().sum::<f64>() / 4.0;
    let mut sampler = rng(3);
    let flux: Moments = (0..100_000)
        .map(|_| {
            let sample = lamp.sample_emission(sampler.next());
            sample.map_or(0.0, |s| {
                if let Anchor::Surface(hit) = &s.source {
                    let radiance = lamp.emitted(hit, s.ray.direction);
                    // The flux of a sample is L cos/(pdf_a pdf_w).
                    let quotient = radiance * s.cos_theta / (s.pdf.pdf_a * s.pdf.pdf_w);
                    assert!((quotient / s.flux - 1.0).abs() < 1e-4);
                }
                f64::from(s.flux)
            })
        })
        .collect();
    assert_mean("power", flux.estimate(), expected, FALSE_ALARM);
}

/// A texel that the measurement of the lamp's mean radiance misses, among 8192 black ones.
#[test]
fn a_speck_of_light_is_not_lost() {
    let black = [0, 0, 0, 255];
    let texels: Vec<_> = (0..8192)
        .map(|i| if i == 0 { WHITE } else { black })
        .collect();
    write8("speck", "speck.png", 8192, &texels);
    let speck = "kind = 'diffuse'\nreflectance = 0\n\
                 emission = { file = 'speck.png', filter = 'nearest' }";
    let lamp: Scene<f32> = scene("speck", &square(speck));
    let mut sampler = rng(5);
    // All 100 000 miss it with a probability of 5e-6.
    let mut emitted = (0..100_000).filter_map(|_| lamp.sample_emission(sampler.next()));
    assert!(emitted.any(|s| s.flux > 0.0));
    write8("speck", "speck.png", 1, &[black]);
    let dark: Scene<f32> = scene("speck", &square(speck));
    assert!(dark.sample_emission(sampler.next()).is_none());
}

#[test]
fn normal_maps_bend_the_shading_normal() {
    let bent = |test: &str, texel, keys: &str| {
        write16(test, "normal.png", texel);
        let text = square(&format!(
            "kind = 'diffuse'\nreflectance = 1\nnormal_map = {{ file = 'normal.png'{keys} }}"
        ));
        let scene: Scene<f32> = scene(test, &text);
        let surface = scene.surface(&hit(&scene, 0.4, 0.6));
        assert_eq!(surface.geometric_normal, Vec3::Z);
        surface.shading_normal
    };
    // 16 bits resolve a component to 1/65535 either way.
    let near = |a: Vec3, b: Vec3| a.distance(b) < 4e-5;
    assert!(near(bent("flat", [0.5, 0.5, 1.0], ""), Vec3::Z));
    let right = Vec3::new(0.6, 0.0, 0.8);
    assert!(near(bent("right", [0.8, 0.5, 0.9], ""), right));
    let up = Vec3::new(0.0, 0.6, 0.8);
    assert!(near(bent("up", [0.5, 0.8, 0.9], ""), up));
    // Red is right in the image, which is turned by a quarter on the surface.
    let turned = bent("turned", [0.8, 0.5, 0.9], ", rotation = 90");
    assert!(near(turned, Vec3::new(0.0, -0.6, 0.8)), "{turned}");
    let weak = bent("weak", [0.8, 0.5, 0.9], ", strength = 0.5");
    assert!(near(weak, Vec3::new(0.3, 0.0, 0.8).normalize()));
    let behind = bent("behind", [0.8, 0.5, 0.1], "");
    assert!(behind.z > 0.0 && behind.is_normalized());
}

#[test]
fn grey_textures_keep_one_channel() {
    write8("grey", "grey.png", 1, &[[9, 9, 9, 255]]);
    write8("grey", "red.png", 1, &[RED]);
    let grey = |key: &str, file: &str| {
        let keys = match key {
            "reflectance" => String::new(),
            _ => "reflectance = 0.5\n".into(),
        };
        let text = format!("kind = 'diffuse'\n{keys}{key} = {{ file = '{file}' }}");
        load("grey", &square(&text)).unwrap().is_grey()
    };
    assert!(grey("reflectance", "grey.png") && grey("emission", "grey.png"));
    assert!(!grey("reflectance", "red.png") && !grey("emission", "red.png"));
    assert!(grey("normal_map", "red.png"));
}

#[test]
fn scalars_come_from_the_channel_that_is_named() {
    // Green 0: smooth; blue 1: metal.
    write8("packed", "packed.png", 1, &[[255, 0, 255, 255]]);
    let kind = |keys: &str| {
        let text = format!("kind = 'metallic_roughness'\nbase_color = 0.5\n{keys}");
        let scene: Scene<f32> = scene("packed", &square(&text));
        scene.surface_kind(&hit(&scene, 0.5, 0.5))
    };
    assert_eq!(
        kind("metallic_roughness = { file = 'packed.png' }"),
        SurfaceKind::Delta
    );
    let rough = "roughness = { file = 'packed.png', channel = 'red' }\nmetallic = 1";
    assert_eq!(kind(rough), SurfaceKind::Finite);
    let smooth = "roughness = { file = 'packed.png', channel = 'green' }\nmetallic = 1";
    assert_eq!(kind(smooth), SurfaceKind::Delta);
}

#[test]
fn textures_that_are_none_are_named() {
    let why = |keys: &str| load("none", &square(&format!("kind = 'diffuse'\n{keys}"))).unwrap_err();
    let missing = why("reflectance = { file = 'none.png' }");
    assert!(missing.contains("materials.it.reflectance.file") && missing.contains("none.png"));
    std::fs::write(path("none", "text.png"), "no image").unwrap();
    let text = why("reflectance = { file = 'text.png' }");
    assert!(text.contains("neither a PNG nor a JPEG"), "{text}");
    // A PNG header that claims 30000² texels, and nothing after it.
    let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    header.extend([
        0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30, 8, 6, 0, 0, 0, 0xd1, 0x1f, 0x2c, 0x60,
    ]);
    std::fs::write(path("none", "bomb.png"), header).unwrap();
    let bomb = why("reflectance = { file = 'bomb.png' }");
    assert!(bomb.contains("bomb.png"), "{bomb}");
    let colour = why("reflectance = { file = 'text.png', factor = 2 }");
    assert!(colour.contains("between 0 and 1"), "{colour}");
    let alpha = why("reflectance = 0.5\nalpha_cutoff = 0.5");
    assert!(alpha.contains("needs `alpha`"), "{alpha}");
    let unknown = why("reflectance = { fiel = 'text.png' }");
    assert!(unknown.contains("did you mean `file`"), "{unknown}");
}

#[test]
fn emission_is_seen_where_it_is() {
    let lamp = lamp("seen");
    for (i, band) in BANDS.iter().enumerate() {
        let uv = Vec2::new((i as f32 + 0.5) / 4.0, 0.5);
        let emitted = lamp.emitted(&hit(&lamp, uv.x, uv.y), Vec3::Z);
        assert!((f64::from(emitted) - band).abs() < 1e-5, "{i}: {emitted}");
    }
}
