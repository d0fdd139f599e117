//! Beams.

mod extremes;

use crate::scenes::{PLACES, Places, centers, direction, ray};
use glam::{DVec3, Vec3};
use std::collections::HashSet;
use tyndall_bvh::{BeamShape, Beams, Piece};
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
