//! Closed forms against published figures, against each other and at their limits.

use std::f64::consts::PI;
use tyndall_testkit::closed_form::{
    HFunction, LaserRow, SLABS, airlight, emission_only, laser_row_sum, point_source_fluence,
};

fn assert_near(value: f64, expected: f64, relative: f64) {
    assert!(
        (value / expected - 1.0).abs() <= relative,
        "{value:.9e}, expected {expected:.9e} within {relative:.0e}"
    );
}

#[test]
fn airlight_figures() {
    assert_near(airlight(0.5, 0.6, 1.0, 2.0, 4.0), 1.10223627e-3, 1e-8);
    assert_near(airlight(2.0, 2.5, 0.3, 1.0, 2.0), 4.04067023e-3, 1e-8);
}

/// Without extinction it is σs/(4π)² times the angle over h; an infinite ray is the limit.
#[test]
fn airlight_limits() {
    let angle = f64::atan(2.0 / 0.3) + f64::atan(1.0 / 0.3);
    assert_near(
        airlight(1.0, 0.0, 0.3, 1.0, 3.0),
        angle / 0.3 / (16.0 * PI * PI),
        1e-12,
    );
    let (infinite, long) = (
        airlight(0.5, 0.6, 1.0, 2.0, f64::INFINITY),
        airlight(0.5, 0.6, 1.0, 2.0, 100.0),
    );
    assert_near(infinite, long, 1e-9);
}

#[test]
fn half_space_figures() {
    for (albedo, reflectance) in [(0.5, 0.11523), (0.9, 0.41495), (0.99, 0.75272)] {
        let h = HFunction::new(albedo);
        assert!(
            (h.plane_albedo(1.0) - reflectance).abs() < 0.5e-5,
            "{albedo}"
        );
        // Chandrasekhar (1960), ch. V: H has mean (2/a)(1 − √(1−a)).
        let mean = midpoints(|mu| h.eval(mu));
        assert_near(mean, 2.0 / albedo * (1.0 - (1.0 - albedo).sqrt()), 1e-6);
    }
}

/// The flux of the radiance is the plane albedo, for oblique light too.
#[test]
fn half_space_radiance_integrates_to_its_reflectance() {
    let h = HFunction::new(0.8);
    let mu_0 = 0.4;
    let flux = midpoints(|mu| 2.0 * PI * mu * h.radiance(mu_0, mu) / mu_0);
    assert_near(flux, h.plane_albedo(mu_0), 1e-6);
}

/// Conservative scattering: H(1) as tabulated by Chandrasekhar (1960), ch. V.
#[test]
fn conservative_half_space() {
    let h = HFunction::new(1.0);
    assert!((h.eval(1.0) - 2.9078).abs() < 1e-4, "{}", h.eval(1.0));
    assert_eq!(h.plane_albedo(0.3), 1.0);
    assert_eq!(HFunction::new(0.0).eval(0.5), 1.0);
}

#[test]
fn point_source_figures() {
    assert_near(point_source_fluence(0.5, 1.0, 1.0), 0.0586951, 1e-6);
    assert_near(point_source_fluence(0.9, 1.0, 1.0), 0.143284, 4e-6);
}

/// What is emitted is absorbed: ∫ φ dV = 1/σa. And without scattering φ = exp(−σt r)/(4π r²); at
/// albedo 1 it falls like diffusion, 3σt/(4π r).
#[test]
fn point_source_limits() {
    let (sigma_t, albedo) = (2.5, 0.7);
    let volume = integrate(30.0, |r| {
        4.0 * PI * r * r * point_source_fluence(albedo, sigma_t, r)
    });
    assert_near(volume, 1.0 / ((1.0 - albedo) * sigma_t), 1e-5);
    let free = (-2.0_f64).exp() / (16.0 * PI);
    assert_near(point_source_fluence(0.0, 1.0, 2.0), free, 1e-12);
    assert_near(point_source_fluence(1e-9, 1.0, 2.0), free, 1e-7);
    assert_near(
        point_source_fluence(1.0, 2.0, 50.0),
        3.0 * 2.0 / (4.0 * PI * 50.0),
        1e-3,
    );
    assert_near(
        point_source_fluence(1.0 - 1e-9, 1.0, 1.0),
        point_source_fluence(1.0, 1.0, 1.0),
        1e-4,
    );
}

#[test]
fn slabs_conserve_energy() {
    for slab in SLABS {
        let left = 1.0 - slab.reflectance - slab.transmittance;
        if slab.albedo == 1.0 {
            assert!(left.abs() < 2e-5, "{slab:?}");
        } else {
            assert!(left > 0.0, "{slab:?}");
        }
        assert!(slab.diffuse_transmittance() > 0.0);
    }
}

#[test]
fn emission_limits() {
    assert_near(emission_only(1e-12), 1e-12, 1e-11);
    assert_eq!(emission_only(f64::INFINITY), 1.0);
}

/// The section of a wide beam, by brute force over it.
#[test]
fn laser_of_finite_radius() {
    let row = LaserRow {
        sigma_s: 0.7,
        sigma_t: 1.3,
        phase: 0.06,
        flux: 2.0,
        radius: 0.8,
        cos_theta: -0.5,
        distance: 3.0,
        along: 2.0,
    };
    let sin = 0.75_f64.sqrt();
    let pencil = laser_row_sum(&LaserRow { radius: 0.0, ..row });
    let mean = 2.0 / PI
        * integrate(2.0, |x| {
            let z = x - 1.0;
            (-1.3 * 0.8 * z * 0.5 / sin).exp() * (1.0 - z * z).sqrt()
        });
    assert_near(laser_row_sum(&row), pencil * mean, 1e-5);
}

fn midpoints(f: impl Fn(f64) -> f64) -> f64 {
    integrate(1.0, f)
}

/// ∫ over [0, `end`] by midpoints, substituted to be dense at both ends.
fn integrate(end: f64, f: impl Fn(f64) -> f64) -> f64 {
    const N: usize = 2_000;
    let sum: f64 = (0..N)
        .map(|i| PI * (i as f64 + 0.5) / N as f64)
        .map(|a| 0.5 * end * a.sin() * f(0.5 * end * (1.0 - a.cos())))
        .sum();
    sum * PI / N as f64
}
