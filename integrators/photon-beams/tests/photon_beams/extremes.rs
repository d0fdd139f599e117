//! Where numbers run out: every sample is finite ([`Run`] asserts it), and where light is known it
//! is right.

use crate::{FALSE_ALARM, fixed, fog};
use glam::Vec3;
use std::sync::atomic::AtomicBool;
use tyndall_core::{Integrator, Medium, PassContext, PassError, PhaseFunction, Ray, Rgb, Spectrum};
use tyndall_driver::PassStreams;
use tyndall_media::Homogeneous;
use tyndall_photon_beams::{Estimate, Extent, PhotonBeams, Transmittance};
use tyndall_testkit::Run;
use tyndall_testkit::hosts::{AnalyticHost, Boundary, Interface, Light, View};
use tyndall_testkit::stats::Figures;

type Host = AnalyticHost<Homogeneous<Rgb>>;

const ONCE: Run = Run {
    passes: 1,
    samples: 1,
    seed: 1,
};

fn chords(scale: f32) -> View {
    let ray = |x: f32, z: f32| Ray::new(Vec3::new(x, 0.0, z) * scale, Vec3::Z);
    // Through the middle, from it, and one that only just touches the ball.
    View::Rays(vec![ray(0.0, -2.0), ray(0.1, 0.0), ray(0.999_99, -2.0)])
}

#[test]
fn furnaces_from_empty_to_opaque() {
    for (sigma, albedo, g) in [
        (0.0, 0.5, 0.0),
        (1e-12, 1.0, 0.95),
        (1e-6, 0.5, -0.95),
        (1.0, 0.0, 0.0),
        (1.0, 1.0, 0.95),
        (1.0, 1.0, -0.95),
        (100.0, 1.0, 0.0),
        (1e6, 0.0, 0.0),
        (1e6, 0.5, 0.95),
    ] {
        for scale in [1e-6, 1.0, 1e6] {
            let sigma_t = Rgb::new(1.0, 0.1, 0.0) * (sigma / scale);
            let medium = fog(sigma_t * (1.0 - albedo), sigma_t * albedo, g);
            let host = AnalyticHost::furnace(medium, scale, Interface::Matched, chords(scale));
            for estimate in Estimate::ALL {
                // Nothing, a part and much more than the scene.
                for radius in [1e-9, 0.1, 1e5] {
                    let method = fixed(estimate, (radius * scale).max(1e-12)).paths(20);
                    for extent in [Extent::Long, Extent::Short] {
                        let method = method.light_beams(extent).sight_beams(extent);
                        let mean = ONCE.measure(&host, &method);
                        let name = format!(
                            "{estimate}, {extent}, σt {sigma} albedo {albedo} scale {scale} radius {radius}"
                        );
                        // The last channel is empty.
                        assert_eq!(mean[2].mean, 1.0, "{name}");
                        let valid = |mean: f64| (0.0..f64::INFINITY).contains(&mean);
                        assert!(mean.iter().all(|e| valid(e.mean)), "{name}: {mean:?}");
                        if albedo == 0.0 {
                            assert!(mean.iter().all(|e| e.mean <= 1.0), "{name}: {mean:?}");
                        }
                    }
                }
            }
        }
    }
}

const SIGMA_S: Rgb = Rgb::new(1e-4, 2e-4, 3e-4);
const SIGMA_T: Rgb = Rgb::new(1.0, 0.8, 0.6);
/// Radius of a headlight.
const WIDE: f32 = 0.5;

/// Parallel light along +x from a wide disc at the origin, and what an eye in it sees.
fn headlight(ray: Ray) -> Host {
    AnalyticHost {
        boundary: Boundary::Nowhere,
        medium: fog(SIGMA_T - SIGMA_S, SIGMA_S, 0.5),
        light: Light::Beam {
            center: Vec3::ZERO,
            direction: Vec3::X,
            radius: WIDE,
            irradiance: Rgb::splat(2.0),
        },
        view: View::Rays(vec![ray]),
    }
}

/// A ray along the beams, against them, or at a small angle to them: neither the one-dimensional
/// estimate nor the one that takes over loses light.
#[test]
fn coaxial_headlights() {
    let run = Run {
        passes: 60,
        samples: 12,
        seed: 1,
    };
    let mut figures = Figures::default();
    let length = 2.0_f32;
    for angle in [0.0, 1e-12, 1e-3, 0.02, 0.05, 0.09_f32] {
        let (sin, cos) = angle.sin_cos();
        let along = Ray::new(Vec3::ZERO, Vec3::new(cos, 0.0, sin));
        let against = Ray::new(length * Vec3::X, Vec3::new(-cos, 0.0, sin));
        for estimate in [
            Estimate::BeamBeam1D,
            Estimate::BeamBeam2DRay,
            Estimate::BeamBeam2DBeam,
        ] {
            if estimate != Estimate::BeamBeam1D && angle > 0.0 && angle != 0.05 {
                continue;
            }
            for ray in [along, against] {
                let host = headlight(ray);
                let method = fixed(estimate, 0.2).paths(200);
                let phase = host.medium.phase(Vec3::ZERO);
                let phase = f64::from(phase.eval(-ray.direction, Vec3::NEG_X));
                let found = run.measure(&host, &method);
                for (c, mean) in found.into_iter().enumerate() {
                    let (sigma_s, sigma_t) = (SIGMA_S.channel(c), SIGMA_T.channel(c));
                    let [sigma_s, sigma_t] = [sigma_s, sigma_t].map(f64::from);
                    let (sin, cos) = f64::from(angle).sin_cos();
                    let depth = if ray.origin == Vec3::ZERO {
                        // ∫ e^−σ(t + t cos θ), to where the ray leaves the light.
                        let rate = sigma_t * (1.0 + cos);
                        -(-rate * f64::from(WIDE) / sin).exp_m1() / rate
                    } else {
                        // ∫ e^−σ(t + l − t cos θ), to where the light starts.
                        let (l, rate) = (f64::from(length), sigma_t * (1.0 - cos));
                        let seen = l / cos * (1.0 - 0.5 * rate * l / cos);
                        (-sigma_t * l).exp() * seen
                    };
                    let name = format!("{estimate} at {angle} of {:?}, {c}", ray.origin);
                    let expected = 2.0 * sigma_s * phase * depth;
                    figures.add(name, mean, expected, 0.12);
                }
            }
        }
    }
    figures.check(FALSE_ALARM);
}

#[test]
fn light_that_emits_nothing() {
    let mut host = headlight(Ray::new(Vec3::ZERO, Vec3::Y));
    host.light = Light::None;
    for estimate in Estimate::ALL {
        let found = ONCE.measure(&host, &fixed(estimate, 0.1).paths(100));
        assert!(found.iter().all(|e| e.mean == 0.0), "{found:?}");
    }
    // None is emitted in the only path, or it flies away from the ray.
    host.light = Light::Point {
        position: Vec3::ONE,
        power: Rgb::default(),
    };
    let found = ONCE.measure(&host, &PhotonBeams::new().paths(1).beam_radius(0.1));
    assert!(found.iter().all(|e| e.mean == 0.0), "{found:?}");
}

#[test]
fn beams_in_one_place() {
    // A light too thin for f32, in media that stop it at once and in none.
    for sigma in [1e30, 1.0, 0.0] {
        let mut host = headlight(Ray::new(Vec3::new(1.0, 0.0, -1.0), Vec3::Z));
        host.medium = fog(Rgb::default(), Rgb::splat(sigma), 0.0);
        host.light = Light::Beam {
            center: Vec3::X,
            direction: Vec3::X,
            radius: 1e-30,
            irradiance: Rgb::splat(1e30),
        };
        let rays = [Vec3::Z, Vec3::X, Vec3::NEG_X, Vec3::new(0.6, 0.0, 0.8)];
        for estimate in Estimate::ALL {
            for radius in [1e-12, 1.0, 1e12] {
                let ray = |d: Vec3| Ray::new(Vec3::X - d, d);
                host.view = View::Rays(rays.map(ray).to_vec());
                if sigma == 1.0 && radius > 1.0 {
                    host.medium = fog(Rgb::splat(1.0), Rgb::splat(1.0), 0.0);
                }
                ONCE.measure(&host, &fixed(estimate, radius).paths(4));
            }
        }
    }
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let host = headlight(Ray::new(Vec3::ZERO, Vec3::Y));
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    let new = || PhotonBeams::new().beam_radius(0.1);
    for (named, method) in [
        ("`beam_radius`", PhotonBeams::new()), // a host without bounds
        ("`paths`", new().paths(0)),
        ("`starting_paths`", new().starting_paths(0)),
        ("`beam_radius`", new().beam_radius(0.0)),
        ("`beam_radius`", new().beam_radius(-1.0)),
        ("`beam_radius`", new().beam_radius(f32::NAN)),
        ("`beam_radius`", new().beam_radius(f32::INFINITY)),
        ("`beam_differentials`", new().beam_differentials(0.0)),
        ("`beam_differentials`", new().beam_differentials(f32::NAN)),
        ("`beam_nearest`", new().beam_nearest(1)),
        ("`light_flights`", new().light_flights(0)),
        ("`radius`", new().radius(0.0)),
        ("`surface_radius`", new().surface_radius(f32::NAN)),
        ("`alpha`", new().alpha(0.0)),
        ("`alpha`", new().alpha(f64::NAN)),
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
            Err(PassError::Unsupported(why)) => {
                assert!(why.contains(named) && !why.contains('\n'), "{why}");
            }
            other => panic!("{named}: {other:?}"),
        }
    }
    let few = new().max_bytes(1000).begin_pass(&host, &cx, None);
    assert!(matches!(few, Err(PassError::Memory { .. })), "{few:?}");
}
