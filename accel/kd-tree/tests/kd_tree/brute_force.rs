//! Queries against all distances in double precision.

use crate::{photons_at, tree, uniform};
use glam::Vec3;
use tyndall_core::{Aabb, Rgb};
use tyndall_kd_tree::{Nearest, Photons};

/// Squares of `f32` differences have relative errors of a few 2⁻²⁴.
const ROUNDING: f64 = 1e-6;

type Shape = fn(Vec3) -> Vec3;

/// Ways to lie in the unit cube.
const SHAPES: [(&str, Shape); 5] = [
    ("uniform", |p| p),
    ("clustered", |p| p * p * p * p * p),
    ("collinear", |p| Vec3::splat(p.x)),
    ("coplanar", |p| Vec3::new(p.x, 0.25, p.z)),
    ("coincident", |p| (3.0 * p).floor() / 3.0),
];

fn distance(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().distance(b.as_dvec3())
}

/// Distances of all photons from `center`, ascending.
fn distances(photons: &Photons<Rgb>, center: Vec3) -> Vec<f64> {
    let mut distances: Vec<f64> = (0..photons.len())
        .map(|slot| distance(photons.position(slot), center))
        .collect();
    distances.sort_by(f64::total_cmp);
    distances
}

fn check_within(photons: &Photons<Rgb>, center: Vec3, radius: f32) {
    let mut times = vec![0; photons.len()];
    photons.within(center, radius, |slot, distance_squared| {
        times[slot] += 1;
        let exact = distance(photons.position(slot), center);
        let found = f64::from(distance_squared).sqrt();
        assert!((found - exact).abs() <= ROUNDING * exact);
    });
    for (slot, &times) in times.iter().enumerate() {
        let exact = distance(photons.position(slot), center);
        let margin = ROUNDING * exact;
        if exact < f64::from(radius) - margin {
            assert_eq!(times, 1, "{exact} of {radius}");
        } else if exact > f64::from(radius) + margin {
            assert_eq!(times, 0, "{exact} of {radius}");
        } else {
            assert!(times <= 1);
        }
    }
}

fn check_nearest(photons: &Photons<Rgb>, center: Vec3, radius: f32, nearest: &mut Nearest) {
    photons.nearest(center, radius, nearest);
    let found = nearest.found();
    let mut slots: Vec<u32> = found.iter().map(|n| n.slot).collect();
    slots.sort_unstable();
    slots.dedup();
    assert_eq!(slots.len(), found.len(), "a photon was found twice");
    let mut squared: Vec<f32> = found.iter().map(|n| n.distance_squared).collect();
    squared.sort_by(f32::total_cmp);
    assert_eq!(
        nearest.farthest().map(|n| n.distance_squared),
        squared.last().copied()
    );
    let mut expected = distances(photons, center);
    expected.retain(|&d| d <= f64::from(radius));
    expected.truncate(nearest.k());
    // One more or less may lie on the boundary.
    let clear = expected
        .iter()
        .filter(|&&d| d < f64::from(radius) * (1.0 - ROUNDING));
    assert!(squared.len() >= clear.count() && squared.len() <= expected.len() + 1);
    for (found, expected) in squared.iter().zip(expected) {
        assert!((f64::from(*found).sqrt() - expected).abs() <= ROUNDING * expected);
    }
    for neighbour in found {
        let exact = distance(photons.position(neighbour.slot as usize), center);
        let found = f64::from(neighbour.distance_squared).sqrt();
        assert!((found - exact).abs() <= ROUNDING * exact);
    }
}

fn check_radii(photons: &Photons<Rgb>, k: usize, max_radius: f32) {
    let radii = photons.nearest_radii(k, max_radius);
    assert_eq!(radii.len(), photons.len());
    let all = Aabb::of_points((0..photons.len()).map(|slot| photons.position(slot)));
    let lonely = if max_radius == f32::INFINITY {
        all.size().length()
    } else {
        max_radius
    };
    for (slot, radius) in radii.into_iter().enumerate() {
        // The first is the photon itself.
        let distances = distances(photons, photons.position(slot));
        let expected = match k {
            0 => 0.0,
            _ => distances
                .get(k)
                .map_or(lonely, |&d| max_radius.min(d as f32)),
        };
        let exact = radius == expected;
        assert!(
            exact || (radius - expected).abs() <= 1e-6 * expected,
            "{radius} {expected}"
        );
    }
}

/// All queries on a scene of one size.
fn check(positions: &[Vec3], scale: f32, origin: Vec3) {
    let positions: Vec<Vec3> = positions.iter().map(|&p| origin + scale * p).collect();
    let photons = tree(&photons_at(&positions));
    let mut nearest = [0, 1, 7, 50, 3000].map(Nearest::new);
    let outside = origin + scale * Vec3::new(1.5, -0.5, 0.5);
    let centers = uniform(99, 4).into_iter().map(|p| origin + scale * p);
    for center in centers.chain(positions.first().copied()).chain([outside]) {
        for radius in [0.0, 0.05, 0.3, 2.0].map(|r| r * scale) {
            check_within(&photons, center, radius);
            for nearest in &mut nearest {
                check_nearest(&photons, center, radius, nearest);
            }
        }
        nearest
            .iter_mut()
            .for_each(|n| check_nearest(&photons, center, f32::INFINITY, n));
    }
    for (k, max_radius) in [(0, 1.0), (1, f32::INFINITY), (30, 0.2), (30, f32::INFINITY)] {
        check_radii(&photons, k, max_radius * scale);
    }
}

#[test]
fn any_shape_at_any_scale() {
    for (name, shape) in SHAPES {
        let positions: Vec<Vec3> = uniform(1, 1000).into_iter().map(shape).collect();
        for scale in [1e-12, 1e-8, 1.0, 1e8, 1e17] {
            println!("{name} at {scale}");
            check(&positions, scale, Vec3::ZERO);
        }
    }
}

#[test]
fn any_number() {
    for len in [
        0, 1, 2, 3, 4, 5, 15, 16, 17, 31, 32, 33, 64, 65, 127, 129, 257, 1025, 2047,
    ] {
        println!("{len} photons");
        check(&uniform(len as u64, len), 1.0, Vec3::ZERO);
    }
}

#[test]
fn far_from_the_origin() {
    // Positions are rounded to 2⁻⁷ there: many coincide along some axis.
    check(&uniform(2, 1000), 1.0, Vec3::new(1e5, -1e5, 1e5));
    check(&uniform(3, 1000), 1e3, Vec3::splat(1e5));
}

/// Random scenes: sizes and thin slabs.
#[test]
fn random_scenes() {
    for seed in 0..30 {
        let shape = uniform(1000 + seed, 1)[0];
        let len = (400.0 * shape.x) as usize;
        let thin = Vec3::new(1.0, shape.y.powi(8), shape.z.powi(4));
        let positions: Vec<Vec3> = uniform(seed, len).into_iter().map(|p| p * thin).collect();
        check(&positions, 1.0, Vec3::ZERO);
    }
}
