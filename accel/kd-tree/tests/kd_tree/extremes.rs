//! What no scene should ask for, and some do.

use crate::{photons_at, tree, uniform};
use glam::Vec3;
use tyndall_core::{Aabb, Rgb};
use tyndall_kd_tree::{BuildError, Nearest, Photon, Photons};

fn count(photons: &Photons<Rgb>, center: Vec3, radius: f32) -> usize {
    let mut count = 0;
    photons.within(center, radius, |_, distance_squared| {
        assert!(distance_squared.is_finite());
        count += 1;
    });
    let mut nearest = Nearest::new(usize::MAX);
    photons.nearest(center, radius, &mut nearest);
    assert_eq!(nearest.found().len(), count);
    count
}

#[test]
fn a_million_at_one_point() {
    let point = Vec3::new(1.0, 2.0, 3.0);
    let photons = tree(&photons_at(&vec![point; 1_000_000]));
    assert_eq!(count(&photons, point, 0.0), 1_000_000);
    let mut nearest = Nearest::new(50);
    // A million queries that each met them all would never end.
    for _ in 0..1_000_000 {
        photons.nearest(point, f32::INFINITY, &mut nearest);
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
    let photons = tree(&photons_at(&uniform(1, 100)));
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
    let none = tree(&[]);
    assert_eq!(count(&none, Vec3::ZERO, infinity), 0);
    assert!(none.is_empty() && none.nearest_radii(3, 1.0).is_empty());
}

#[test]
fn the_ball_is_closed() {
    let photons = tree(&photons_at(&uniform(1, 100)));
    assert_eq!(count(&photons, Vec3::ZERO, f32::INFINITY), 100);
    assert_eq!(count(&photons, Vec3::ZERO, f32::MAX), 100);
    assert_eq!(count(&photons, photons.position(7), 0.0), 1);
    let lattice: Vec<Vec3> = (0..10).map(|x| Vec3::X * x as f32).collect();
    let lattice = tree(&photons_at(&lattice));
    assert_eq!(count(&lattice, Vec3::ZERO, 3.0), 4);
    assert_eq!(count(&lattice, Vec3::ZERO, 3.0_f32.next_down()), 3);
}

#[test]
fn bounds_of_radii() {
    let positions = uniform(1, 20);
    let photons = tree(&photons_at(&positions));
    let all = |k, max_radius, expected| {
        let radii = photons.nearest_radii(k, max_radius);
        assert!(radii.iter().all(|&r| r == expected), "{radii:?}");
    };
    let diagonal = Aabb::of_points(positions.iter().copied()).size().length();
    all(0, 5.0, 0.0);
    all(20, 0.5, 0.5);
    all(20, f32::INFINITY, diagonal);
    all(usize::MAX, 5.0, 5.0);
    all(usize::MAX, f32::INFINITY, diagonal);
    all(3, 0.0, 0.0);
    all(3, -1.0, 0.0);
    all(3, f32::NAN, 0.0);
    let last = photons.nearest_radii(19, f32::INFINITY);
    for (slot, radius) in last.into_iter().enumerate() {
        let to = |&p: &Vec3| photons.position(slot).distance(p);
        let farthest = positions.iter().map(to).fold(0.0, f32::max);
        assert!((radius - farthest).abs() <= 1e-6 * farthest, "{radius}");
    }
    let alone = tree(&photons_at(&[Vec3::ONE]));
    assert_eq!(alone.nearest_radii(1, f32::INFINITY), [0.0]);
    assert_eq!(alone.nearest_radii(1, 5.0), [5.0]);
}

/// Fewer photons than are asked for must not make every search visit all: 4e10 visits would take
/// minutes.
#[test]
fn too_few_photons_are_no_work() {
    let photons = tree(&photons_at(&uniform(1, 200_000)));
    let radii = photons.nearest_radii(200_000, f32::INFINITY);
    assert!(radii.iter().all(|&r| r == radii[0] && r > 1.7));
}

#[test]
fn the_largest_positions() {
    let corners = (0..8)
        .map(|i| 1e18 * (Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|b| b as f32)) * 2.0 - 1.0));
    let photons = tree(&photons_at(&corners.collect::<Vec<_>>()));
    let mut nearest = Nearest::new(8);
    let mut radii = [2e18, 8_f32.sqrt() * 1e18, 12_f32.sqrt() * 1e18];
    for slot in 0..8 {
        photons.nearest(photons.position(slot), f32::INFINITY, &mut nearest);
        assert_eq!(nearest.found().len(), 8);
        let farthest = nearest.farthest().unwrap().distance_squared.sqrt();
        assert!((farthest / radii[2] - 1.0).abs() < 1e-6);
        // 3 along an edge, 3 across a side, and itself.
        let half_way = 0.5 * (radii[1] + radii[2]);
        assert_eq!(count(&photons, photons.position(slot), half_way), 7);
    }
    for (k, radius) in [3, 6, 7].into_iter().zip(&mut radii) {
        let found = photons.nearest_radii(k, f32::INFINITY);
        assert!(
            found.iter().all(|f| (f / *radius - 1.0).abs() < 1e-6),
            "{found:?}"
        );
    }
    // Any centre up to there sees all; beyond, squares overflow.
    assert_eq!(count(&photons, Vec3::splat(-9e18), f32::INFINITY), 8);
    assert_eq!(count(&photons, Vec3::splat(2e19), f32::INFINITY), 0);
}

#[test]
fn the_smallest_distances() {
    let place = |i: i32| 1e-18 * Vec3::from([i % 9, i / 9 % 9, i / 81].map(|x| x as f32));
    let photons = tree(&photons_at(&(0..729).map(place).collect::<Vec<_>>()));
    let middle = place(4 + 9 * 4 + 81 * 4);
    // Itself, 6 on the axes, 12 on diagonals of sides, 8 on those of cubes.
    for (radius, expected) in [(0.0, 1), (0.9, 1), (1.1, 7), (1.5, 19), (1.8, 27)] {
        assert_eq!(count(&photons, middle, radius * 1e-18), expected);
    }
    for radius in photons.nearest_radii(1, f32::INFINITY) {
        assert!((radius / 1e-18 - 1.0).abs() < 1e-6, "{radius}");
    }
}

#[test]
fn what_cannot_be_stored_is_named() {
    let good = photons_at(&uniform(1, 100));
    let refusal = |change: fn(&mut Photon<Rgb>)| {
        let mut photons = good.clone();
        photons[60..].iter_mut().for_each(change);
        Photons::build(&photons).unwrap_err()
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
