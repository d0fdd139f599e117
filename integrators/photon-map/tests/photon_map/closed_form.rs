//! Fixed radii in infinite media: the blur commutes with the light, so that its mean is known.

use crate::once::Once;
use crate::support::{
    Figures, KERNELS, blurred, estimate, extrapolate, integrate, kernel_mean, medium, moved,
    sensor, tabulated, turned,
};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{Coefficients, MediumId, PhaseFunction, Ray, Rgb, Sensor, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_photon_map::{Kernel, PhotonMap};
use tyndall_testkit::closed_form::{
    LaserRow, SLABS, Slab, airlight, emission_only, laser_row_sum, point_source_fluence,
};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Laser, Light, View};
use tyndall_testkit::measure;
use tyndall_testkit::stats::Estimate;

/// The medium of analytic hosts.
const INSIDE: MediumId = MediumId(1);

#[test]
fn the_fluence_of_a_point_source() {
    let sigma_t = Rgb::new(2.0, 1.0, 3.0);
    let albedo = Rgb::new(0.5, 0.9, 0.7);
    let (distance, radius) = (0.6_f32, 0.3_f32);
    let medium = medium(sigma_t - sigma_t * albedo, sigma_t * albedo, 0.0);
    let view = View::Rays(Vec::new());
    let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, Rgb::splat(1.0), view);
    // From a random point at that distance, in all directions.
    let ray = |u: &mut dyn FnMut() -> f32| {
        let cosine = 2.0 * u() - 1.0;
        let beside = distance * (1.0 - cosine * cosine).sqrt();
        let mut ray = turned(beside, distance * cosine, INSIDE, u);
        ray.weight = Rgb::splat(4.0 * std::f32::consts::PI);
        ray
    };
    let integrators = KERNELS.map(|kernel| {
        let map = PhotonMap::new().paths(1000).kernel(kernel);
        map.radius(radius)
    });
    let estimates = estimate(&host, &integrators, 40, 120, ray);
    // In [0.3, 0.9], linear over 0.002 to a part in 1e5 of what falls at most as r^−3.
    let scattered = |channel| {
        let sigma_t = f64::from(sigma_t.channel(channel));
        let albedo = f64::from(albedo.channel(channel));
        let [near, far] = [distance - radius, distance + radius].map(f64::from);
        tabulated(near, far, 300, move |r| {
            let uncollided = (-sigma_t * r).exp() / (4.0 * PI * r * r);
            point_source_fluence(albedo, sigma_t, r) - uncollided
        })
    };
    let scattered = [0, 1, 2].map(scattered);
    let mut figures = Figures::within(0.03);
    for (kernel, estimates) in KERNELS.into_iter().zip(estimates) {
        figures.add_channels(&format!("{kernel:?}"), &estimates, |channel| {
            let (radius, distance) = (radius.into(), distance.into());
            blurred(kernel, radius, distance, f64::INFINITY, &scattered[channel])
        });
    }
    figures.check();
}

#[test]
fn the_row_sum_of_a_laser_at_three_radii() {
    let (sigma_s, sigma_t, g) = (0.5, 0.8, 0.5);
    let mut figures = Figures::within(0.02);
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
        let [row] = &estimate(&host, &[map], 80, 64, sensor(&host))[..] else {
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
    let medium = medium(sigma_t - sigma_s, sigma_s, 0.0);
    let view = View::Rays(Vec::new());
    let host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, Rgb::splat(1.0), view);
    let ray = |u: &mut dyn FnMut() -> f32| turned(0.6, -0.4, INSIDE, u);
    let photons = PhotonMap::new().paths(5000).radius(radius);
    let photons = &estimate(&host, &[photons], 40, 120, ray)[0];
    let sampled = PhotonMap::sampling_lights().paths(5000).radius(radius);
    let sampled = &estimate(&host, &[sampled], 40, 120, ray)[0];
    let mut figures = Figures::within(0.05);
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
        let moved = moved(photons[channel], sampled[channel], sharp);
        figures.add(format!("channel {channel}"), moved, soft);
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
fn a_slab_in_the_limit_of_small_radii() {
    slabs(&SLABS[..1], 700, 0.03);
}

#[test]
#[ignore = "long: cargo test -p tyndall-photon-map -- --ignored"]
fn slabs_in_the_limit_of_small_radii() {
    slabs(&SLABS[1..3], 8000, 0.02);
}

fn slabs(slabs: &[Slab], rays: u32, precision: f64) {
    // A narrow beam, and all that leaves, at any distance from it. Kernels lose energy ∝ r beyond
    // the faces, which is extrapolated; what is left is ∝ (σt r)², 2 %, of that tenth of the light
    // which a kernel of one mean free path would lose.
    let sigma_t = 2.5_f32;
    let mut figures = Figures::within(precision);
    for slab in slabs {
        let sigma_s = slab.albedo as f32 * sigma_t;
        let medium = medium(sigma_t - sigma_s, sigma_s, slab.mean_cosine as f32);
        let thickness = slab.optical_thickness as f32 / sigma_t;
        for (exitant, expected) in [
            (Exitant::Reflectance, slab.reflectance),
            (Exitant::Transmittance, slab.diffuse_transmittance()),
        ] {
            let mut host = AnalyticHost::slab(medium.clone(), thickness, 40.0, 1.0, exitant);
            let beam = 0.2_f32;
            host.light = Light::Beam {
                center: -Vec3::Z,
                direction: Vec3::Z,
                radius: beam,
                irradiance: 1.0 / (std::f32::consts::PI * beam * beam),
            };
            // Distances from the beam with a density ∝ e^−d/2 in mean free paths.
            let ray = |u: &mut dyn FnMut() -> f32| {
                let (depth, angle) = (-(1.0 - u()).ln(), std::f32::consts::TAU * u());
                let distance = 2.0 * depth / sigma_t;
                let offset = distance * Vec3::new(angle.cos(), angle.sin(), 0.0);
                let mut ray = host.sensor_ray([0, 0], [u(), u(), 0.0, 0.0]);
                ray.ray.origin += offset;
                ray.weight *= std::f32::consts::TAU * distance * depth.exp() * 2.0 / sigma_t;
                ray
            };
            let radii = [0.06, 0.12].map(|radius| PhotonMap::new().paths(4000).radius(radius));
            let estimates = extrapolate(&host, &radii, 60, rays, ray);
            figures.add(format!("{slab:?} {exitant:?}"), estimates[0], expected);
        }
    }
    figures.check();
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
