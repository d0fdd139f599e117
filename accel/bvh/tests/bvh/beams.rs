//! Beams.

use crate::scenes::{PLACES, Places, centers, direction, radii, ray};
use glam::{DVec3, Vec3};
use std::collections::HashSet;
use tyndall_bvh::{BeamShape, Beams, BuildError, Piece};
use tyndall_core::{Aabb, Ray, Sampler};
use tyndall_testkit::{TestSampler, rng};

/// Edge of the grid that places are told to, of the size of what is in a leaf.
const GRID: f64 = 1e-3;
/// More than rounding may widen a radius by, of all lengths that play a part.
const SLACK: f64 = 1e-5;
/// What is added to every radius.
const LEAST: f64 = 1.1e-18;

fn build(shapes: &[BeamShape]) -> Beams {
    let beams = Beams::build(shapes).expect("good beams");
    assert_eq!(beams.validate(), Ok(()));
    assert_eq!(beams.len(), shapes.len());
    let mut pieces = sorted(&beams).into_iter().peekable();
    for (index, shape) in shapes.iter().enumerate() {
        assert_eq!(beams.beam(index), shape);
        let mut end = 0.0;
        while let Some(piece) = pieces.next_if(|piece| piece.beam == index) {
            assert_eq!(piece.start, end);
            let [first, last] = [piece.start, piece.end].map(f64::from);
            assert_eq!([first, last].map(|v| piece.holds(v)), [first < last, false]);
            end = piece.end;
        }
        let hollow = shape.radii == [0.0; 2] && shape.limits[0] == 0.0;
        let none = shape.length == 0.0 || hollow || shape.limits[1] == 0.0;
        assert_eq!(end, if none { 0.0 } else { shape.length });
    }
    assert_eq!(pieces.next(), None);
    assert!(beams.pieces().count() <= 16 * shapes.len());
    beams
}

/// All pieces, beam by beam, from their starts to their ends.
fn sorted(beams: &Beams) -> Vec<Piece> {
    let mut pieces: Vec<_> = beams.pieces().collect();
    pieces.sort_by(|a, b| {
        (a.beam.cmp(&b.beam))
            .then(a.start.total_cmp(&b.start))
            .then(a.end.total_cmp(&b.end))
    });
    pieces
}

/// Distance between the ray and a piece: the least of all pairs of places that can be closest.
fn distance(ray: &Ray, shape: &BeamShape, piece: &Piece) -> f64 {
    let [start, end] = [piece.start, piece.end].map(|v| shape.at(f64::from(v)));
    let (d, t_max) = (ray.direction.as_dvec3(), f64::from(ray.t_max));
    let (w, e) = (start - ray.origin.as_dvec3(), end - start);
    let on_ray = |p: DVec3| (p.dot(d) / d.length_squared()).max(0.0).min(t_max);
    let on_piece = |t: f64| ((t * d - w).dot(e) / e.length_squared()).clamp(0.0, 1.0);
    let across = |p: DVec3| p - p.dot(d) / d.length_squared() * d;
    let crossing = -across(e).dot(across(w)) / across(e).length_squared();
    let mut places = vec![0.0, 1.0, on_piece(0.0)];
    if t_max.is_finite() {
        places.push(on_piece(t_max));
    }
    if (0.0..=1.0).contains(&crossing) {
        places.push(crossing);
    }
    let distance = |v: f64| (w + v * e - on_ray(w + v * e) * d).length();
    places
        .into_iter()
        .map(distance)
        .fold(f64::INFINITY, f64::min)
}

/// How many pieces were near for certain, and how many were shown.
#[derive(Clone, Copy, Debug, Default)]
struct Verdict {
    near: usize,
    shown: usize,
}

/// Holds a ray against brute force.
fn check(beams: &Beams, ray: &Ray) -> Verdict {
    let mut shown = HashSet::new();
    beams.near(ray, |piece| {
        let new = shown.insert((piece.beam, piece.start.to_bits(), piece.end.to_bits()));
        assert!(new, "{piece:?} twice");
    });
    let shapes = || (0..beams.len()).map(|beam| beams.beam(beam));
    let ends = shapes().flat_map(|shape| [0.0, shape.length].map(|v| shape.at(f64::from(v))));
    let scene = f64::from(
        Aabb::of_points(ends.map(|end| end.as_vec3()))
            .size()
            .length(),
    );
    let at_ends = |shape: &BeamShape| [0.0, f64::from(shape.length)].map(|v| shape.radius(v));
    let thickest = shapes().flat_map(at_ends).fold(0.0, f64::max);
    let mut verdict = Verdict {
        near: 0,
        shown: shown.len(),
    };
    for piece in beams.pieces() {
        let shape = beams.beam(piece.beam);
        let [start, end] = [piece.start, piece.end].map(f64::from);
        let radius = shape.radius(start).max(shape.radius(end));
        let distance = distance(ray, shape, &piece);
        let shown = shown.remove(&(piece.beam, piece.start.to_bits(), piece.end.to_bits()));
        let context = || format!("{distance} of {radius}, {ray:?}, {shape:?}, {piece:?}");
        if distance <= radius {
            assert!(shown, "missed: {}", context());
            verdict.near += 1;
        } else if shown {
            let away = (shape.origin - ray.origin).as_dvec3().length();
            let most = thickest + GRID * scene + SLACK * (away + scene + thickest) + LEAST;
            assert!(distance <= most, "{}", context());
        }
    }
    assert!(shown.is_empty(), "no such pieces: {shown:?}");
    verdict
}

/// Holds rays near beams against brute force, and points near the same places.
fn check_all(shapes: &[BeamShape], size: f32, rays: usize, random: &mut TestSampler) -> Verdict {
    let target = |shape: &BeamShape| {
        let v = random.next_1d() * shape.length.min(size);
        (shape.at(f64::from(v)).as_vec3(), shape.radii[0])
    };
    let targets: Vec<_> = shapes.iter().map(target).collect();
    let beams = build(shapes);
    let mut sum = Verdict::default();
    for _ in 0..rays {
        let ray = ray(&targets, size, random);
        let verdict = check(&beams, &ray);
        sum.near += verdict.near;
        sum.shown += verdict.shown;
    }
    sum
}

/// Cones with starts in `places`, of up to `length`; one radius in ten is 0, some run through a
/// focus, and some have limits.
fn cones(
    places: Places,
    count: usize,
    length: f32,
    radius: f32,
    random: &mut TestSampler,
) -> Vec<BeamShape> {
    let starts = centers(places, count, random);
    let cone = |origin| {
        let [share, start, end, none] = random.next();
        let [focus, limit, least, most] = random.next();
        let end = if focus < 0.2 { -end } else { end };
        let radii = [start, end].map(|x| radius * x);
        let limits = [0.5 * least, 0.5 + 0.5 * most].map(|x| radius * x);
        BeamShape {
            origin,
            direction: direction(random),
            length: length * share,
            radii: if none < 0.1 { [0.0, radii[1]] } else { radii },
            limits: if limit < 0.2 {
                limits
            } else {
                BeamShape::UNLIMITED
            },
        }
    };
    starts.into_iter().map(cone).collect()
}

fn scaled(shapes: &[BeamShape], scale: f32, offset: Vec3) -> Vec<BeamShape> {
    let scaled = |shape: &BeamShape| BeamShape {
        origin: scale * shape.origin + offset,
        direction: shape.direction,
        length: scale * shape.length,
        radii: shape.radii.map(|r| scale * r),
        limits: shape.limits.map(|r| (scale * r).min(1e18)),
    };
    shapes.iter().map(scaled).collect()
}

#[test]
fn few_and_many_in_all_places() {
    let mut random = rng(31);
    for count in [0, 1, 2, 8, 9, 63, 64, 65, 513, 2000] {
        for places in PLACES {
            let shapes = cones(places, count, 1.0, 0.05, &mut random);
            let verdict = check_all(&shapes, 1.0, 40, &mut random);
            assert!(count < 8 || verdict.near > 0, "{places:?} {count}");
        }
    }
}

#[test]
fn scenes_of_any_scale() {
    let mut random = rng(32);
    for scale in [1.0, 1e-12, 1e-8, 1e8, 1e16] {
        let shapes = cones(Places::Uniform, 1000, 1.0, 0.03, &mut random);
        let shapes = scaled(&shapes, scale, Vec3::ZERO);
        let verdict = check_all(&shapes, scale, 60, &mut random);
        assert!(verdict.near > 150, "{scale}: {verdict:?}");
        assert!(
            verdict.shown as f64 <= 1.1 * verdict.near as f64,
            "{scale}: {verdict:?}"
        );
    }
}

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

/// Each beam that a ray crosses is met once by who asks for the place of crossing, and points on
/// beams are in one piece.
#[test]
fn every_place_is_met_once() {
    let mut random = rng(36);
    let shapes = cones(Places::Uniform, 2000, 2.0, 0.02, &mut random);
    let beams = build(&shapes);
    assert!(beams.pieces().count() > 3 * beams.len());
    let mut met = 0;
    for (beam, shape) in shapes.iter().enumerate() {
        let v = f64::from(random.next_1d() * shape.length);
        let target = shape.at(v).as_vec3();
        let ray = Ray::new(target - direction(&mut random), direction(&mut random));
        let across = Ray::new(
            target - shape.direction.any_orthonormal_vector(),
            shape.direction.any_orthonormal_vector(),
        );
        for ray in [ray, across] {
            let mut seen = vec![0; beams.len()];
            beams.near(&ray, |piece| {
                let v = crossing(&ray, beams.beam(piece.beam));
                seen[piece.beam] += usize::from(v.is_some_and(|v| piece.holds(v)));
            });
            for (shape, seen) in shapes.iter().zip(seen) {
                assert_eq!(seen, usize::from(crossing(&ray, shape).is_some()));
                met += seen;
            }
        }
        let mut pieces = 0;
        beams.around(target, |piece| {
            pieces += usize::from(piece.beam == beam && piece.holds(v))
        });
        assert_eq!(pieces, usize::from(shape.radius(v) > 1e-6));
    }
    assert!(met > 10 * beams.len(), "{met}");
}

/// Where on the beam it is closest to the ray, if they are closer than the radius there.
fn crossing(ray: &Ray, shape: &BeamShape) -> Option<f64> {
    let (d, e) = (ray.direction.as_dvec3(), shape.direction.as_dvec3());
    let w = shape.origin.as_dvec3() - ray.origin.as_dvec3();
    let (c, sin2) = (d.dot(e), d.cross(e).length_squared());
    let [t, v] = [d.dot(w) - c * e.dot(w), c * d.dot(w) - e.dot(w)].map(|x| x / sin2);
    let on_both = t >= 0.0 && (0.0..f64::from(shape.length)).contains(&v);
    (on_both && (w + v * e - t * d).length() < shape.radius(v)).then_some(v)
}

/// Little is shown in vain: what the grid of a leaf adds to radii. Half the diagonal of a cell is up to
/// 8.5e-4 of a leaf, whose pieces fill a tenth of the scene or two: up to 2 % of a radius of 0.01.
#[test]
fn few_are_shown_that_are_not_near() {
    let mut random = rng(37);
    let mut shapes = cones(Places::Uniform, 10_000, 0.3, 1.0, &mut random);
    for shape in &mut shapes {
        (shape.length, shape.radii) = (0.3, [0.01; 2]);
        shape.limits = BeamShape::UNLIMITED;
    }
    let verdict = check_all(&shapes, 1.0, 40, &mut random);
    assert!(verdict.near > 500, "{verdict:?}");
    assert!(
        verdict.shown as f64 <= 1.02 * verdict.near as f64,
        "{verdict:?}"
    );
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

/// One beam much longer than the scene leaves the others as they are. Where it is itself is known
/// to so many digits of its length: every ray is shown a piece of it.
#[test]
fn one_long_beam_among_short_ones() {
    let mut random = rng(40);
    let mut shapes = cones(Places::Uniform, 2000, 0.3, 0.01, &mut random);
    shapes[7] = BeamShape {
        origin: Vec3::splat(-0.3),
        direction: Vec3::new(0.48, 0.6, 0.64),
        length: 1e18,
        radii: [1e-3; 2],
        limits: BeamShape::UNLIMITED,
    };
    let verdict = check_all(&shapes, 1.0, 100, &mut random);
    assert!(verdict.near > 100, "{verdict:?}");
    assert!(verdict.shown <= verdict.near + 100, "{verdict:?}");
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
    for ray in [
        Ray::new(Vec3::NAN, Vec3::Z),
        Ray::new(Vec3::ZERO, Vec3::NAN),
        Ray::new(Vec3::INFINITY, Vec3::Z),
        Ray::new(Vec3::ZERO, Vec3::Z).up_to(f32::NAN),
        Ray::new(Vec3::ZERO, Vec3::Z).up_to(-1.0),
    ] {
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

/// A bundle along an axis is parted without a cut, and so are beams as fat as the scene; of others,
/// the longer have the more pieces.
#[test]
fn long_beams_are_cut_and_fat_ones_are_not() {
    let mut random = rng(45);
    let mut mean = |length: f32, radius: f32, along: Option<Vec3>| {
        let beam = |_| BeamShape {
            origin: Vec3::from_array(random.next()),
            direction: along.unwrap_or_else(|| direction(&mut random)),
            length,
            radii: [radius; 2],
            limits: BeamShape::UNLIMITED,
        };
        let shapes: Vec<_> = (0..2000).map(beam).collect();
        build(&shapes).pieces().count() as f64 / 2000.0
    };
    let [short, long] = [0.2, 1.0].map(|length| mean(length, 1e-3, None));
    assert!(1.5 * short < long, "{short}, {long}");
    assert_eq!(mean(100.0, 1e-3, Some(Vec3::Y)), 1.0);
    assert_eq!(mean(1.0, 100.0, None), 1.0);
}

#[test]
fn the_same_on_any_number_of_threads() {
    let mut random = rng(42);
    let shapes = cones(Places::Clustered, 30_000, 0.5, 0.01, &mut random);
    let [one, two, five] = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let beams = pool.expect("threads").install(|| Beams::build(&shapes));
        let beams = beams.expect("good beams");
        let mut random = rng(43);
        let mut seen = Vec::new();
        for _ in 0..50 {
            let ray = ray(&[(shapes[0].origin, 0.1)], 1.0, &mut random);
            beams.near(&ray, |piece| seen.push(piece));
        }
        assert!(seen.len() > 100);
        seen
    });
    assert!(one == two && one == five);
}

#[test]
fn memory_a_beam_and_a_piece() {
    let mut random = rng(44);
    let count = 100_000;
    let shapes = cones(Places::Uniform, count, 1.0, 1e-3, &mut random);
    let beams = Beams::build(&shapes).expect("good beams");
    let of_pieces = beams.bytes() - 44 * count;
    let each = of_pieces as f64 / beams.pieces().count() as f64;
    // 28 a piece, and what leaves, their last blocks and nodes take.
    assert!((28.0..36.0).contains(&each), "{each}");
    let none = build(&[]);
    assert!(none.is_empty() && none.bytes() == 0);
}
