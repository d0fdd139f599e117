//! White furnaces: albedo 1 under a sky of radiance 1. A kernel that reaches out of the medium
//! loses what it spreads there, and how much is known for a fixed radius.

use crate::support::{Figures, blurred, estimate, integrate, medium, sensor};
use glam::Vec3;
use tyndall_core::{Ray, Rgb, Spectrum};
use tyndall_density::Kernel;
use tyndall_photon_map::PhotonMap;
use tyndall_testkit::hosts::{AnalyticHost, Interface, View, fresnel};

const RADIUS: f64 = 0.2;
/// Of the ray from the middle of the sphere.
const OFF: f64 = 0.3;

fn rays() -> View {
    View::Rays(vec![Ray::new(Vec3::new(OFF as f32, 0.0, -5.0), Vec3::Z)])
}

/// ∫ σs Tr(t) f(distance from the middle) dt over a chord `off` the middle of the unit sphere.
fn chord(sigma_s: f64, off: f64, f: impl Fn(f64) -> f64) -> f64 {
    let half = (1.0 - off * off).sqrt();
    integrate(0.0, 2.0 * half, 300, |t| {
        sigma_s * (-sigma_s * t).exp() * f(off.hypot(t - half))
    })
}

/// The share of a kernel that lies within the unit sphere.
fn share(distance: f64) -> f64 {
    blurred(Kernel::default(), RADIUS, distance, 1.0, |_| 1.0)
}

#[test]
fn by_photons_it_is_white_but_for_the_kernels_reach() {
    let mut figures = Figures::within(0.004);
    for (sigma_s, g) in [
        (Rgb::new(0.3, 1.5, 4.0), 0.0),
        (Rgb::new(2.0, 3.0, 0.1), -0.6),
        (Rgb::new(0.5, 3.0, 9.0), 0.9),
    ] {
        let medium = medium(Rgb::default(), sigma_s, g);
        let host = AnalyticHost::furnace(medium, 1.0, Interface::Matched, rays());
        let map = PhotonMap::new().paths(4000).radius(RADIUS as f32);
        let estimates = &estimate(&host, &[map], 60, 60, sensor(&host))[0];
        figures.add_channels(&format!("g = {g}"), estimates, |channel| {
            let sigma_s = f64::from(sigma_s.channel(channel));
            let passed = (-sigma_s * 2.0 * (1.0 - OFF * OFF).sqrt()).exp();
            passed + chord(sigma_s, OFF, share)
        });
    }
    figures.check();
}

#[test]
fn in_glass_too() {
    let (sigma_s, index) = (Rgb::new(0.3, 1.5, 4.0), 1.5_f32);
    let medium = medium(Rgb::default(), sigma_s, 0.3);
    let host = AnalyticHost::furnace(medium, 1.0, Interface::Dielectric(index), rays());
    let map = PhotonMap::new().paths(8000).radius(RADIUS as f32);
    let estimates = &estimate(&host, &[map], 100, 100, sensor(&host))[0];
    let reflectance = f64::from(fresnel((1.0 - OFF * OFF).sqrt() as f32, index).0);
    let (squared, off) = (f64::from(index * index), OFF / f64::from(index));
    let mut figures = Figures::within(0.005);
    figures.add_channels("glass", estimates, |channel| {
        let sigma_s = f64::from(sigma_s.channel(channel));
        let passed = (-sigma_s * 2.0 * (1.0 - off * off).sqrt()).exp();
        // Inside radiance is n² where no kernel loses; each chord ends in R of the next.
        let chord = squared * chord(sigma_s, off, share);
        let through = passed * (1.0 - reflectance) * squared;
        let inside = (chord + through) / (1.0 - passed * reflectance);
        reflectance + (1.0 - reflectance) * inside / squared
    });
    figures.check();
}

#[test]
fn sampled_light_is_not_blurred() {
    let sigma_s = 1.5;
    let host = AnalyticHost::furnace(medium(0.0, sigma_s, 0.0), 1.0, Interface::Matched, rays());
    let map = PhotonMap::sampling_lights()
        .paths(4000)
        .radius(RADIUS as f32);
    let estimates = &estimate(&host, &[map], 100, 100, sensor(&host))[0];
    let sigma_s = f64::from(sigma_s);
    // Mean of the transmittance to the sphere from a point inside: a table over its distance.
    let direct = |distance: f64| {
        integrate(-1.0, 1.0, 64, |mu| {
            let across = distance * (1.0 - mu * mu).sqrt();
            0.5 * (-sigma_s * ((1.0 - across * across).sqrt() - distance * mu)).exp()
        })
    };
    let table: Vec<f64> = (0..=1000).map(|i| direct(f64::from(i) / 1000.0)).collect();
    let direct = |distance: f64| {
        let place = (distance * 1000.0).min(999.999);
        let (i, part) = (place as usize, place.fract());
        table[i] + part * (table[i + 1] - table[i])
    };
    let expected = (-sigma_s * 2.0 * (1.0 - OFF * OFF).sqrt()).exp()
        + chord(sigma_s, OFF, |distance| {
            let scattered = |x| 1.0 - direct(x);
            direct(distance) + blurred(Kernel::default(), RADIUS, distance, 1.0, scattered)
        });
    let mut figures = Figures::within(0.004);
    figures.add_channels("sampled", estimates, |_| expected);
    figures.check();
}

#[test]
fn the_kth_photon_is_left_out() {
    // From the middle of 6 mean free paths; with ten photons the k-th would add 11 %. A kernel at
    // the boundary loses half at the most, over a radius of 0.05: e^−6 · 6 · 0.05/2 = 0.04 %.
    let view = View::Rays(vec![Ray::new(Vec3::ZERO, Vec3::Z)]);
    let host = AnalyticHost::furnace(medium(0.0, 6.0, 0.0), 1.0, Interface::Matched, view);
    let maps = crate::support::KERNELS.map(|kernel| {
        let map = PhotonMap::new().paths(4000).nearest(10);
        map.kernel(kernel).max_radius(0.3)
    });
    let mut figures = Figures::within(0.006);
    for (map, estimates) in maps
        .iter()
        .zip(estimate(&host, &maps, 200, 60, sensor(&host)))
    {
        figures.add(format!("{map:?}"), estimates[0], 1.0);
    }
    figures.check();
}
