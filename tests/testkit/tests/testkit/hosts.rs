//! The analytic hosts, path-traced, show their closed forms.
//!
//! Every test has a false-alarm rate of [`RATE`] and a relative standard error below one per cent;
//! the suite repeats the measurements with smaller errors.

use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{Coefficients, LightDirect, LightEmission, Ray, Rgb, Sampler, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::{Path, Scattering};
use tyndall_testkit::closed_form::{
    HFunction, LaserRow, SLABS, airlight, emission_only, laser_row_sum, point_source_fluence,
};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Laser, Light, View};
use tyndall_testkit::stats::{Estimate, Moments, assert_mean};
use tyndall_testkit::{measure_mean, rng};

const RATE: f64 = 1e-6;

fn medium<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    Homogeneous::new(coefficients, Phase::henyey_greenstein(g).unwrap()).unwrap()
}

/// The mean over all pixels, per channel.
fn render<S: Spectrum>(
    host: &AnalyticHost<Homogeneous<S>>,
    path: &Path,
    passes: u64,
) -> Vec<Estimate> {
    measure_mean(host, path, passes, 0)
}

fn single() -> Path {
    Path::new().scattering(Scattering::Single)
}

#[test]
fn airlight_of_a_point_light() {
    let medium = medium(Rgb::new(0.1, 0.5, 0.0), Rgb::new(0.5, 2.0, 0.3), 0.0);
    // Nearest to the light, 0.7 away, after 2.
    let view = View::Rays(vec![Ray::new(Vec3::new(-2.0, 0.7, 0.0), Vec3::X)]);
    let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, Rgb::splat(3.0), view);
    let measured = render(&host, &single(), 20_000);
    for (c, sigma_s, sigma_t) in [(0, 0.5, 0.6), (1, 2.0, 2.5), (2, 0.3, 0.3)] {
        let expected = 3.0 * airlight(sigma_s, sigma_t, f64::from(0.7_f32), 2.0, f64::INFINITY);
        assert_mean("airlight", measured[c], expected, RATE);
        assert!(measured[c].relative_standard_error() < 0.01);
    }
}

#[test]
fn fluence_of_a_point_light() {
    let host = AnalyticHost::infinite_medium(
        medium(0.25_f32, 2.25, 0.0),
        Vec3::X,
        1.0,
        View::Fluence {
            position: Vec3::new(1.0, 0.4, 0.0),
        },
    );
    let measured = render(&host, &Path::new(), 200_000)[0];
    let r = f64::from(0.4_f32);
    let uncollided = (-2.5 * r).exp() / (4.0 * PI * r * r);
    let expected = point_source_fluence(0.9, 2.5, r) - uncollided;
    assert_mean("fluence", measured, expected, RATE);
    assert!(measured.relative_standard_error() < 0.01, "{measured:?}");
}

#[test]
fn slabs_reflect_and_transmit() {
    for slab in &SLABS[..3] {
        let sigma_t = 2.0;
        let sigma_s = sigma_t * slab.albedo as f32;
        let thickness = slab.optical_thickness as f32 / sigma_t;
        for (exitant, expected) in [
            (Exitant::Reflectance, slab.reflectance),
            (Exitant::Transmittance, slab.diffuse_transmittance()),
        ] {
            let medium = medium(sigma_t - sigma_s, sigma_s, slab.mean_cosine as f32);
            let host = AnalyticHost::slab(medium, thickness, 25.0, 1.0, exitant);
            let mut measured = render(&host, &Path::new(), 80_000)[0];
            // The figures are given to ± 1e-4, in five digits.
            measured.standard_error = measured.standard_error.hypot(5e-5);
            assert_mean(&format!("{slab:?} {exitant:?}"), measured, expected, RATE);
            assert!(measured.relative_standard_error() < 0.012, "{measured:?}");
        }
    }
}

#[test]
fn half_space_under_oblique_light() {
    let (mu_0, mu) = (0.5, 0.8);
    let h = HFunction::new(0.9);
    let host = |exitant| {
        let medium = medium(0.2_f32, 1.8, 0.0);
        AnalyticHost::slab(medium, f32::INFINITY, 50.0, mu_0 as f32, exitant)
    };
    let reflectance = render(&host(Exitant::Reflectance), &Path::new(), 20_000)[0];
    assert_mean("plane albedo", reflectance, h.plane_albedo(mu_0), RATE);
    let radiance = render(&host(Exitant::Radiance(mu as f32)), &Path::new(), 20_000)[0];
    let expected = h.radiance(mu_0, mu) / mu_0;
    assert_mean("angular radiance", radiance, expected, RATE);
}

#[test]
fn lasers_have_the_row_sum_of_their_flux() {
    for (cos_theta, radius) in [(0.0, 0.01), (0.6, 0.3), (-0.7, 0.3)] {
        let laser = Laser {
            flux: 2.0,
            radius,
            cos_theta,
            distance: 2.0,
            along: 1.0,
            half_width: 0.4,
            pixels: 10,
        };
        let host = AnalyticHost::laser(medium(0.5_f32, 1.0, 0.4), laser);
        let mut measured = render(&host, &single(), 50_000)[0];
        let width = f64::from(laser.pixel_width()) * f64::from(laser.pixels);
        measured.mean *= width;
        measured.standard_error *= width;
        // Henyey & Greenstein (1941) at the cosine −cos θ.
        let (g, c) = (f64::from(0.4_f32), -f64::from(cos_theta));
        let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * c).powf(1.5));
        let expected = laser_row_sum(&LaserRow {
            sigma_s: 1.0,
            sigma_t: 1.5,
            phase,
            flux: 2.0,
            radius: f64::from(radius),
            cos_theta: f64::from(cos_theta),
            distance: 2.0,
            along: 1.0,
        });
        assert_mean(&format!("{laser:?}"), measured, expected, RATE);
        assert!(measured.relative_standard_error() < 0.02, "{measured:?}");
    }
}

/// Outside of the sphere and within: 1 and n².
#[test]
fn furnaces_are_white() {
    for interface in [Interface::Matched, Interface::Dielectric(1.5)] {
        let inside = match interface {
            Interface::Matched => 1.0,
            Interface::Dielectric(index) => f64::from(index * index),
        };
        for (eye, expected) in [(-3.0, 1.0), (-0.3, inside)] {
            let view = View::Pinhole {
                eye: Vec3::new(0.0, 0.0, eye),
                forward: Vec3::Z,
                half_width: 0.2,
                pixels: 4,
            };
            let medium = medium(0.0_f32, 2.0, 0.6);
            let host = AnalyticHost::furnace(medium, 1.0, interface, view);
            let measured = render(&host, &Path::new(), 2_000)[0];
            assert_mean(
                &format!("{interface:?} from {eye}"),
                measured,
                expected,
                RATE,
            );
            assert!(measured.relative_standard_error() < 0.01, "{measured:?}");
        }
    }
}

#[test]
fn a_sphere_of_fire_over_a_background() {
    let coefficients = Coefficients {
        sigma_a: 0.8_f32,
        sigma_s: 0.0,
        emission: 0.8,
    };
    let medium = Homogeneous::new(coefficients, Phase::Isotropic).unwrap();
    let view = View::Rays(vec![Ray::new(Vec3::new(-9.0, 1.2, 0.0), Vec3::X)]);
    let mut host = AnalyticHost::sphere(medium, 2.0, Interface::Matched, Light::None, view);
    let depth = f64::from(0.8_f32) * 2.0 * (4.0 - f64::from(1.2_f32).powi(2)).sqrt();
    let fire = render(&host, &Path::new(), 4)[0];
    assert_mean("fire", fire, emission_only(depth), RATE);
    host.light = Light::Background {
        radiance: 5.0,
        reach: 2.1,
    };
    let lit = render(&host, &Path::new().scattering(Scattering::None), 4)[0];
    assert_mean(
        "lit",
        lit,
        emission_only(depth) + 5.0 * (-depth).exp(),
        RATE,
    );
}

/// Rays of a thin beam along the axis leave a ball of index n so that they meet n/(2(n − 1)) radii
/// behind its middle (paraxial; the rest is 1e-4 for a beam
/// of a hundredth of the radius, and rounding of the slopes, 1e-7 over 1e-3).
#[test]
fn a_glass_ball_focuses() {
    let index = 1.5_f32;
    let host = AnalyticHost::sphere(
        medium(0.0_f32, 0.0, 0.0),
        2.0,
        Interface::Dielectric(index),
        Light::Beam {
            center: Vec3::new(0.0, 0.0, -5.0),
            direction: Vec3::Z,
            radius: 0.02,
            irradiance: 1.0,
        },
        View::Rays(Vec::new()),
    );
    use tyndall_core::{Anchor, Geometry, MediumId, PathFrom, Shading};
    let mut sampler = rng(1);
    let mut refracted = 0;
    for _ in 0..1000 {
        let mut ray = host.sample_emission(sampler.next()).unwrap().ray;
        for _ in 0..2 {
            let (_, hit) = host.intersect(&ray, MediumId::VACUUM).unwrap();
            // u[0] near 1: refract.
            let sample = host
                .bsdf_sample(&hit, -ray.direction, [0.99, 0.5, 0.5], PathFrom::Light)
                .unwrap();
            ray = host.spawn(&Anchor::Surface(hit), sample.wi);
        }
        if ray.origin.truncate().length() > 1e-3 {
            let t = -ray.origin.x.hypot(ray.origin.y) / -ray.direction.truncate().length();
            let focus = 2.0 * index / (2.0 * (index - 1.0));
            assert!((ray.at(t).z / focus - 1.0).abs() < 5e-3, "{}", ray.at(t));
            refracted += 1;
        }
    }
    assert!(refracted > 900);
}

#[test]
fn lights_emit_their_power() {
    let light: Light<f32> = Light::Beam {
        center: Vec3::ZERO,
        direction: Vec3::Y,
        radius: 0.5,
        irradiance: 3.0,
    };
    let host = AnalyticHost {
        light,
        ..AnalyticHost::infinite_medium(medium(1.0, 0.0, 0.0), Vec3::ZERO, 1.0, View::Rays(vec![]))
    };
    let mut sampler = rng(5);
    let flux: Moments = (0..100)
        .filter_map(|_| host.sample_emission(sampler.next()))
        .map(|sample| f64::from(sample.flux))
        .collect();
    assert_mean("beam", flux.estimate(), 0.75 * PI, RATE);
}

#[test]
fn a_beam_lights_what_lies_before_it() {
    let laser = Laser {
        flux: PI as f32,
        radius: 0.5,
        cos_theta: 0.0,
        distance: 1.0,
        along: 1.0,
        half_width: 0.5,
        pixels: 1,
    };
    let host = AnalyticHost::laser(medium(0.0_f32, 1.0, 0.0), laser);
    for (x, y, expected) in [
        (3.0, 0.49, Some(4.0)), // π/(π/4)
        (3.0, 0.51, None),
        (-0.1, 0.0, None),
    ] {
        let light = host.sample_direct(Vec3::new(x, y, 0.0), [0.0; 4]);
        assert_eq!(light.map(|l| l.weight), expected, "at {x}, {y}");
    }
}
