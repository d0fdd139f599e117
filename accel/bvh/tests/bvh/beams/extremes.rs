//! Beams at the ends of what numbers hold, and beyond.

use super::{GRID, SLACK, build, check, check_all, cones, distance, scaled};
use crate::scenes::{PLACES, Places, direction, no_rays, radii};
use glam::Vec3;
use tyndall_bvh::{BeamShape, Beams, BuildError, Piece};
use tyndall_core::{Ray, Sampler};
use tyndall_testkit::rng;

/// Radii as small as the unit in the last place of the coordinates, and smaller.
#[test]
fn thin_beams_far_from_the_origin() {
    let mut random = rng(33);
    let far = Vec3::new(1e4, -1e4, 1e4);
    for radius in [1e-3, 1e-5] {
        let shapes = cones(Places::Uniform, 1000, 1.0, radius, &mut random);
        let shapes = scaled(&shapes, 1.0, far);
        let verdict = check_all(&shapes, 1.0, 200, &mut random);
        assert!(verdict.near > 10, "{radius}: {verdict:?}");
    }
}

/// Places of all magnitudes in one scene.
#[test]
fn radii_and_lengths_over_many_decades() {
    let mut random = rng(34);
    for places in PLACES {
        let mut shapes = cones(places, 1000, 1.0, 1.0, &mut random);
        let lengths = radii(1e3, 12.0, shapes.len(), &mut random);
        let radii = radii(1.0, 12.0, shapes.len(), &mut random);
        for (i, shape) in shapes.iter_mut().enumerate() {
            shape.length = lengths[i];
            shape.radii = [radii[i], 0.1 * radii[i]];
        }
        let verdict = check_all(&shapes, 1.0, 60, &mut random);
        assert!(verdict.near > 200, "{places:?}: {verdict:?}");
    }
}

/// A beam whose radius is its distance to the ray, rounded up, and one a little thinner: near
/// parallel and near perpendicular to the ray, beside its ends, and near to far.
#[test]
fn grazed_beams_are_shown() {
    let mut random = rng(35);
    let mut thinner_shown = 0;
    for i in 0..6000 {
        let along = direction(&mut random);
        let [a, b, c, d] = random.next();
        let side = along.any_orthonormal_vector();
        // The sine of the angle, or its cosine, is of any magnitude.
        let small = 10_f32.powf(-12.0 * a);
        let (x, y) = if i % 2 == 0 {
            (1.0, small)
        } else {
            (small, 1.0)
        };
        let tilted = (x * along + y * side).normalize();
        let away = 10_f32.powf(6.0 * b - 2.0);
        let origin = away * (Vec3::from_array(random.next()) - 0.5);
        let apart = Vec3::from_array(random.next()) - 0.5;
        let ray = Ray::new(origin - away * along, along);
        let ray = match i % 5 {
            0 => ray.up_to(0.0),
            1 => ray.up_to(away),
            _ => ray,
        };
        let shape = BeamShape {
            origin: origin + apart,
            direction: tilted,
            length: 10_f32.powf(4.0 * c - 2.0),
            radii: [0.0; 2],
            limits: BeamShape::UNLIMITED,
        };
        let whole = Piece {
            beam: 0,
            start: 0.0,
            end: shape.length,
        };
        let distance = distance(&ray, &shape, &whole);
        let radius = (distance as f32).next_up();
        let shown = |radius: f32| {
            let beams = build(&[BeamShape {
                radii: [radius; 2],
                limits: BeamShape::UNLIMITED,
                ..shape
            }]);
            let mut shown = 0;
            beams.near(&ray, |_| shown += 1);
            shown
        };
        assert!(shown(radius) > 0, "{d} {distance} {ray:?} {shape:?}");
        let all = (shape.origin - ray.origin).length() + shape.length + radius;
        thinner_shown +=
            shown((radius - 2.0 * GRID as f32 * shape.length - SLACK as f32 * all).max(0.0));
    }
    assert_eq!(thinner_shown, 0);
}

/// As much, for rays that start a thousand lengths away and cross the beam at any angle.
#[test]
fn beams_grazed_from_afar_are_shown() {
    let mut random = rng(46);
    for _ in 0..3000 {
        let [along, across] = [(); 2].map(|()| direction(&mut random));
        let apart = 0.1 * along.cross(across);
        let ray = Ray::new(-1e3 * along, along);
        let shape = BeamShape {
            origin: apart - 0.5 * across,
            direction: across,
            length: 1.0,
            radii: [0.0; 2],
            limits: BeamShape::UNLIMITED,
        };
        let whole = Piece {
            beam: 0,
            start: 0.0,
            end: 1.0,
        };
        let radius = (distance(&ray, &shape, &whole) as f32).next_up();
        let beams = build(&[BeamShape {
            radii: [radius; 2],
            ..shape
        }]);
        let mut shown = 0;
        beams.near(&ray, |_| shown += 1);
        assert_eq!(shown, 1, "{radius} {ray:?} {shape:?}");
    }
}

/// A bundle through one point, from everywhere; and as many beams in one place.
#[test]
fn a_million_at_one_point() {
    const COUNT: usize = 1_000_000;
    let mut random = rng(38);
    let center = Vec3::new(0.1, 0.2, 0.3);
    let through: Vec<_> = (0..COUNT)
        .map(|_| {
            let direction = direction(&mut random);
            BeamShape {
                origin: center - direction,
                direction,
                length: 2.0,
                radii: [1e-4; 2],
                limits: BeamShape::UNLIMITED,
            }
        })
        .collect();
    let same = vec![through[0]; COUNT];
    for shapes in [through, same] {
        let beams = build(&shapes);
        let mut seen = vec![0; COUNT];
        beams.around(center, |piece| seen[piece.beam] += 1);
        assert!(seen.iter().all(|&seen| (1..=8).contains(&seen)));
        let ray = Ray::new(center - 3.0 * Vec3::Z, Vec3::Z);
        let verdict = check(&beams, &ray);
        assert!(verdict.near >= COUNT);
        assert_eq!(check(&beams, &ray.up_to(1.0)).near, 0);
    }
}

/// Radii beyond the scene and down to nothing, lengths up to what is promised.
#[test]
fn places_and_radii_at_the_promised_extremes() {
    let mut random = rng(39);
    let corner = |i| Vec3::from_array([i, i / 2, i / 4].map(|i| (i % 2) as f32)) * 2.0 - 1.0;
    for (place, length, radius) in [
        (4e17, 5e17, 1e18),
        (1e-18, 1e-18, 1e18),
        (1e-20, 1e-20, 1e-22),
        (1e-18, 1e-18, 1e-18),
        (1.0, 1.0, 1e-9),
        (1.0, 1e18, 1e-3),
        (1.0, 1e-30, 1e-30),
    ] {
        let shape = |i| {
            let origin = place * corner(i);
            BeamShape {
                origin: if length > 9e17 { Vec3::ZERO } else { origin },
                direction: direction(&mut random),
                length,
                radii: [radius, 0.5 * radius],
                limits: BeamShape::UNLIMITED,
            }
        };
        let shapes: Vec<_> = (0..200).map(shape).collect();
        check_all(&shapes, length.min(1e3).max(place), 100, &mut random);
        // Rays that start on beams, and points on them.
        let beams = build(&shapes);
        for shape in &shapes {
            let on = Ray::new(shape.origin, direction(&mut random));
            let verdict = check(&beams, &on);
            assert!(verdict.near > 0);
            assert!(check(&beams, &on.up_to(0.0)).near > 0);
            assert!(check(&beams, &Ray::new(shape.origin, shape.direction)).near > 0);
        }
    }
    // So short that its square is 0, and far from the ray.
    let short = build(&[BeamShape {
        origin: Vec3::ZERO,
        direction: Vec3::Y,
        length: 1e-23,
        radii: [1e9; 2],
        limits: BeamShape::UNLIMITED,
    }]);
    let ray = Ray::new(1e8 * Vec3::new(-1.0, 3.0, 5.0), Vec3::X);
    assert_eq!(check(&short, &ray).near, 1);
}

#[test]
fn beams_that_hold_nothing_are_never_met() {
    let shape = |length, radius| BeamShape {
        origin: Vec3::ZERO,
        direction: Vec3::X,
        length,
        radii: [radius; 2],
        limits: BeamShape::UNLIMITED,
    };
    let shapes = [shape(0.0, 1.0), shape(1.0, 0.0)].repeat(9);
    let beams = build(&shapes);
    assert_eq!((beams.pieces().count(), beams.len()), (0, 18));
    beams.near(&Ray::new(Vec3::NEG_Z, Vec3::Z), |_| panic!("met"));
    beams.around(Vec3::ZERO, |_| panic!("met"));
}

#[test]
fn rays_that_are_no_rays_meet_nothing() {
    let mut random = rng(41);
    let shapes = cones(Places::Coincident, 9, 1.0, 1.0, &mut random);
    let beams = build(&shapes);
    for ray in no_rays() {
        beams.near(&ray, |_| panic!("met by {ray:?}"));
    }
}

#[test]
fn bad_beams_are_errors() {
    let good = BeamShape {
        origin: Vec3::ZERO,
        direction: Vec3::X,
        length: 1.0,
        radii: [1.0; 2],
        limits: BeamShape::UNLIMITED,
    };
    let build = |shape| Beams::build(&[good, shape]).map(|_| ());
    let index = 1;
    for origin in [Vec3::NAN, Vec3::NEG_INFINITY, Vec3::new(0.0, 2e18, 0.0)] {
        assert_eq!(
            build(BeamShape { origin, ..good }),
            Err(BuildError::NotFinite { index })
        );
    }
    for direction in [Vec3::NAN, Vec3::ZERO, 1.002 * Vec3::X, 0.998 * Vec3::Y] {
        assert_eq!(
            build(BeamShape { direction, ..good }),
            Err(BuildError::Direction { index })
        );
    }
    for length in [-1.0, f32::NAN, f32::INFINITY, 2e18] {
        assert_eq!(
            build(BeamShape { length, ..good }),
            Err(BuildError::Length { index })
        );
    }
    for bad in [f32::NAN, f32::INFINITY, 2e18, -2e18] {
        for radii in [[bad, 1.0], [1.0, bad]] {
            assert_eq!(
                build(BeamShape { radii, ..good }),
                Err(BuildError::Radius { index })
            );
        }
    }
    for bad in [-1.0, f32::NAN, f32::INFINITY, 2e18] {
        for limits in [[bad, 1.0], [0.0, bad], [1.0, 0.5]] {
            assert_eq!(
                build(BeamShape { limits, ..good }),
                Err(BuildError::Radius { index })
            );
        }
    }
    let error = BuildError::Length { index };
    assert_eq!(
        error.to_string(),
        "primitive 1: its length is negative, not finite or ends beyond 1e18; clip it"
    );
    let long = BeamShape {
        length: 1e18,
        radii: [1e18; 2],
        limits: BeamShape::UNLIMITED,
        direction: 1.0005 * Vec3::X,
        ..good
    };
    assert_eq!(
        build(BeamShape {
            length: 9e17,
            ..long
        }),
        Ok(())
    );
}
