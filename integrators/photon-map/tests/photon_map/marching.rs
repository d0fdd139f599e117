//! Marching is unbiased, whatever the steps: light sampled in media that scatter once is exact.

use crate::once::Once;
use crate::support::{Figures, estimate, medium, phase, sensor};
use glam::Vec3;
use tyndall_core::{Aabb, Coefficients, Ray, Rgb, Spectrum};
use tyndall_media::{DenseGrid, GridMedium};
use tyndall_path::{Path, Scattering};
use tyndall_photon_map::{BySampling, PhotonMap};
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, Light, View};
use tyndall_testkit::measure;
use tyndall_testkit::stats::Estimate;

/// Coarse and fine.
const STEPS: [(f32, u32); 4] = [(4.0, 1), (1.0, 1), (0.5, 8), (0.1, 30)];

fn maps() -> Vec<PhotonMap<BySampling>> {
    let map = PhotonMap::sampling_lights().paths(1);
    let steps = STEPS.iter();
    steps
        .map(|(step, least)| map.step(*step).min_steps(*least))
        .collect()
}

#[test]
fn the_airlight_of_a_point_light_in_endless_fog() {
    // One channel is dense, one nearly clear, and one scatters nothing: it would be marched for ever.
    let sigma_s = Rgb::new(1.5, 1e-3, 0.0);
    let sigma_a = Rgb::new(0.5, 1e-3, 0.0);
    let ray = Ray::new(Vec3::new(0.0, 0.6, -2.0), Vec3::Z);
    let host = AnalyticHost::infinite_medium(
        Once(medium(sigma_a, sigma_s, 0.0)),
        Vec3::ZERO,
        Rgb::splat(1.0),
        View::Rays(vec![ray]),
    );
    let mut figures = Figures::within(0.015);
    let estimates = estimate(&host, &maps(), 20, 20_000, sensor(&host));
    for (steps, estimates) in STEPS.iter().zip(estimates) {
        for (channel, estimate) in estimates.into_iter().enumerate().take(2) {
            let [s, a] = [sigma_s, sigma_a].map(|s| f64::from(s.channel(channel)));
            let expected = airlight(s, s + a, 0.6, 2.0, f64::INFINITY);
            figures.add(format!("{steps:?}, channel {channel}"), estimate, expected);
        }
        assert_eq!(estimates_of_nothing(&host), 0.0);
    }
    figures.check();
}

/// The channel that scatters nothing.
fn estimates_of_nothing(host: &AnalyticHost<Once<tyndall_media::Homogeneous<Rgb>>>) -> f64 {
    measure(host, &maps()[0], 3, 1)[2].mean
}

/// Smoke of many densities, and none, in a box.
fn smoke() -> GridMedium<Rgb> {
    let bounds = Aabb {
        min: Vec3::new(-1.0, -1.0, -1.0),
        max: Vec3::new(1.0, 1.0, 1.0),
    };
    let value = |i: usize| match i % 7 {
        0 | 3 => 0.0,
        k => (k * k) as f32 / 12.0,
    };
    let density = DenseGrid::new([9, 9, 9], bounds, (0..729).map(value).collect());
    let coefficients = Coefficients {
        sigma_a: Rgb::new(0.3, 0.1, 0.0),
        sigma_s: Rgb::new(1.0, 0.2, 3.0),
        emission: Rgb::default(),
    };
    GridMedium::new(density.expect("a grid"), coefficients, phase(0.4)).expect("smoke")
}

#[test]
fn smoke_is_what_the_path_tracer_finds() {
    let ray = Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z);
    let mut host = AnalyticHost::infinite_medium(
        Once(smoke()),
        Vec3::ZERO,
        Rgb::default(),
        View::Rays(vec![ray]),
    );
    host.light = Light::Beam {
        center: Vec3::new(0.0, 3.0, -2.0),
        direction: Vec3::new(0.0, -0.8, 0.6),
        radius: 2.0,
        irradiance: Rgb::splat(5.0),
    };
    let path = Path::new().scattering(Scattering::Single);
    let reference = measure(&host, &path, 400_000, 1);
    let mut figures = Figures::within(0.01);
    let estimates = estimate(&host, &maps(), 20, 4000, sensor(&host));
    for (steps, estimates) in STEPS.iter().zip(estimates) {
        for (channel, (marched, path)) in estimates.iter().zip(&reference).enumerate() {
            let difference = marched.difference(path);
            let shifted = Estimate {
                mean: difference.mean + path.mean,
                ..difference
            };
            figures.add(format!("{steps:?}, channel {channel}"), shifted, path.mean);
        }
    }
    figures.check();
}
