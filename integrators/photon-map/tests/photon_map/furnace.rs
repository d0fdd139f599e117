//! White furnaces: albedo 1 under a sky of radiance 1. A kernel that reaches out of the medium
//! loses what it spreads there, and how much is known for a fixed radius.

use crate::support::{Figures, KERNELS, blurred, estimate, integrate, medium, tabulated, turned};
use tyndall_core::{MediumId, Rgb, SensorRay, Spectrum};
use tyndall_density::Kernel;
use tyndall_media::Homogeneous;
use tyndall_photon_map::PhotonMap;
use tyndall_testkit::hosts::{AnalyticHost, Interface, View, fresnel};

const RADIUS: f64 = 0.2;
/// Of the ray from the middle of the sphere.
const OFF: f64 = 0.3;

/// No rays of its own.
fn host(medium: Homogeneous<Rgb>, interface: Interface) -> AnalyticHost<Homogeneous<Rgb>> {
    AnalyticHost::furnace(medium, 1.0, interface, View::Rays(Vec::new()))
}

/// Past the middle, from any side.
fn ray(u: &mut dyn FnMut() -> f32) -> SensorRay<Rgb> {
    turned(OFF as f32, -5.0, MediumId::VACUUM, u)
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
    let mut figures = Figures::within(0.03);
    for (sigma_s, g) in [
        (Rgb::new(0.3, 1.5, 4.0), 0.0),
        (Rgb::new(2.0, 3.0, 0.1), -0.6),
        (Rgb::new(0.5, 3.0, 9.0), 0.9),
    ] {
        let medium = medium(Rgb::default(), sigma_s, g);
        let host = host(medium, Interface::Matched);
        let map = PhotonMap::new().paths(4000).radius(RADIUS as f32);
        let estimates = &estimate(&host, &[map], 25, 200, ray)[0];
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
    let host = host(medium, Interface::Dielectric(index));
    let map = PhotonMap::new().paths(4000).radius(RADIUS as f32);
    let estimates = &estimate(&host, &[map], 25, 200, ray)[0];
    let reflectance = f64::from(fresnel((1.0 - OFF * OFF).sqrt() as f32, index).0);
    let (squared, off) = (f64::from(index * index), OFF / f64::from(index));
    let mut figures = Figures::within(0.03);
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
    let white = medium(Rgb::default(), Rgb::splat(sigma_s), 0.0);
    let host = host(white, Interface::Matched);
    let map = PhotonMap::sampling_lights()
        .paths(4000)
        .radius(RADIUS as f32);
    let estimates = &estimate(&host, &[map], 25, 200, ray)[0];
    let sigma_s = f64::from(sigma_s);
    // Mean of the transmittance to the sphere from a point inside.
    let direct = |distance: f64| {
        integrate(-1.0, 1.0, 64, |mu| {
            let across = distance * (1.0 - mu * mu).sqrt();
            0.5 * (-sigma_s * ((1.0 - across * across).sqrt() - distance * mu)).exp()
        })
    };
    let direct = tabulated(0.0, 1.0, 1000, direct);
    let expected = (-sigma_s * 2.0 * (1.0 - OFF * OFF).sqrt()).exp()
        + chord(sigma_s, OFF, |distance| {
            let scattered = |x| 1.0 - direct(x);
            direct(distance) + blurred(Kernel::default(), RADIUS, distance, 1.0, scattered)
        });
    let mut figures = Figures::within(0.03);
    figures.add_channels("sampled", estimates, |_| expected);
    figures.check();
}

#[test]
fn the_kth_photon_is_left_out() {
    // At least 6 mean free paths inside; with ten photons the k-th would add 11 %. A kernel at the
    // boundary loses half at the most, over a radius of 0.07: e^−6 · 10 · 0.07/2 = 0.09 %.
    let host = host(
        medium(Rgb::default(), Rgb::splat(10.0), 0.0),
        Interface::Matched,
    );
    let maps = KERNELS.map(|kernel| PhotonMap::new().paths(2000).nearest(10).kernel(kernel));
    let ray = |u: &mut dyn FnMut() -> f32| {
        let x = 0.4 * u();
        turned(x, 0.0, MediumId(1), u)
    };
    let mut figures = Figures::within(0.03);
    for (kernel, estimates) in KERNELS.iter().zip(estimate(&host, &maps, 60, 60, ray)) {
        figures.add(format!("{kernel:?}"), estimates[0], 1.0);
    }
    figures.check();
}
