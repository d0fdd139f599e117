//! The same hits as brute force in `f64`, and hence as each other.

use crate::random::Random;
use crate::reference::{Met, nearest};
use crate::scenes::{instances, jumble};
use crate::{BACKENDS, built};
use glam::{DVec3, Vec3};
use tyndall_core::Ray;
use tyndall_surface::{Backend, Shape, Surfaces};

/// Relative agreement of distances.
const TOLERANCE: f64 = 1e-5;

/// A ray displaced by this much of the scene may count as the same ray: where a silhouette is
/// nearer, `f32` cannot tell the sides apart. To that comes the rounding of a quad's corners, whose
/// coordinates are sums.
const DISPLACEMENT: f64 = 1e-6;

struct Case {
    name: &'static str,
    center: Vec3,
    size: f32,
    /// Where rays start, relative to the size of the scene.
    from: f32,
    rays: usize,
    shapes: fn(u64, Vec3, f32) -> Vec<Shape>,
}

#[test]
fn a_million_random_rays_hit_what_brute_force_hits() {
    check(&Case {
        name: "unit",
        center: Vec3::ZERO,
        size: 1.0,
        from: 1.5,
        rays: 1_000_000,
        shapes: jumble,
    });
}

#[test]
fn hits_do_not_depend_on_scale_or_place() {
    let case = |name, center, size, from| Case {
        name,
        center,
        size,
        from,
        rays: 100_000,
        shapes: jumble,
    };
    let far = Vec3::new(1e6, -1e6, 1e6);
    check(&case("tiny", Vec3::ZERO, 1e-3, 1.5));
    check(&case("huge", Vec3::ZERO, 1e6, 1.5));
    check(&case("offset by 1e6", far, 100.0, 1.5));
    check(&case("seen from afar", Vec3::ZERO, 1.0, 1e5));
}

#[test]
fn instances_are_hit_where_brute_force_hits_them() {
    let case = |name, center, size| Case {
        name,
        center,
        size,
        from: 1.5,
        rays: 30_000,
        shapes: instances,
    };
    check(&case("instances", Vec3::ZERO, 1.0));
    check(&case("tiny instances", Vec3::ZERO, 1e-3));
    check(&case("huge instances", Vec3::ZERO, 1e6));
    check(&case("offset instances", Vec3::new(1e3, -1e3, 1e3), 1.0));
}

fn check(case: &Case) {
    let shapes = (case.shapes)(1, case.center, case.size);
    let surfaces: Vec<_> = built(&shapes).collect();
    let mut random = Random::new(2);
    let mut displaced = vec![0; surfaces.len()];
    let mut hits = 0;
    for _ in 0..case.rays {
        let ray = random_ray(case, &mut random);
        let expected = nearest(&shapes, &ray, DVec3::ZERO);
        hits += usize::from(expected.is_some());
        for ((backend, surfaces), displaced) in surfaces.iter().zip(&mut displaced) {
            let found = found(surfaces, &ray);
            if !agree(found, expected) {
                assert!(
                    is_at_a_silhouette(&shapes, &ray, found, case, *backend),
                    "{}, {backend:?}: {ray:?} met {found:?} instead of {expected:?}",
                    case.name
                );
                *displaced += 1;
            }
        }
    }
    assert!(
        hits > case.rays / 10,
        "{}: few rays hit anything",
        case.name
    );
    // A ray passes some silhouette this closely with a probability of about 20 · step / size: 80
    // outlines of length 1.2 size, two sides each, in a cross-section of (3 size)². Those of the
    // instances are twice as long.
    let passes = 40.0 * displacement(case) / f64::from(case.size) * case.rays as f64;
    for (displaced, &backend) in displaced.into_iter().zip(BACKENDS) {
        let name = case.name;
        let bound = 10.0 + passes * steps(backend, &shapes).last().expect("there is a step");
        assert!(
            f64::from(displaced) <= bound,
            "{name}, {backend:?}: {displaced}"
        );
    }
}

fn random_ray(case: &Case, random: &mut Random) -> Ray {
    if case.from < 10.0 {
        return random.ray(case.center, case.from * case.size);
    }
    let origin = case.center + case.from * case.size * random.direction();
    let target = case.center + case.size * random.cube();
    Ray::new(origin, (target - origin).normalize())
}

/// Position and distance must belong to each other.
fn found(surfaces: &Surfaces, ray: &Ray) -> Option<Met> {
    let (t, hit) = surfaces.intersect(ray)?;
    let apart = ray.at(t).distance(surfaces.surface(&hit).position);
    let size = t + ray.origin.length();
    assert!(
        apart <= 1e-5 * size,
        "{ray:?}: {hit:?} is {apart} off at {t}"
    );
    Some((t.into(), hit.shape, hit.primitive))
}

fn agree(a: Option<Met>, b: Option<Met>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some((a, ..)), Some((b, ..))) => (a - b).abs() <= TOLERANCE * b,
        _ => false,
    }
}

fn is_at_a_silhouette(
    shapes: &[Shape],
    ray: &Ray,
    found: Option<Met>,
    case: &Case,
    backend: Backend,
) -> bool {
    let (s, t) = ray.direction.any_orthonormal_pair();
    let name = |met: Option<Met>| met.map(|(_, shape, primitive)| (shape, primitive));
    let steps = steps(backend, shapes);
    let sides = [s, t, -s, -t].map(|side| displacement(case) * side.as_dvec3());
    let mut shifts = steps.iter().flat_map(|&step| sides.map(|side| step * side));
    shifts.any(|shift| name(nearest(shapes, ray, shift)) == name(found))
}

/// How many times the displacement to try. Embree takes rays to instances with an inverse in `f32`.
fn steps(backend: Backend, shapes: &[Shape]) -> &'static [f64] {
    let is_instance = |shape| matches!(shape, &Shape::Instance { .. });
    if backend != Backend::Embedded && shapes.iter().any(is_instance) {
        &[1.0, 4.0, 16.0]
    } else {
        &[1.0]
    }
}

fn displacement(case: &Case) -> f64 {
    let rounding = case.center.abs().max_element() * f32::EPSILON;
    DISPLACEMENT * f64::from(case.size) + f64::from(rounding)
}
