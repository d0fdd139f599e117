//! Where numbers run out: every sample is finite ([`Run`] asserts it), and where light is known it
//! is right.

use crate::{FALSE_ALARM, fixed, fog};
use glam::Vec3;
use std::sync::atomic::AtomicBool;
use tyndall_beam_radiance::{BeamRadiance, Blur, Transmittance};
use tyndall_core::{Integrator, PassContext, PassError, Ray, Rgb, Sensor, SensorRay, Spectrum};
use tyndall_driver::PassStreams;
use tyndall_media::Homogeneous;
use tyndall_testkit::Run;
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, Boundary, Interface, Light, View};
use tyndall_testkit::stats::Figures;

type Host = AnalyticHost<Homogeneous<Rgb>>;

fn chords(scale: f32) -> View {
    let ray = |x: f32, z: f32| Ray::new(Vec3::new(x, 0.0, z) * scale, Vec3::Z);
    // Through the middle, from it, and one that only just touches the ball.
    View::Rays(vec![ray(0.0, -2.0), ray(0.1, 0.0), ray(0.999_99, -2.0)])
}

#[test]
fn furnaces_from_empty_to_opaque() {
    for sigma in [0.0, 1e-12, 1e-6, 1.0, 100.0, 1e6] {
        for albedo in [0.0, 0.5, 1.0] {
            if albedo == 1.0 && sigma > 100.0 {
                continue; // walks end after a million scatterings
            }
            for scale in [1e-8, 1.0, 1e8] {
                for blur in [Blur::Disc, Blur::Ball] {
                    let sigma_t = Rgb::new(1.0, 0.1, 0.0) * (sigma / scale);
                    let medium = fog(sigma_t * (1.0 - albedo), sigma_t * albedo, 0.0);
                    let view = chords(scale);
                    let host = AnalyticHost::furnace(medium, scale, Interface::Matched, view);
                    let method = BeamRadiance::new().paths(50).starting_paths(50).blur(blur);
                    let run = Run {
                        passes: 2,
                        samples: 1,
                        seed: 1,
                    };
                    let mean = run.measure(&host, &method);
                    let name = format!("σt {sigma} albedo {albedo} scale {scale} {blur:?}");
                    // The last channel is empty; no more than noise is brighter than the sky.
                    assert_eq!(mean[2].mean, 1.0, "{name}");
                    assert!(
                        mean.iter().all(|e| (0.0..3.0).contains(&e.mean)),
                        "{name}: {mean:?}"
                    );
                }
            }
        }
    }
}

/// The mean of the first pixel, of one pass.
fn radiance(host: &Host, method: &BeamRadiance, ray: Ray) -> Rgb {
    radiance_of(host, method, ray, 1)
}

fn radiance_of(host: &Host, method: &BeamRadiance, ray: Ray, seed: u64) -> Rgb {
    let (streams, running) = (PassStreams::new(seed, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    let pass = method.begin_pass(host, &cx, None).expect("a pass");
    let medium = host.sensor_ray([0, 0], [0.5; 4]).medium;
    let ray = SensorRay::new(ray, medium);
    method.estimate(host, &pass, &mut (), &ray, &mut tyndall_testkit::rng(1))
}

fn lit(radius: f32) -> Host {
    let medium = fog(Rgb::splat(0.5), Rgb::splat(2.0), 0.0);
    AnalyticHost {
        boundary: Boundary::Nowhere,
        medium,
        light: Light::Beam {
            center: Vec3::ZERO,
            direction: Vec3::X,
            radius,
            irradiance: Rgb::splat(1.0),
        },
        view: View::Rays(vec![Ray::new(Vec3::new(-1.0, 0.0, -3.0), Vec3::Z)]),
    }
}

#[test]
fn no_photon_one_photon_and_more_than_there_are() {
    let beside = Ray::new(Vec3::new(0.4, 0.0, -1.0), Vec3::Z);
    let mut dark = lit(0.1);
    dark.light = Light::None;
    assert_eq!(
        radiance(&dark, &BeamRadiance::new().paths(100), beside),
        Rgb::default()
    );
    // A path through little fog: a photon alone has no radius, unless one is given.
    let light = Light::Point {
        position: Vec3::ZERO,
        power: Rgb::splat(1.0),
    };
    let thin = fog(Rgb::splat(0.1), Rgb::splat(0.3), 0.0);
    let view = View::Rays(vec![beside]);
    let one = AnalyticHost::sphere(thin, 1.5, Interface::Matched, light, view);
    let few = BeamRadiance::new().paths(1).starting_paths(1);
    let alone = |seed: &u64| {
        let (streams, running) = (PassStreams::new(*seed, 0), AtomicBool::new(false));
        let pass =
            few.max_radius(1e3)
                .begin_pass(&one, &PassContext::new(0, &streams, &running), None);
        pass.expect("a pass").photons() == [1, 0]
    };
    let seed = (0..100).find(alone).expect("a path of one collision");
    let no_cap = few.max_radius(f32::INFINITY);
    assert_eq!(radiance_of(&one, &no_cap, beside, seed), Rgb::default());
    for blur in [Blur::Disc, Blur::Ball] {
        let given = few.max_radius(1e3).blur(blur);
        assert!(radiance_of(&one, &given, beside, seed).channel(0) > 0.0);
        let many = BeamRadiance::new()
            .paths(50)
            .starting_paths(50)
            .nearest(1_000_000)
            .blur(blur);
        assert!(radiance(&lit(0.1), &many, beside).channel(0) > 0.0);
    }
}

#[test]
fn photons_in_one_place() {
    // A beam too thin for f32 in a medium that stops it at once.
    let mut host = lit(1e-30);
    host.light = Light::Beam {
        center: Vec3::X,
        direction: Vec3::X,
        radius: 1e-30,
        irradiance: Rgb::splat(1e30),
    };
    host.medium = fog(Rgb::default(), Rgb::splat(1e30), 0.0);
    let ray = Ray::new(Vec3::new(1.0, 0.0, -1.0), Vec3::Z);
    for blur in [Blur::Disc, Blur::Ball] {
        let method = BeamRadiance::new().paths(20).blur(blur);
        assert!(radiance(&host, &method, ray).is_finite());
        assert!(radiance(&host, &method.radius(1e-12).alpha(1.0), ray).is_finite());
        assert!(radiance(&host, &method.radius(1e12), ray).is_finite());
    }
}

#[test]
fn photons_behind_the_eye_and_beyond_the_end_are_not_seen() {
    let sigma_t = 0.6_f32;
    let rarely = 1e-4;
    let medium = fog(sigma_t * (1.0 - rarely), sigma_t * rarely, 0.0);
    let mut figures = Figures::default();
    // From beside the light on, and from behind it.
    for start in [0.5, 1.5] {
        let ray = Ray::new(Vec3::new(start, 0.0, 0.0), Vec3::X);
        let light = Vec3::new(0.5, 1.0, 0.0);
        let view = View::Rays(vec![ray]);
        let host = AnalyticHost::infinite_medium(medium.clone(), light, 1.0, view);
        let expected = airlight(
            f64::from(sigma_t * rarely),
            f64::from(sigma_t),
            1.0,
            f64::from(0.5 - start),
            f64::INFINITY,
        );
        for blur in [Blur::Disc, Blur::Ball] {
            let run = Run {
                passes: 50,
                samples: 1,
                seed: 1,
            };
            let mean = run.measure(&host, &fixed(0.35).blur(blur).paths(6_000))[0];
            figures.add(format!("from {start}, {blur:?}"), mean, expected, 0.05);
        }
    }
    figures.check(FALSE_ALARM);
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let host = lit(0.1);
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    let new = BeamRadiance::new;
    for (named, method) in [
        ("`paths`", new().paths(0)),
        ("`starting_paths`", new().starting_paths(0)),
        ("`nearest`", new().nearest(1)),
        ("`max_radius`", new().max_radius(0.0)),
        ("`radius`", new().radius(0.0)),
        ("`surface_nearest`", new().surface_nearest(0)),
        ("`surface_radius`", new().surface_radius(-1.0)),
        ("`surface_max_radius`", new().surface_max_radius(-1.0)),
        ("`alpha`", new().alpha(0.0)),
        (
            "`max_error`",
            new().transmittance(Transmittance::Table { max_error: 0.0 }),
        ),
        (
            "`flights`",
            new().transmittance(Transmittance::Tracking { flights: 0 }),
        ),
    ] {
        match method.begin_pass(&host, &cx, None) {
            Err(PassError::Unsupported(why)) => assert!(why.contains(named), "{why}"),
            other => panic!("{named}: {other:?}"),
        }
    }
    let few = new()
        .paths(1000)
        .max_bytes(1000)
        .begin_pass(&host, &cx, None);
    assert!(matches!(few, Err(PassError::Memory { .. })), "{few:?}");
}
