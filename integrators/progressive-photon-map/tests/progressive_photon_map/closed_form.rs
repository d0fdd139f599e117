//! Light in closed form.

use crate::{FALSE_ALARM, fog, measure, render, sphere_of_rays};
use glam::Vec3;
use std::f64::consts::PI;
use std::path::Path;
use tyndall_core::{Frame, Medium, PhaseFunction, Ray, Rgb, Spectrum, warp};
use tyndall_density::Kernel;
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::closed_form::{LaserRow, SLABS, laser_row_sum, point_source_fluence};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Laser, View};
use tyndall_testkit::stats::{Estimate, Moments, check_means};

/// Figures with the bias that is allowed to each, of its expectation.
fn check(figures: Vec<(String, Estimate, f64, f64)>, precision: f64) {
    let cases: Vec<_> = figures
        .iter()
        .map(|(name, estimate, expected, bias)| {
            let noise = estimate.relative_standard_error();
            assert!(noise <= precision, "{name}: {noise:.4} is too noisy");
            let off = estimate.mean - expected;
            let forgiven = off.clamp(-bias * expected, bias * expected);
            (name.as_str(), *estimate, expected + forgiven)
        })
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

/// Fluence less the light that nothing has scattered: no ray meets the point that emits it.
///
/// The bias of a ball of Epanechnikov's kernel is r²/14 ∇²L, for the variance of the ball is r²/7 in
/// each direction. Light that scatters once is exp(−σt d)/d² before; seen from R = 1, its mean
/// ∇²L/L is of the order of σt² + 8/R², 11 at σt = 1.8: with r = 0.08 a bias of 0.5 %.
#[test]
fn fluence_around_a_point_source() {
    let (sigma_t, albedo) = (Rgb::new(0.7, 1.2, 1.8), Rgb::new(0.5, 0.9, 0.7));
    let (lamp, distance) = (Vec3::new(3.0, -2.0, 1.0), 1.0);
    let view = View::Rays(sphere_of_rays(lamp + distance * Vec3::Z, 2_000));
    let sigma_s = sigma_t * albedo;
    let medium = fog(sigma_t - sigma_s, sigma_s, 0.0);
    let host = AnalyticHost::infinite_medium(medium, lamp, Rgb::new(1.0, 2.0, 3.0), view);
    let mut figures = Vec::new();
    let photons = ProgressivePhotonMap::new().radius(0.08).alpha(1.0);
    let photons = measure(&host, &photons.paths(2_000), 1, 0..120);
    let sampled = ProgressivePhotonMap::sampling_lights().radius(0.08);
    let sampled = measure(&host, &sampled.alpha(1.0).paths(2_000), 1, 200..280);
    for (name, estimates) in [("photons", photons), ("sampling", sampled)] {
        for (i, estimate) in estimates.into_iter().enumerate() {
            let [a, s] = [albedo, sigma_t].map(|x| f64::from(x.channel(i)));
            let r = f64::from(distance);
            let uncollided = (-s * r).exp() / (4.0 * PI * r * r);
            let scattered = point_source_fluence(a, s, r) - uncollided;
            let expected = (i + 1) as f64 * scattered / (4.0 * PI);
            figures.push((format!("{name}, channel {i}"), estimate, expected, 0.005));
        }
    }
    check(figures, 0.025);
}

/// What a slab reflects and lets through, by rays from the middle of its sides.
///
/// Within r of a side the kernel loses 5/32 r, as in the furnace, of what collisions there send out,
/// which is a φ E₂(τ)/2 an optical depth τ behind the side that is measured. The fluence φ at a side is
/// what comes in and, if it leaves as from a diffuser, twice what goes out: true to a tenth, so that
/// the loss (4 % of the reflectance) is known to 0.5 % of the figure; curvature adds as much.
#[test]
fn slab_reflectance_and_transmittance() {
    const E2_OF_2: f64 = 0.037_534_3; // Abramowitz & Stegun (1964), table 5.4
    let (sigma_t, radius, slab) = (2.5_f32, 0.05_f32, SLABS[1]);
    let (albedo, thickness) = (slab.albedo as f32, slab.optical_thickness as f32 / sigma_t);
    let medium = fog((1.0 - albedo) * sigma_t, albedo * sigma_t, 0.0);
    let [inner, outer] = [slab.reflectance, slab.diffuse_transmittance()];
    let fluence = [1.0 + 2.0 * inner, slab.transmittance - outer + 2.0 * outer];
    let lost = 5.0 / 32.0 * f64::from(radius * sigma_t) * slab.albedo / 2.0;
    let method = ProgressivePhotonMap::new().radius(radius).alpha(1.0);
    let mut figures = Vec::new();
    for (name, z, towards, leaving, near, far) in [
        ("reflectance", -1e-3, Vec3::Z, inner, fluence[0], fluence[1]),
        (
            "transmittance",
            thickness + 1e-3,
            Vec3::NEG_Z,
            outer,
            fluence[1],
            fluence[0],
        ),
    ] {
        let exitant = Exitant::Reflectance; // of which the view is replaced
        let mut host = AnalyticHost::slab(medium.clone(), thickness, 4.0, 1.0, exitant);
        let frame = Frame::around(towards);
        let rays = (0..1_000).map(|i| {
            let u = |base: f32| (0.5 + i as f32 * base).fract(); // Kronecker's sequence
            let origin = Vec3::new(u(0.754_877_7) - 0.5, u(0.569_840_3) - 0.5, z);
            let local = warp::cosine_hemisphere([u(0.819_172_5), u(0.671_043_6)]);
            Ray::new(origin, frame.to_world(local))
        });
        host.view = View::Rays(rays.collect());
        let mean = measure(&host, &method.paths(8_000), 1, 0..60)[0];
        let flux = Estimate {
            mean: PI * mean.mean,
            standard_error: PI * mean.standard_error,
            ..mean
        };
        let expected = leaving - lost * (near + far * E2_OF_2);
        figures.push((name.to_owned(), flux, expected, 0.01));
    }
    check(figures, 0.015);
}

/// From the middle of a white ball the walls of the furnace are seen through it. Its light is even,
/// so that kernels of any width are right, but for what they lose within r of the boundary, where
/// σt r exp(−σt R) of the collisions are: there a kernel loses on average the mean of its offset
/// along the normal where that is positive, 5/32 r for Epanechnikov's and 3/16 r for the constant.
#[test]
fn the_furnace_is_white_away_from_boundaries() {
    let view = View::Rays(sphere_of_rays(Vec3::new(0.1, 0.0, 0.0), 150));
    let (radius, r) = (3.0_f32, 0.5_f32);
    let sigma_s = Rgb::new(0.5, 0.7, 1.0);
    let mut figures = Vec::new();
    for (kernel, lost, radii, g) in [
        (Kernel::Constant, 3.0 / 16.0, Radii::Memoryless, 0.0),
        (Kernel::Epanechnikov, 5.0 / 32.0, Radii::Statistics, 0.8),
    ] {
        let medium = fog(Rgb::default(), sigma_s, g);
        let host = AnalyticHost::furnace(medium, radius, Interface::Matched, view.clone());
        let method = ProgressivePhotonMap::new()
            .radius(r)
            .alpha(1.0)
            .kernel(kernel)
            .radii(radii);
        let estimates = measure(&host, &method.paths(1_500), 2, 0..50);
        for (i, estimate) in estimates.into_iter().enumerate() {
            let s = sigma_s.channel(i);
            let loss = f64::from(lost * s * r * (-s * radius).exp());
            let name = format!("{kernel:?} {radii:?} channel {i}");
            figures.push((name, estimate, 1.0 - loss, 3e-3));
        }
    }
    check(figures, 0.025);
}

/// The sum across a laser does not depend on the radius but for the blur along the ray and the beam,
/// which averages exponentials: with an offset δ of variance r²/7 in each direction, what is
/// attenuated over t + v has a gradient of square 2/(1 − cos θ) in δ, and its mean the factor
/// 1 + σt² r²/(7 (1 − cos θ)); r⁴ adds less than 1e-3. Light that scatters twice adds the albedo,
/// 1e-3, times less than 1.
#[test]
fn the_row_sum_of_a_laser_does_not_depend_on_the_radius() {
    let (sigma_t, albedo) = (0.8, 1e-3);
    let mut figures = Vec::new();
    for cos_theta in [0.0, 0.6] {
        for radius in [0.08, 0.16, 0.32] {
            let laser = Laser {
                flux: 3.0,
                radius: 0.03,
                cos_theta,
                distance: 1.2,
                along: 1.5,
                half_width: radius + 0.031,
                pixels: 1_024,
            };
            let medium = fog(sigma_t * (1.0 - albedo), sigma_t * albedo, 0.5);
            let e = Vec3::new(cos_theta, 0.0, (1.0 - cos_theta * cos_theta).sqrt());
            let phase = medium.phase(Vec3::ZERO).eval(-e, Vec3::NEG_X);
            let host = AnalyticHost::laser(medium, laser);
            let method = ProgressivePhotonMap::new()
                .radius(radius)
                .alpha(1.0)
                .paths(400);
            let mean = measure(&host, &method, 4, 0..60)[0];
            let width = f64::from(laser.pixel_width()) * f64::from(laser.pixels);
            let sum = Estimate {
                mean: mean.mean * width,
                standard_error: mean.standard_error * width,
                ..mean
            };
            let expected = laser_row_sum(&LaserRow {
                sigma_s: f64::from(sigma_t * albedo),
                sigma_t: f64::from(sigma_t),
                phase: f64::from(phase),
                flux: f64::from(laser.flux),
                radius: f64::from(laser.radius),
                cos_theta: f64::from(cos_theta),
                distance: f64::from(laser.distance),
                along: f64::from(laser.along),
            });
            let blur = f64::from(sigma_t * radius).powi(2) / (7.0 * f64::from(1.0 - cos_theta));
            let name = format!("cos θ {cos_theta}, radius {radius}");
            figures.push((name, sum, expected * (1.0 + blur), 2e-3));
        }
    }
    check(figures, 0.025);
}

/// A lamp one unit above a floor of reflectance 0.6, in a picture of this width.
pub(crate) fn floor(width: f32) -> Scene<f32> {
    let text = format!(
        r#"
        [camera]
        kind = "orthographic"
        position = [0, 0.5, 0]
        look_at = [0, 0, 0]
        up = [0, 0, 1]
        width = {width}
        [film]
        width = 8
        height = 8
        [materials.floor]
        kind = "diffuse"
        reflectance = 0.6
        [[lights]]
        kind = "point"
        position = [0, 1, 0]
        power = 4
        [[shapes]]
        kind = "quad"
        corner = [-20, 0, 20]
        edge_u = [40, 0, 0]
        edge_v = [0, 0, -40]
        material = "floor"
    "#
    );
    let file = SceneFile::parse(&text, Path::new("floor.toml"), &[]).expect("a scene");
    file.build().expect("a host")
}

/// Irradiance ρ off the foot is I/(1 + ρ²)^1.5: over the picture, 0.2 wide, its mean is less by
/// 1.5 · 0.2²/6 = 1 %, and by r²/2 more where a kernel of radius r blurs it (∇²E/E = −6, and the
/// variance of Epanechnikov's disc is r²/6 in each direction).
#[test]
fn a_floor_under_a_lamp() {
    let host = floor(0.2);
    let lit = 0.6 / PI * 4.0 / (4.0 * PI) * (1.0 - 0.01);
    let radius = 0.1;
    let mut figures = Vec::new();
    let photons = ProgressivePhotonMap::new()
        .radius(radius)
        .alpha(1.0)
        .paths(5_000);
    let blurred = lit * (1.0 - 0.5 * f64::from(radius * radius));
    let estimate = measure(&host, &photons, 1, 0..150)[0];
    figures.push(("photons".to_owned(), estimate, blurred, 1e-3));
    let nearest = ProgressivePhotonMap::new().paths(5_000).nearest(200);
    let estimate = measure(&host, &nearest, 4, 0..40)[0];
    figures.push(("nearest".to_owned(), estimate, lit, 5e-3));
    let statistics = nearest.radii(Radii::Statistics);
    let estimate = measure(&host, &statistics, 4, 0..40)[0];
    figures.push(("statistics".to_owned(), estimate, lit, 5e-3));
    check(figures, 0.01);
    // Nothing is scattered twice, so that sampled light has no noise but that of the pixel.
    let sampled = ProgressivePhotonMap::sampling_lights().paths(100);
    let mean: Moments = render(&host, &sampled, 20, 1).into_iter().collect();
    assert!((mean.estimate().mean / lit - 1.0).abs() < 2e-3);
}
