//! Image environments: where their pixels are, what is sampled, how much light they send.
//!
//! False alarms: 1e-6 a statistical test, fixed seeds.

use crate::support::sky::Sky;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::path::Path;
use tyndall_core::{
    Anchor, Geometry, LightDirect, LightEmission, LightKind, LightPdf, Rgb, Sampler, Shading,
    Spectrum,
};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, check_mean, chi2_sphere};

const FALSE_ALARM: f64 = 1e-6;

fn file(environment: &str) -> Result<SceneFile, tyndall_scene_io::Error> {
    let text = format!(
        "
        [film]
        width = 8
        height = 8
        [camera]
        position = [0, 0, 5]
        look_at = [0, 0, 0]
        fov = 60
        [environment]
        {environment}"
    );
    SceneFile::parse(&text, Path::new("sky.toml"), &[])
}

fn scene<S: Spectrum>(sky: &Sky, more: &str) -> Scene<S> {
    let environment = format!("file = '{}'\n{more}", sky.path());
    let file = file(&environment).and_then(|f| f.build());
    file.unwrap_or_else(|e| panic!("{e}"))
}

/// The direction of a point of the image, `u` and `v` from 0 to 1, as OpenEXR defines it.
fn direction(u: f32, v: f32) -> Vec3 {
    let (longitude, latitude) = (PI - TAU * u, 0.5 * PI - PI * v);
    let (x, z) = longitude.sin_cos();
    let (y, across) = latitude.sin_cos();
    Vec3::new(x * across, y, z * across)
}

/// A pixel that no other resembles.
fn numbered(x: usize, y: usize) -> Rgb {
    Rgb::new(x as f32, y as f32, 0.25 * ((x * y) % 7) as f32)
}

/// Noise of a large contrast.
fn noise(x: usize, y: usize) -> Rgb {
    let hash = |k: usize| ((x * 7919 + y * 104_729 + k * 31) % 97) as f32 / 97.0;
    Rgb::new(hash(1).powi(8), hash(2), 3.0 * hash(3))
}

#[test]
fn pixels_are_where_openexr_puts_them() {
    let sky = Sky::exr(8, 4, numbered);
    let scene = scene::<Rgb>(&sky, "scale = [1, 2, 4]");
    for (x, y) in (0..8).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let w = direction((x as f32 + 0.5) / 8.0, (y as f32 + 0.5) / 4.0);
        let expected = numbered(x, y) * Rgb::new(1.0, 2.0, 4.0);
        let off = (scene.background(w) - expected).map(f32::abs).max_channel();
        assert!(off < 1e-4, "{x}, {y}: {:?}", scene.background(w));
    }
    // Between centres it is linear, around the seam too; beyond the first row it is constant.
    let middle = scene.background(direction(0.0, 0.125));
    assert!((middle.channel(0) - 3.5).abs() < 1e-4);
    let above = scene.background(direction(0.0, 0.02));
    assert!((above - middle).map(f32::abs).max_channel() < 1e-4);
    assert!(scene.background(Vec3::Y).is_finite() && scene.background(Vec3::NEG_Y).is_finite());
}

#[test]
fn skies_turn() {
    // One column is red, the uppermost row is green.
    let sky = Sky::exr(64, 32, |x, y| {
        let inside = |b: bool| if b { 1.0 } else { 0.0 };
        Rgb::new(inside(x.div_ceil(2) == 16), inside(y == 0), 0.1)
    });
    // The middle of the image, which is at +z.
    let reddest = |turned: &str| {
        let scene = scene::<Rgb>(&sky, turned);
        let around = (0..4096).map(|i| {
            let (s, c) = (i as f32 / 4096.0 * TAU).sin_cos();
            let [a, b] = match turned.contains("up = [0, 0, 1]") {
                true => [Vec3::X, Vec3::Y],
                false => [Vec3::X, Vec3::Z],
            };
            a * c + b * s
        });
        around.max_by(|a, b| {
            let red = |w: &Vec3| scene.background(*w).channel(0);
            red(a).total_cmp(&red(b))
        })
    };
    let near = |w: Option<Vec3>, to: Vec3| w.unwrap().distance(to) < 0.11;
    assert!(near(reddest(""), Vec3::Z));
    assert!(near(reddest("rotate = 90"), Vec3::X));
    assert!(near(reddest("rotate = -90"), Vec3::NEG_X));
    assert!(near(reddest("up = [0, 0, 1]"), Vec3::NEG_Y));
    assert!(near(reddest("up = [0, 0, 1]\nrotate = 90"), Vec3::X));
    assert!(near(reddest("up = [0, -1, 0]"), Vec3::Z));
    for (up, w) in [
        ("[0, 0, 1]", Vec3::Z),
        ("[0, -1, 0]", Vec3::NEG_Y),
        ("[3, 0, 0]", Vec3::X),
    ] {
        let scene = scene::<Rgb>(&sky, &format!("up = {up}\nrotate = 33"));
        assert_eq!(scene.background(w).channel(1), 1.0, "{up}");
        assert_eq!(scene.background(-w).channel(1), 0.0, "{up}");
    }
}

/// Directions of direct light and of emission follow their density.
fn check_sampling(scene: &Scene<Rgb>) {
    let from = Vec3::new(0.3, 0.2, 0.1);
    let pdf_w = |w| scene.pdf_direct_w(from, &Anchor::Direction(w));
    let mut sampler = rng(1);
    let direct = |_| scene.sample_direct(from, sampler.next()).map(|s| s.wi);
    chi2_sphere(direct, pdf_w, 200_000, FALSE_ALARM).unwrap();
    let mut sampler = rng(2);
    let emitted = |_| {
        let sample = scene.sample_emission(sampler.next())?;
        Some(-sample.ray.direction)
    };
    chi2_sphere(emitted, pdf_w, 200_000, FALSE_ALARM).unwrap();
}

#[test]
fn directions_follow_the_image() {
    let turned = "up = [1, 2, 3]\nrotate = 77";
    check_sampling(&scene(&Sky::exr(16, 8, noise), ""));
    check_sampling(&scene(&Sky::exr(40, 20, noise), turned));
    check_sampling(&scene(
        &Sky::exr(1, 1, |_, _| Rgb::new(1.0, 2.0, 3.0)),
        turned,
    ));
    check_sampling(&scene(&Sky::exr(2, 1, |x, _| Rgb::splat(x as f32)), ""));
    check_sampling(&scene(&Sky::exr(1, 5, |_, y| Rgb::splat(y as f32)), turned));
    check_sampling(&scene(&Sky::hdr(17, 9, noise), ""));
}

#[test]
fn bright_pixels_are_found_and_black_ones_are_not() {
    // At the pole, at the seam, in the middle; among darkness or dusk.
    for (sun_x, sun_y) in [(0, 0), (31, 15), (31, 8), (12, 5)] {
        for dusk in [0.0, 1e-5] {
            let sky = Sky::exr(32, 16, |x, y| match (x, y) == (sun_x, sun_y) {
                true => Rgb::splat(1e4),
                false => Rgb::splat(dusk),
            });
            check_sampling(&scene(&sky, "up = [1, 2, 3]"));
        }
    }
}

/// A large image, whose pixels are far less probable than the steps of an `f32`.
#[test]
fn dim_pixels_of_large_images_are_found_as_often_as_is_stated() {
    let sky = Sky::exr(4096, 2048, |x, y| match (x, y) {
        (1000, 700) => Rgb::splat(1e8),
        _ => Rgb::splat(1.0),
    });
    let scene = scene::<Rgb>(&sky, "");
    let mut sampler = rng(3);
    // 1/pdf over samples off the sun: the solid angle of what is not the sun.
    let angle: Moments = (0..400_000)
        .map(|_| {
            let sample = scene.sample_direct(Vec3::ZERO, sampler.next()).unwrap();
            let is_sun = sample.weight.channel(0) * sample.pdf_w > 2.0;
            let angle = 1.0 / f64::from(sample.pdf_w);
            if is_sun { 0.0 } else { angle }
        })
        .collect();
    let estimate = angle.estimate();
    assert!(estimate.standard_error < 0.15, "{estimate:?}");
    // The sun lights four pixels, 1e-5 of the sphere.
    let whole = 4.0 * std::f64::consts::PI;
    check_mean("solid angle", estimate, whole, FALSE_ALARM).unwrap();
    // The fourth number tells apart what three of 24 digits cannot.
    let direct = |u| {
        scene
            .sample_direct(Vec3::ZERO, [0.5, 0.999, 0.7, u])
            .unwrap()
            .wi
    };
    let mut found: Vec<_> = (0..1000)
        .map(|i| direct(i as f32 / 1000.0).to_array())
        .collect();
    found.sort_by(|a, b| a.partial_cmp(b).unwrap());
    found.dedup();
    assert!(found.len() > 10, "{}", found.len());
}

#[test]
fn a_black_sky_sends_nothing() {
    let scene = scene::<Rgb>(&Sky::exr(4, 2, |_, _| Rgb::default()), "");
    let mut sampler = rng(4);
    for _ in 0..100 {
        assert!(scene.sample_direct(Vec3::ZERO, sampler.next()).is_none());
        assert!(scene.sample_emission(sampler.next()).is_none());
    }
    assert_eq!(scene.background(Vec3::X), Rgb::default());
    assert_eq!(
        scene.pdf_direct_w(Vec3::ZERO, &Anchor::Direction(Vec3::X)),
        0.0
    );
}

/// Irradiance of a plane that faces up, by direct light.
fn irradiance(scene: &Scene<f32>) -> Moments {
    let mut sampler = rng(5);
    (0..200_000)
        .map(|_| {
            let sample = scene.sample_direct(Vec3::ZERO, sampler.next());
            sample.map_or(0.0, |s| f64::from(s.weight * s.wi.y.max(0.0)))
        })
        .collect()
}

/// Fluence: emitted power over the area that the world shows to parallel light.
fn fluence(scene: &Scene<f32>) -> Moments {
    let mut sampler = rng(6);
    (0..200_000)
        .map(|_| {
            let sample = scene.sample_emission(sampler.next());
            sample.map_or(0.0, |s| f64::from(s.flux * s.pdf.pdf_a))
        })
        .collect()
}

#[test]
fn skies_send_their_light() {
    const ROWS: usize = 256;
    let pi = std::f64::consts::PI;
    let theta = |y: usize| (y as f32 + 0.5) / ROWS as f32 * PI;
    // cos θ above the horizon: fluence π, irradiance 2π/3.
    let lobe = Sky::exr(4, ROWS, |_, y| Rgb::splat(theta(y).cos().max(0.0)));
    // 1 above the horizon: 2π and π.
    let step = Sky::exr(2, ROWS, |_, y| {
        Rgb::splat(if y < ROWS / 2 { 1.0 } else { 0.0 })
    });
    for (sky, fluence_of, irradiance_of) in [(lobe, pi, 2.0 * pi / 3.0), (step, 2.0 * pi, pi)] {
        let scene = scene::<f32>(&sky, "");
        // Linear interpolation is off by at most h²/8 times the curvature, and over one row at
        // the horizon by 1 at most, half of it either way.
        let h = pi / ROWS as f64;
        let bias = 4.0 * pi * h * h;
        let near = |name: &str, moments: Moments, exact: f64| {
            let estimate = moments.estimate();
            let nearest = estimate.mean.clamp(exact - bias, exact + bias);
            assert!(estimate.standard_error < 0.01);
            check_mean(name, estimate, nearest, FALSE_ALARM).unwrap();
        };
        near("irradiance", irradiance(&scene), irradiance_of);
        near("fluence", fluence(&scene), fluence_of);
    }
}

#[test]
fn skies_are_chosen_by_their_power() {
    // cos θ above the horizon: fluence π. A sun of twice that, which comes first.
    let lobe = Sky::exr(3, 200, |_, y| {
        Rgb::splat(((y as f32 + 0.5) / 200.0 * PI).cos().max(0.0))
    });
    let sun = "[[lights]]\nkind = 'directional'\ndirection = [0, -1, 0]\nirradiance = 6.2831853";
    let scene = scene::<f32>(&lobe, sun);
    let kind = |u| {
        let sample = scene.sample_emission([u, 0.5, 0.5, 0.5, 0.5, 0.5]);
        sample.unwrap().kind
    };
    assert_eq!(kind(2.0 / 3.0 - 1e-4), LightKind::Parallel);
    assert_eq!(kind(2.0 / 3.0 + 1e-4), LightKind::Background);
}

#[test]
fn an_image_of_one_colour_is_a_constant_sky() {
    let image = scene::<Rgb>(
        &Sky::exr(7, 3, |_, _| Rgb::new(1.0, 2.0, 3.0)),
        "scale = 0.5",
    );
    let constant = file("radiance = [0.5, 1, 1.5]").and_then(|f| f.build::<Rgb>());
    let constant = constant.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(image.bounds(), constant.bounds());
    let mut sampler = rng(7);
    let mut power = Moments::new();
    for _ in 0..100_000 {
        let sample = image.sample_emission(sampler.next()).unwrap();
        let w = -sample.ray.direction;
        let off = image.background(w) - constant.background(w);
        assert!(off.map(f32::abs).max_channel() < 1e-5);
        power.push(sample.flux.mean().into());
    }
    let flux = constant.sample_emission([0.5; 6]).unwrap().flux.mean();
    check_mean("power", power.estimate(), flux.into(), FALSE_ALARM).unwrap();
}

#[test]
fn grey_skies_have_one_channel() {
    let is_grey = |sky: &Sky, more: &str| {
        file(&format!("file = '{}'\n{more}", sky.path()))
            .unwrap()
            .is_grey()
    };
    let grey = Sky::exr(4, 2, |x, y| Rgb::splat((x + y) as f32));
    assert!(is_grey(&grey, "") && is_grey(&grey, "scale = 3"));
    assert!(!is_grey(&grey, "scale = [1, 2, 3]"));
    assert!(!is_grey(&Sky::exr(4, 2, numbered), ""));
    assert!(is_grey(&Sky::luminance(4, 2, |x, y| (x * y) as f32), ""));
}

#[test]
fn bad_images_are_said_to_be_so() {
    let message = |sky: &Sky, more: &str| {
        let environment = format!("file = '{}'\n{more}", sky.path());
        match file(&environment) {
            Ok(_) => String::new(),
            Err(error) => error.to_string(),
        }
    };
    let with = |value: f32| {
        Sky::exr(8, 4, move |x, y| match (x, y) {
            (5, 2) | (6, 3) => Rgb::new(1.0, value, 1.0),
            _ => Rgb::splat(1.0),
        })
    };
    for (value, words) in [
        (f32::NAN, "green is NaN at column 5, row 2"),
        (f32::INFINITY, "green is inf at column 5, row 2"),
        (-1e-9, "green is -0.000000001 at column 5, row 2"),
    ] {
        let message = message(&with(value), "");
        assert!(message.contains(words), "{message}");
        assert!(
            message.contains("environment.file") && message.contains("clamp"),
            "{message}"
        );
    }
    let overflow = message(&with(1e30), "scale = 1e10");
    assert!(overflow.contains("lower `scale`"), "{overflow}");
    let whole = std::fs::read(with(1.0).path()).unwrap();
    for (bytes, words) in [
        (&b"PNG"[..], "convert it"),
        (b"", "convert it"),
        (&whole[..whole.len() - 20], "cannot be read as OpenEXR"),
        (&whole[..60], "cannot be read as OpenEXR"),
        (b"#?RADIANCE\n\n-Y 60000 +X 60000\n", "scale it down"),
        (b"#?RADIANCE\n\n-Y 6000 +X 6000\n", "cut off"),
        (b"#?RADIANCE\n\n-Y 0 +X 8\n", "no pixels"),
        (
            b"#?RADIANCE\n\n-Y 2 +X 8\nabc",
            "cannot be read as Radiance HDR",
        ),
        (
            b"#?RADIANCE\nFORMAT=nonsense\n",
            "cannot be read as Radiance HDR",
        ),
    ] {
        let message = message(&Sky::bytes(bytes), "");
        assert!(message.contains(words), "{words}: {message}");
    }
    let both = message(&with(1.0), "radiance = 1");
    assert!(both.contains("exclude each other"), "{both}");
    assert!(
        file("file = 'none.exr'")
            .unwrap_err()
            .to_string()
            .contains("none.exr: cannot be read")
    );
    assert!(message(&with(1.0), "up = [0, 0, 0]").contains("environment.up"));
    assert!(
        file("radiance = 1\nrotate = 3")
            .unwrap_err()
            .to_string()
            .contains("environment.rotate")
    );
}
