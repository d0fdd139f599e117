//! Walks and connections on analytic hosts. False alarms: 1e-3 a test, fixed seeds.

use glam::Vec3;
use std::path::Path;
use tyndall_core::{
    Anchor, Coefficients, LightDirect, LightEmission, MediumId, Ray, Rgb, Sampler, Sensor,
    SensorRay, Spectrum,
};
use tyndall_media::{Homogeneous, Phase};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Light, View};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, check_means};
use tyndall_walk::{Connection, Event, Site, Walk};

fn fog(sigma_a: Rgb, sigma_s: Rgb, g: f32) -> Homogeneous<Rgb> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    };
    let phase = Phase::henyey_greenstein(g).expect("a valid mean cosine");
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}

#[test]
fn light_is_neither_lost_nor_made() {
    // What is absorbed at collisions, (1 − albedo) of what arrives, adds up to what was emitted.
    let sigma_a = Rgb::new(0.5, 1.0, 0.02);
    let sigma_s = Rgb::new(2.0, 0.3, 1.5);
    let power = Rgb::new(3.0, 1.0, 0.5);
    let host = AnalyticHost::infinite_medium(
        fog(sigma_a, sigma_s, 0.6),
        Vec3::new(1.0, 2.0, 3.0),
        power,
        View::Rays(vec![]),
    );
    let mut sampler = rng(7);
    let mut absorbed = [Moments::new(), Moments::new(), Moments::new()];
    for _ in 0..40_000 {
        let emission = host.sample_emission(sampler.next()).expect("a light");
        let mut walk = Walk::from_light(&host, &emission);
        let mut sum = Rgb::default();
        loop {
            let segment = walk.segment();
            let Event::Scattering(vertex) = walk.fly(segment, &mut sampler) else {
                panic!("nothing leaves an infinite medium");
            };
            let Site::Collision(c) = &vertex.site else {
                panic!("there are no surfaces");
            };
            sum += walk.throughput * (Rgb::splat(1.0) - c.albedo());
            if walk.scatter(&vertex, &mut sampler).is_none() {
                break;
            }
        }
        for (channel, moments) in absorbed.iter_mut().enumerate() {
            moments.push(f64::from(sum.channel(channel)));
        }
    }
    let cases: Vec<_> = absorbed
        .iter()
        .enumerate()
        .map(|(i, m)| ("absorbed power", m.estimate(), f64::from(power.channel(i))))
        .collect();
    check_means(&cases, 1e-3).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn null_surfaces_are_no_bounces() {
    let vacuum = fog(Rgb::default(), Rgb::default(), 0.0);
    let host = AnalyticHost::furnace(vacuum, 1.0, Interface::Matched, View::Rays(vec![]));
    let start = Ray::new(Vec3::new(0.3, 0.0, -5.0), Vec3::Z);
    let mut walk = Walk::from_sensor(&host, &SensorRay::new(start, MediumId::VACUUM));
    let mut sampler = rng(1);
    for expected in ["into the sphere", "out of it"] {
        let segment = walk.segment();
        let event = walk.fly(segment, &mut sampler);
        assert!(matches!(event, Event::Interface(_)), "{expected}");
    }
    let segment = walk.segment();
    assert_eq!(segment.medium, MediumId::VACUUM);
    assert!(matches!(
        walk.fly(segment, &mut sampler),
        Event::Escape(Vec3::Z)
    ));
    assert_eq!((walk.depth, walk.throughput), (0, Rgb::splat(1.0)));
}

#[test]
fn a_connection_is_attenuated_by_what_it_crosses() {
    let sigma_t = Rgb::new(0.3, 1.0, 2.5);
    let medium = fog(sigma_t * 0.5, sigma_t * 0.5, 0.3);
    let thickness = 1.7;
    let host = AnalyticHost::slab(medium, thickness, 10.0, 1.0, Exitant::Reflectance);
    let direction = Vec3::new(0.6, 0.0, 0.8);
    let below = Anchor::Point(Vec3::new(0.0, 0.0, -1.0));
    let mut sampler = rng(1);
    for (to, length) in [
        (Anchor::Direction(direction), thickness / 0.8),
        (Anchor::Point(Vec3::new(0.0, 0.0, 0.9)), 0.9),
        (Anchor::Point(Vec3::new(0.0, 0.0, 9.0)), thickness),
    ] {
        let share = Connection::new(&host, &below, &to, MediumId::VACUUM)
            .transmittance(&host, &mut sampler);
        for channel in 0..3 {
            let expected = (-sigma_t.channel(channel) * length).exp();
            let difference = (share.channel(channel) - expected).abs();
            // Rounding of coordinates near 10, in f32, times σt.
            assert!(difference < 1e-5 * expected, "{share:?} against {expected}");
        }
    }
}

#[test]
fn a_connection_ends_at_a_surface() {
    let glass = fog(Rgb::splat(0.1), Rgb::splat(0.1), 0.0);
    let host = AnalyticHost::sphere(
        glass,
        1.0,
        Interface::Dielectric(1.5),
        Light::None,
        View::Rays(vec![]),
    );
    let ends = [Anchor::Point(Vec3::X * -3.0), Anchor::Point(Vec3::X * 3.0)];
    let behind = Connection::new(&host, &ends[0], &ends[1], MediumId::VACUUM);
    assert!(behind.transmittance(&host, &mut rng(1)).is_black());
    let beside = Anchor::Point(Vec3::new(-3.0, 5.0, 0.0));
    let free = Connection::new(&host, &ends[0], &beside, MediumId::VACUUM);
    assert_eq!(free.transmittance(&host, &mut rng(1)), Rgb::splat(1.0));
}

/// Rays leave a null surface beside the line, by more the larger it is, and must not end behind the
/// lamp: seen from aslant, all of one that hangs just above a box of fog shines into it.
#[test]
fn connections_end_before_what_they_connect() {
    let text = r#"
        camera = { position = [0, 1, 6], look_at = [0, 1, 0], fov = 40, medium = "fog" }
        film = { width = 4, height = 4 }
        media.fog = { kind = "homogeneous", sigma_a = 0, sigma_s = 1e-3 }
        materials.lamp = { kind = "diffuse", reflectance = 0 }
        materials.boundary = { kind = "null", inside = "fog" }
        shapes = [
            { kind = "box", min = [-25, -1, -25], max = [25, 2.39, 25], material = "boundary" },
            { kind = "disk", center = [0, 2.7, 0], normal = [0, -1, 0], radius = 0.8,
              material = "lamp", emission = 1 },
        ]"#;
    let file = SceneFile::parse(text, Path::new("lamp"), &[]);
    let host: Scene<Rgb> = file.and_then(|file| file.build()).expect("a scene");
    let (mut sampler, mut connected) = (rng(1), 0);
    let fog = host.sensor_ray([0, 0], sampler.next()).medium;
    for _ in 0..10_000 {
        let [x, y, z] = sampler.next();
        let p = Vec3::new(48.0 * x - 24.0, 3.3 * y - 0.95, 48.0 * z - 24.0);
        let Some(light) = host.sample_direct(p, sampler.next()) else {
            continue;
        };
        let connection = Connection::new(&host, &Anchor::Point(p), &light.target, fog);
        let shines = connection.transmittance(&host, &mut sampler);
        assert!(shines.channel(0) > 0.9, "{p}: {shines:?}");
        connected += 1;
    }
    assert!(connected > 9_000, "{connected}");
}
