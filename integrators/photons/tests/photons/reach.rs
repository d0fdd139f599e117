//! Radii of passes: what options give, and that they do not depend on the paths of a pass.

use super::FALSE_ALARM;
use glam::Vec3;
use tyndall_core::{Aabb, PassError, Sampler, warp};
use tyndall_density::Dimension;
use tyndall_kd_tree::{Nearest, Photon, Photons};
use tyndall_photons::{Emission, Neighbours, Progress, Reach, Search, Share, Start};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, check_means};

/// Of diagonal 3.
const BOUNDS: Aabb = Aabb {
    min: Vec3::ZERO,
    max: Vec3::new(1.0, 2.0, 2.0),
};

fn radius(start: f32) -> Reach {
    Reach {
        start: Start::Radius(start),
        max_radius: None,
    }
}

fn capped(max_radius: f32) -> Reach {
    Reach {
        max_radius: Some(max_radius),
        ..Reach::nearest(30)
    }
}

fn refusal<T: std::fmt::Debug>(result: Result<T, PassError>) -> String {
    match result {
        Err(PassError::Unsupported(why)) => why,
        other => panic!("{other:?}"),
    }
}

#[test]
fn options_out_of_range_are_named() {
    for (name, reach) in [
        ("`on_nearest` is 1;", Reach::nearest(1)),
        ("`on_max_radius` is 0;", capped(0.0)),
        ("`on_max_radius` is NaN;", capped(f32::NAN)),
        ("`on_radius` is 0,", radius(0.0)),
        ("`on_radius` is -1,", radius(-1.0)),
        ("`on_radius` is NaN,", radius(f32::NAN)),
        ("`on_radius` is inf,", radius(f32::INFINITY)),
    ] {
        let why = refusal(reach.in_pass("on_", Dimension::Two, Share::WHOLE, BOUNDS));
        assert!(why.starts_with(name), "{why}");
    }
    let shrunk = Share {
        radius: 0.5,
        ..Share::WHOLE
    };
    let why = refusal(radius(1e-12).in_pass("", Dimension::Two, shrunk, BOUNDS));
    assert!(why.contains("in this pass"), "{why}");
    for (name, starting_paths, alpha) in [
        ("`starting_paths` is 0;", 0, 0.5),
        ("`alpha` is 0;", 1, 0.0),
        ("`alpha` is NaN;", 1, f64::NAN),
        ("`alpha` is 1.1;", 1, 1.1),
    ] {
        let progress = Progress {
            starting_paths,
            alpha: Some(alpha),
        };
        let why = refusal(progress.share(Dimension::Two, Emission::default(), 0));
        assert!(why.starts_with(name), "{why}");
    }
}

#[test]
fn a_cap_is_a_tenth_of_the_scene_unless_it_is_given() {
    let found = |reach: Reach, bounds| {
        let share = Share {
            paths: 1.0,
            radius: 0.5,
        };
        match reach.in_pass("", Dimension::Three, share, bounds) {
            Ok(Search::Nearest(neighbours)) => neighbours.max_radius,
            other => panic!("{other:?}"),
        }
    };
    let infinite = Aabb {
        min: Vec3::NEG_INFINITY,
        max: Vec3::INFINITY,
    };
    let point = Aabb::of_points([Vec3::ONE]);
    assert!((found(Reach::nearest(9), BOUNDS) - 0.15).abs() < 1e-7);
    for boundless in [Aabb::EMPTY, infinite, point] {
        assert_eq!(found(Reach::nearest(9), boundless), f32::INFINITY);
    }
    assert_eq!(found(capped(8.0), BOUNDS), 4.0);
    assert_eq!(found(capped(f32::INFINITY), BOUNDS), f32::INFINITY);
}

#[test]
fn a_pass_has_its_share_of_photons_and_of_the_radius() {
    let progress = Progress {
        starting_paths: 1_000,
        alpha: Some(0.4),
    };
    let emission = Emission {
        paths: 100,
        ..Emission::default()
    };
    let share = progress.share(Dimension::Three, emission, 70).expect("one");
    assert_eq!(share.paths, 0.1);
    // r³ = (1 + n/n₀)^−0.6, of the middle of paths 7,000 to 7,100.
    let expected = (1.0 + 7.05_f64).powf(-0.2);
    assert!((f64::from(share.radius) / expected - 1.0).abs() < 1e-5);
    let search = Reach::nearest(40).in_pass("", Dimension::Three, share, BOUNDS);
    let Ok(Search::Nearest(neighbours)) = search else {
        panic!("{search:?}");
    };
    let expected = 4.0 * expected.powi(3);
    assert!((neighbours.photons / expected - 1.0).abs() < 1e-5);
}

/// `count` photons in the unit ball, or on the unit disc.
fn even(count: usize, dimension: Dimension, seed: u64) -> Photons<f32> {
    let mut sampler = rng(seed);
    let photons = (0..count).map(|_| Photon {
        position: match dimension {
            Dimension::Three => {
                let [u, v, w]: [f32; 3] = sampler.next();
                warp::uniform_sphere([u, v]) * w.cbrt()
            }
            _ => warp::disk(sampler.next()).extend(0.0),
        },
        direction: Vec3::Z,
        flux: 1.0,
    });
    Photons::build(&photons.collect::<Vec<_>>()).expect("photons")
}

/// Radii of 50 photons of 5,000, in passes of 10 to 5,000, and with a cap. Of n photons the
/// distance to the k-th, to the power d, is Beta-distributed, and its mean Π j/(j + 1/d) over j
/// from k to n. With the 16th looked for, or the 10th of 10, that is (k/n)^(1/d) to a few per cent.
#[test]
fn expected_radii_do_not_depend_on_the_paths_of_a_pass() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let x = 1.0 / f64::from(dimension.number());
        let start = 0.01_f64.powf(x);
        let mut figures = Vec::new();
        for (photons, k) in [(10, 10), (20, 16), (200, 16), (5_000, 50)] {
            let nearest = (k..=photons).map(|j| f64::from(j) / (f64::from(j) + x));
            let part = (0.01 * f64::from(photons) / f64::from(k)).powf(x);
            let expected = part * nearest.product::<f64>();
            assert!((expected / start - 1.0).abs() < 0.05);
            for (cap, expected) in [(f64::INFINITY, expected), (0.5 * start, 0.5 * start)] {
                let search = Search::Nearest(Neighbours {
                    photons: 0.01 * f64::from(photons),
                    dimension,
                    max_radius: cap as f32,
                });
                let radii = radii(search, photons as usize, dimension).estimate();
                let noise = radii.relative_standard_error();
                assert!(noise < 0.01, "{photons} photons: {noise} is too noisy");
                let name = format!("{dimension:?}, {photons} photons, cap {cap}");
                figures.push((name, radii, expected));
            }
        }
        let cases = figures.iter().map(|(n, e, x)| (n.as_str(), *e, *x));
        check_means(&cases.collect::<Vec<_>>(), FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
    }
}

/// Radii at the middle of so many photons, wherever one lies within: whether it does is independent
/// of how far the last one is.
fn radii(search: Search, photons: usize, dimension: Dimension) -> Moments {
    let (mut radii, mut room) = (Moments::new(), Nearest::new(0));
    for seed in 0..(300_000 / photons as u64).min(6_000) {
        let mut radius = None;
        let photons = even(photons, dimension, seed);
        search.visit(&photons, Vec3::ZERO, &mut room, |_, _, r| radius = Some(r));
        if let Some(radius) = radius {
            radii.push(radius.into());
        }
    }
    radii
}
