//! Where numbers run out: every sample is finite ([`measure`] asserts it), and where the answer is
//! known it is right.

use crate::support::{Figures, medium, with_context};
use glam::Vec3;
use tyndall_core::{Integrator, PassError, Ray, Rgb, Spectrum};
use tyndall_media::Homogeneous;
use tyndall_photon_map::{Kernel, PhotonMap};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::stats::Estimate;
use tyndall_testkit::{measure, measure_mean};

/// The chord of a unit sphere through the middle, one that only just touches it, and one from
/// inside.
fn chords(scale: f32) -> View {
    let ray = |x: f32, z: f32| Ray::new(Vec3::new(x, 0.0, z) * scale, Vec3::Z);
    View::Rays(vec![ray(0.0, -2.0), ray(0.999_99, -2.0), ray(0.1, 0.2)])
}

fn furnace(sigma_s: f32, g: f32, scale: f32) -> AnalyticHost<Homogeneous<Rgb>> {
    let medium = medium(
        Rgb::default(),
        Rgb::new(1.0, 0.1, 0.0) * (sigma_s / scale),
        g,
    );
    AnalyticHost::furnace(medium, scale, Interface::Matched, chords(scale))
}

#[test]
fn furnaces_from_empty_to_opaque_of_all_sizes() {
    for sigma_s in [0.0, 1e-12, 1e-6, 1.0, 30.0] {
        for g in [-0.999, 0.0, 0.999] {
            for scale in [1e-8, 1.0, 1e8] {
                let host = furnace(sigma_s, g, scale);
                let map = PhotonMap::new().paths(200).nearest(20);
                let photons = measure(&host, &map, 3, 1);
                let map = PhotonMap::sampling_lights().paths(200).nearest(20);
                let sampled = measure(&host, &map, 3, 1);
                for values in [photons, sampled] {
                    let what = format!("σs = {sigma_s:e}, g = {g}, scale {scale:e}: {values:?}");
                    assert!(
                        values.iter().all(|v| (0.0..50.0).contains(&v.mean)),
                        "{what}"
                    );
                    // The channel of no substance sees the sky.
                    assert!((values[2].mean - 1.0).abs() < 1e-6, "{what}");
                    let thin = sigma_s <= 1e-6;
                    assert!(!thin || (values[0].mean - 1.0).abs() < 1e-4, "{what}");
                }
            }
        }
    }
}

#[test]
fn dense_media() {
    // Light goes no deeper than a few mean free paths, of which 1e6 are across; half of what is
    // scattered once comes back.
    for (sigma_a, sigma_s) in [(1e6, 0.0), (1e6, 1e6), (9e5, 1e5)] {
        let medium = medium(Rgb::splat(sigma_a), Rgb::new(1.0, 0.5, 0.0) * sigma_s, 0.0);
        let host = AnalyticHost::furnace(medium, 1.0, Interface::Matched, chords(1.0));
        let map = PhotonMap::new().paths(2000).nearest(10).max_radius(1e-3);
        for value in measure(&host, &map, 3, 1) {
            assert!((0.0..1.0).contains(&value.mean), "{value:?}");
        }
        let map = PhotonMap::sampling_lights().paths(2000).nearest(10);
        for value in measure(&host, &map, 3, 1) {
            assert!((0.0..1.0).contains(&value.mean), "{value:?}");
        }
    }
}

#[test]
fn a_medium_that_only_absorbs_shows_the_sky_behind() {
    let host = AnalyticHost::furnace(medium(0.7, 0.0, 0.0), 1.0, Interface::Matched, chords(1.0));
    let map = PhotonMap::new().paths(100);
    let value = measure(&host, &map, 3, 1)[0];
    // The host starts rays 1e-5 of the radius behind its surface.
    assert!((value.mean - (-1.4_f64).exp()).abs() < 1e-5, "{value:?}");
}

fn lit(light: Light<f32>) -> AnalyticHost<Homogeneous<f32>> {
    let medium = medium(0.5, 1.0, 0.0);
    AnalyticHost::sphere(medium, 1.0, Interface::Matched, light, chords(1.0))
}

const POINT: Light<f32> = Light::Point {
    position: Vec3::new(0.2, 0.1, 0.0),
    power: 1.0,
};

#[test]
fn few_photons() {
    let black = lit(Light::Point {
        position: Vec3::ZERO,
        power: 0.0,
    });
    let dark = lit(Light::None);
    for host in [&black, &dark] {
        let maps = [PhotonMap::new(), PhotonMap::new().radius(0.1)];
        for map in maps {
            let values = measure(host, &map.paths(100), 3, 1);
            assert!(values.iter().all(|v| v.mean == 0.0), "{values:?}");
        }
    }
    // One path; more neighbours than photons; a cap within which there are none.
    let host = lit(POINT);
    for map in [
        PhotonMap::new().paths(1),
        PhotonMap::new().paths(1).nearest(2),
        PhotonMap::new().paths(1).radius(1e12),
        PhotonMap::new().paths(20).nearest(usize::MAX),
        PhotonMap::new().paths(20).nearest(1000).max_radius(2.0),
    ] {
        let values = measure(&host, &map, 20, 1);
        assert!(values.iter().all(|v| v.mean >= 0.0), "{values:?}");
    }
    let values = measure(&host, &PhotonMap::new().paths(100).max_radius(1e-12), 3, 1);
    assert!(values.iter().all(|v| v.mean == 0.0), "{values:?}");
    let values = measure(&host, &PhotonMap::new().paths(100).radius(1e-12), 3, 1);
    assert!(values.iter().all(|v| v.mean == 0.0), "{values:?}");
}

#[test]
fn all_photons_at_one_point() {
    // A pencil of light into what is opaque: every photon within 1e-6 of the same point.
    let light = Light::Beam {
        center: Vec3::new(0.0, 0.0, -2.0),
        direction: Vec3::Z,
        radius: 1e-9,
        irradiance: 1e18,
    };
    let medium = medium(5e6, 5e6, 0.0);
    let mut host = AnalyticHost::sphere(medium, 1.0, Interface::Matched, light, chords(1.0));
    for kernel in crate::support::KERNELS {
        for map in [
            PhotonMap::new(),
            PhotonMap::new().nearest(5),
            PhotonMap::new().radius(0.1),
        ] {
            let _ = measure(&host, &map.paths(500).kernel(kernel), 3, 1);
        }
    }
    // Nothing but the photons' own point in sight, or a ray that starts there.
    host.view = View::Rays(vec![Ray::new(Vec3::new(0.0, 0.0, -1.0), Vec3::Z)]);
    let _ = measure(&host, &PhotonMap::new().paths(500), 3, 1);
}

#[test]
fn far_from_the_origin_it_is_the_same() {
    let at = |offset: Vec3| {
        let ray = Ray::new(Vec3::new(-0.5, 0.5, 0.0) + offset, Vec3::X);
        let medium = medium(0.5, 1.5, 0.3);
        let host = AnalyticHost::infinite_medium(medium, offset, 1.0, View::Rays(vec![ray; 64]));
        let map = PhotonMap::new().paths(2000).radius(0.25);
        measure_mean(&host, &map, 64, 1)[0]
    };
    let (here, there) = (at(Vec3::ZERO), at(Vec3::new(1e4, -2e4, 1e4)));
    // Positions are rounded to 1e-3 there, of kernels of 0.25.
    let mut figures = Figures::within(0.05);
    let difference = there.difference(&here);
    let shifted = Estimate {
        mean: difference.mean + here.mean,
        ..difference
    };
    figures.add("far away", shifted, here.mean);
    figures.check();
}

#[test]
fn options_that_make_no_sense_are_named() {
    let host = lit(POINT);
    let map = PhotonMap::new;
    for (map, name) in [
        (map().paths(0), "`paths`"),
        (map().nearest(1), "`nearest`"),
        (map().radius(0.0), "`radius`"),
        (map().max_radius(0.0), "`max_radius`"),
        (map().step(0.0), "`step`"),
        (map().step(f32::INFINITY), "`step`"),
        (map().min_steps(0), "`min_steps`"),
    ] {
        let failed = with_context(0, |cx| map.begin_pass(&host, cx, None).err());
        let Some(PassError::Unsupported(why)) = failed else {
            panic!("{map:?}: {failed:?}");
        };
        assert!(why.starts_with(name), "{why}");
    }
    let small = map().max_bytes(100).kernel(Kernel::Biweight);
    let failed = with_context(0, |cx| small.begin_pass(&host, cx, None).err());
    assert!(
        matches!(failed, Some(PassError::Memory { .. })),
        "{failed:?}"
    );
}
