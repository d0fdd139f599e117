//! What no scene should ask for, and some do.

use crate::{photons_at, tree, uniform};
use glam::Vec3;
use tyndall_core::{MediumId, Rgb};
use tyndall_kd_tree::{BuildError, Nearest, Photon, Photons};

fn count(photons: &Photons<Rgb>, center: Vec3, radius: f32) -> usize {
    let mut count = 0;
    photons.within(center, radius, |_, distance_squared| {
        assert!(distance_squared.is_finite());
        count += 1;
    });
    let mut nearest = Nearest::new(usize::MAX);
    photons.nearest(center, radius, |_| true, &mut nearest);
    assert_eq!(nearest.found().len(), count);
    count
}

#[test]
fn a_million_at_one_point() {
    let point = Vec3::new(1.0, 2.0, 3.0);
    let photons = tree(photons_at(&vec![point; 1_000_000], 1));
    assert_eq!(count(&photons, point, 0.0), 1_000_000);
    let mut nearest = Nearest::new(50);
    // A million queries that each met them all would never end.
    for _ in 0..1_000_000 {
        photons.nearest(point, f32::INFINITY, |_| true, &mut nearest);
        assert_eq!(nearest.found().len(), 50);
    }
    assert!(
        photons
            .nearest_radii(30, f32::INFINITY)
            .iter()
            .all(|&r| r == 0.0)
    );
}

#[test]
fn nothing_is_found_nowhere() {
    let photons = tree(photons_at(&uniform(1, 100), 1));
    let [nan, infinity] = [f32::NAN, f32::INFINITY];
    for center in [
        Vec3::NAN,
        Vec3::INFINITY,
        Vec3::NEG_INFINITY,
        Vec3::new(0.5, nan, 0.5),
    ] {
        for radius in [0.0, 1.0, infinity] {
            assert_eq!(count(&photons, center, radius), 0);
        }
    }
    for radius in [nan, -1.0, -infinity, -f32::MIN_POSITIVE] {
        assert_eq!(count(&photons, photons.position(7), radius), 0);
    }
    // Beyond the range of squares.
    assert_eq!(count(&photons, Vec3::splat(f32::MAX), infinity), 0);
    let none = tree(Vec::new());
    assert_eq!(count(&none, Vec3::ZERO, infinity), 0);
    assert!(none.is_empty() && none.nearest_radii(3, 1.0).is_empty());
}

#[test]
fn the_ball_is_closed() {
    let photons = tree(photons_at(&uniform(1, 100), 1));
    assert_eq!(count(&photons, Vec3::ZERO, f32::INFINITY), 100);
    assert_eq!(count(&photons, Vec3::ZERO, f32::MAX), 100);
    assert_eq!(count(&photons, photons.position(7), 0.0), 1);
    let lattice: Vec<Vec3> = (0..10).map(|x| Vec3::X * x as f32).collect();
    let lattice = tree(photons_at(&lattice, 1));
    assert_eq!(count(&lattice, Vec3::ZERO, 3.0), 4);
    assert_eq!(count(&lattice, Vec3::ZERO, 3.0_f32.next_down()), 3);
}

#[test]
fn bounds_of_radii() {
    let photons = tree(photons_at(&uniform(1, 40), 2));
    let all = |k, max_radius, expected| {
        let radii = photons.nearest_radii(k, max_radius);
        assert!(radii.iter().all(|&r| r == expected), "{radii:?}");
    };
    all(0, 5.0, 0.0);
    all(20, 5.0, 5.0);
    all(20, f32::INFINITY, f32::INFINITY);
    all(usize::MAX, 5.0, 5.0);
    all(3, 0.0, 0.0);
    all(3, -1.0, 0.0);
    all(3, f32::NAN, 0.0);
    let last = photons.nearest_radii(19, f32::INFINITY);
    assert!(last.iter().all(|r| (0.3..1.8).contains(r)));
}

#[test]
fn what_cannot_be_stored_is_named() {
    let good = photons_at(&uniform(1, 100), 1);
    let refusal = |change: fn(&mut Photon<Rgb>)| {
        let mut photons = good.clone();
        photons[60..].iter_mut().for_each(change);
        Photons::build(photons).unwrap_err()
    };
    let photon = 60;
    assert_eq!(
        refusal(|p| p.position.y = f32::NAN),
        BuildError::Position { photon }
    );
    assert_eq!(
        refusal(|p| p.position.x = f32::INFINITY),
        BuildError::Position { photon }
    );
    assert_eq!(
        refusal(|p| p.position.z = -1.1e18),
        BuildError::Position { photon }
    );
    assert_eq!(
        refusal(|p| p.flux.0.z = f32::INFINITY),
        BuildError::Flux { photon }
    );
    let length = 0.0;
    assert_eq!(
        refusal(|p| p.direction = Vec3::ZERO),
        BuildError::Direction { photon, length }
    );
    let said = refusal(|p| p.direction = Vec3::NAN).to_string();
    assert!(said.starts_with("photon 60: the direction"), "{said}");
    let said = refusal(|p| p.direction = Vec3::new(0.0, 1.01, 0.0)).to_string();
    assert!(said.contains("length 1.01"), "{said}");
}

#[test]
fn as_many_media_as_fit() {
    let distinct = |len: usize| {
        let mut photons = photons_at(&uniform(1, len), 1);
        for (i, photon) in photons.iter_mut().enumerate() {
            photon.medium = MediumId(u32::MAX - i as u32);
        }
        Photons::build(photons)
    };
    let photons = distinct(65_535).unwrap();
    for slot in 0..photons.len() {
        let index = photons.flux(slot).0.x as u32;
        assert_eq!(photons.medium(slot), MediumId(u32::MAX - index));
    }
    assert_eq!(
        distinct(65_536).unwrap_err(),
        BuildError::TooManyMedia { media: 65_536 }
    );
}
