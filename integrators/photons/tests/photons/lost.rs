//! Light that is not finite.

use super::maps;
use glam::Vec3;
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_testkit::hosts::{AnalyticHost, Light, View};
use tyndall_walk::ByPhotons;

const PATHS: u64 = 2_000;

/// White fog without end, where a path goes on until it has scattered 100,000 times.
fn fog(position: Vec3, power: Rgb) -> AnalyticHost<Homogeneous<Rgb>> {
    let coefficients = Coefficients {
        sigma_a: Rgb::default(),
        sigma_s: Rgb::splat(1.0),
        emission: Rgb::default(),
    };
    let medium = Homogeneous::new(coefficients, Phase::Isotropic).expect("a medium");
    let mut host = AnalyticHost::infinite_medium(medium, Vec3::ZERO, power, View::Rays(vec![]));
    host.light = Light::Point { position, power };
    host
}

#[test]
fn it_is_dropped_and_counted_once_a_path() {
    for (position, power) in [
        (Vec3::ZERO, Rgb::new(1.0, f32::NAN, 1.0)),
        (Vec3::ZERO, Rgb::splat(f32::NAN)),
        (Vec3::ZERO, Rgb::splat(f32::INFINITY)),
        (Vec3::new(0.0, f32::NAN, 0.0), Rgb::splat(1.0)),
    ] {
        let maps = maps::<_, ByPhotons>(&fog(position, power), 0, PATHS);
        assert_eq!(maps.lost, PATHS, "{position} {power:?}");
        assert!(maps.volume.is_empty());
    }
}
