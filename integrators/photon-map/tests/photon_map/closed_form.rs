//! Fixed radii in infinite media: the blur commutes with the light, so that its mean is known.

use crate::once::Once;
use crate::support::{Figures, KERNELS, blurred, estimate, integrate, kernel_mean, medium, sensor};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{Coefficients, PhaseFunction, Ray, Rgb, Sensor, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_photon_map::{Kernel, PhotonMap};
use tyndall_testkit::closed_form::{
    LaserRow, SLABS, airlight, emission_only, laser_row_sum, point_source_fluence,
};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Laser, Light, View};
use tyndall_testkit::measure;
use tyndall_testkit::stats::Estimate;

#[test]
fn the_fluence_of_a_point_source() {
    let sigma_t = Rgb::new(2.0, 1.0, 3.0);
    let albedo = Rgb::new(0.5, 0.9, 0.7);
    let (source, distance, radius) = (Vec3::new(3.0, -2.0, 1.0), 0.6, 0.3);
    let view = View::Fluence {
        position: source + Vec3::new(0.0, 0.0, distance),
    };
    let medium = medium(sigma_t - sigma_t * albedo, sigma_t * albedo, 0.0);
    let host = AnalyticHost::infinite_medium(medium, source, Rgb::splat(1.0), view);
    let integrators = KERNELS.map(|kernel| {
        let map = PhotonMap::new().paths(5000).kernel(kernel);
        map.radius(radius)
    });
    let estimates = estimate(&host, &integrators, 60, 150, sensor(&host));
    let mut figures = Figures::within(0.01);
    for (kernel, estimates) in KERNELS.into_iter().zip(estimates) {
        figures.add_channels(&format!("{kernel:?}"), &estimates, |channel| {
            let (sigma_t, albedo) = (sigma_t.channel(channel), albedo.channel(channel));
            let (sigma_t, albedo) = (f64::from(sigma_t), f64::from(albedo));
            blurred(kernel, radius.into(), distance.into(), f64::INFINITY, |r| {
                let uncollided = (-sigma_t * r).exp() / (4.0 * PI * r * r);
                point_source_fluence(albedo, sigma_t, r) - uncollided
            })
        });
    }
    figures.check();
}

#[test]
fn the_row_sum_of_a_laser_at_three_radii() {
    let (sigma_s, sigma_t, g) = (0.5, 0.8, 0.5);
    let mut figures = Figures::within(0.01);
    for (kernel, radius, cos_theta) in [
        (Kernel::Constant, 0.02, 0.0),
        (Kernel::Epanechnikov, 0.06, 0.6),
        (Kernel::Gaussian, 0.2, -0.5),
    ] {
        let laser = Laser {
            flux: 3.0,
            radius: 0.05,
            cos_theta,
            distance: 1.2,
            along: 1.5,
            half_width: 0.05 + radius,
            pixels: 1,
        };
        let medium = Once(medium(sigma_t - sigma_s, sigma_s, g));
        // Light travels along +x, wi = −x; the sensor looks along e, wo = −e.
        let e = Vec3::new(cos_theta, 0.0, (1.0 - cos_theta * cos_theta).sqrt());
        let phase = tyndall_core::Medium::phase(&medium, e).eval(-e, Vec3::NEG_X);
        let host = AnalyticHost::laser(medium, laser);
        let map = PhotonMap::new().paths(10_000).kernel(kernel).radius(radius);
        let map = map.step(0.3 * radius);
        let [row] = &estimate(&host, &[map], 60, 64, sensor(&host))[..] else {
            panic!("one integrator");
        };
        let pencil = laser_row_sum(&LaserRow {
            sigma_s: sigma_s.into(),
            sigma_t: sigma_t.into(),
            phase: phase.into(),
            flux: laser.flux.into(),
            radius: laser.radius.into(),
            cos_theta: cos_theta.into(),
            distance: laser.distance.into(),
            along: laser.along.into(),
        });
        // A photon δ before the point: e^(−σt(v + t)) changes by e^(κ·δ), |κ|² = 2σt²/(1 − cos θ).
        let kappa = f64::from(sigma_t) * (2.0 / (1.0 - f64::from(cos_theta))).sqrt();
        let blur = kernel_mean(kernel, radius.into(), 3, |d| {
            (kappa * d).sinh() / (kappa * d)
        });
        let width = 2.0 * f64::from(laser.half_width);
        figures.add(
            format!("{kernel:?} of radius {radius}, cos θ = {cos_theta}"),
            times(row[0], width),
            pencil * blur,
        );
    }
    figures.check();
}

fn times(estimate: Estimate, factor: f64) -> Estimate {
    Estimate {
        mean: estimate.mean * factor,
        standard_error: estimate.standard_error * factor,
        ..estimate
    }
}

#[test]
fn single_scattering_is_counted_once() {
    // By photons it is blurred, sampled it is not; all other scattering is the same. So the two
    // differ by the blur of what is known, and not by single scattering itself.
    let (sigma_t, radius) = (Rgb::new(1.5, 0.7, 2.5), 0.25);
    let sigma_s = sigma_t * Rgb::new(0.8, 0.9, 0.4);
    let ray = Ray::new(Vec3::new(-0.4, 0.6, 0.0), Vec3::X);
    let medium = medium(sigma_t - sigma_s, sigma_s, 0.0);
    let view = View::Rays(vec![ray]);
    let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, Rgb::splat(1.0), view);
    let photons = PhotonMap::new().paths(5000).radius(radius);
    let photons = &estimate(&host, &[photons], 100, 100, sensor(&host))[0];
    let sampled = PhotonMap::sampling_lights().paths(5000).radius(radius);
    let sampled = &estimate(&host, &[sampled], 100, 100, sensor(&host))[0];
    let mut figures = Figures::within(0.1);
    for channel in 0..3 {
        let (sigma_s, sigma_t) = (sigma_s.channel(channel), sigma_t.channel(channel));
        let seen = |height, before| {
            airlight(
                sigma_s.into(),
                sigma_t.into(),
                height,
                before,
                f64::INFINITY,
            )
        };
        let sharp = seen(0.6, 0.4);
        // Over the ball: shells, their polar angle about the ray, and the angle around it.
        let soft = kernel_mean_of_rays(radius.into(), |across, up, along| {
            seen((0.6 + up).hypot(across), 0.4 - along)
        });
        // Shown by adding what the sharp one has: then a missing or double one is off by it.
        let difference = photons[channel].difference(&sampled[channel]);
        let shifted = Estimate {
            mean: difference.mean + sharp,
            ..difference
        };
        figures.add(format!("channel {channel}"), shifted, soft);
    }
    figures.check();
}

/// The mean of f(x, y, z) over the default kernel's ball.
fn kernel_mean_of_rays(radius: f64, f: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let shell = |distance: f64| {
        integrate(-1.0, 1.0, 12, |mu| {
            let across = distance * (1.0 - mu * mu).sqrt();
            let around = |phi: f64| f(across * phi.cos(), across * phi.sin(), distance * mu);
            integrate(0.0, PI, 12, |phi| around(phi - PI / 2.0)) / (2.0 * PI)
        })
    };
    integrate(0.0, radius, 24, |distance| {
        let squared = (distance * distance) as f32;
        let weight = Kernel::default().weight_3d(squared, radius as f32);
        4.0 * PI * distance * distance * f64::from(weight) * shell(distance)
    })
}

#[test]
fn slabs_in_the_limit_of_small_radii() {
    // A narrow beam, and all that leaves: seen from an area of ten mean free paths around it.
    let (sigma_t, reach) = (2.5_f32, 4.0_f32);
    let mut figures = Figures::within(0.012);
    for slab in &SLABS[..3] {
        let sigma_s = slab.albedo as f32 * sigma_t;
        let medium = medium(sigma_t - sigma_s, sigma_s, slab.mean_cosine as f32);
        let thickness = slab.optical_thickness as f32 / sigma_t;
        for (exitant, towards, expected) in [
            (Exitant::Reflectance, Vec3::Z, slab.reflectance),
            (
                Exitant::Transmittance,
                Vec3::NEG_Z,
                slab.diffuse_transmittance(),
            ),
        ] {
            let mut host = AnalyticHost::slab(medium.clone(), thickness, 40.0, 1.0, exitant);
            let beam = 0.2_f32;
            host.light = Light::Beam {
                center: -Vec3::Z,
                direction: Vec3::Z,
                radius: beam,
                irradiance: 1.0 / (std::f32::consts::PI * beam * beam),
            };
            let z = if towards.z > 0.0 {
                -1e-3
            } else {
                thickness + 1e-3
            };
            // Points with a density ∝ 1/d around the beam, directions by the cosine.
            let ray = |u: &mut dyn FnMut() -> f32| {
                let (distance, angle) = (reach * u(), std::f32::consts::TAU * u());
                let position = Vec3::new(distance * angle.cos(), distance * angle.sin(), z);
                host_flux(
                    &host,
                    position,
                    towards,
                    u,
                    std::f32::consts::TAU * distance * reach,
                )
            };
            let radii = [0.05, 0.1].map(|radius| PhotonMap::new().paths(5000).radius(radius));
            let estimates = estimate(&host, &radii, 40, 2000, ray);
            // Kernels lose energy ∝ r beyond the faces: extrapolated. What is left is ∝ (σt r)²,
            // 1.6 % at the smaller radius, of what is lost, itself a tenth of the light.
            let [fine, coarse] = [estimates[0][0], estimates[1][0]];
            let extrapolated = Estimate {
                mean: 2.0 * fine.mean - coarse.mean,
                standard_error: 2.0 * fine.standard_error + coarse.standard_error,
                ..fine
            };
            figures.add(format!("{slab:?} {exitant:?}"), extrapolated, expected);
        }
    }
    figures.check();
}

/// A ray of the flux through an area around `position`.
fn host_flux(
    host: &AnalyticHost<Homogeneous<f32>>,
    position: Vec3,
    towards: Vec3,
    u: &mut dyn FnMut() -> f32,
    area: f32,
) -> tyndall_core::SensorRay<f32> {
    let mut host = host.clone();
    host.view = View::Flux { position, towards };
    let mut ray = host.sensor_ray([0, 0], [u(), u(), 0.0, 0.0]);
    ray.weight *= area;
    ray
}

#[test]
fn emission_alone() {
    let sigma_a = Rgb::new(0.2, 1.3, 4.0);
    let coefficients = Coefficients {
        sigma_a,
        sigma_s: Rgb::default(),
        emission: sigma_a,
    };
    let fire = Homogeneous::new(coefficients, Phase::Isotropic).expect("valid coefficients");
    let view = View::Rays(vec![Ray::new(Vec3::new(0.6, 0.0, -5.0), Vec3::Z)]);
    let host = AnalyticHost::sphere(fire, 1.0, Interface::Matched, Light::None, view);
    let mut figures = Figures::within(0.003);
    let values = measure(&host, &PhotonMap::new().paths(10), 1000, 1);
    figures.add_channels("a chord 1.6 long", &values, |channel| {
        emission_only(1.6 * f64::from(sigma_a.channel(channel)))
    });
    figures.check();
}
