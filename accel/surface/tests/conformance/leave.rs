//! Rays leave surfaces, and connect them, without meeting them again.

use crate::built;
use crate::random::Random;
use crate::scenes::{add_triangle, linear, triangle};
use glam::{DAffine3, Vec3};
use std::sync::Arc;
use tyndall_core::Anchor;
use tyndall_surface::{Mesh, Shape, ShapeHit, Surfaces};

/// Sizes of shapes, and how far from the origin they are.
const PLACES: &[(f32, f32)] = &[
    (1e-3, 0.0),
    (1e-3, 0.1),
    (1.0, 0.0),
    (1.0, 1e3),
    (1e3, 1e6),
    (1e6, 0.0),
    (1e6, 1e6),
];

fn flat_shapes(random: &mut Random, center: Vec3, size: f32) -> Vec<Shape> {
    let mut point = || center + size * random.cube();
    let corners = [point(), point(), point()];
    let [corner, a, b, normal] = [point(), point(), point(), point() - center];
    vec![
        triangle(corners),
        Shape::Quad {
            corner,
            edge_u: a - corner,
            edge_v: b - corner,
        },
        Shape::Disk {
            center,
            normal,
            radius: size,
        },
        instance(random, center, size),
    ]
}

/// A triangle whose own size and place have nothing to do with those in the scene.
fn instance(random: &mut Random, center: Vec3, size: f32) -> Shape {
    let mut mesh = Mesh::default();
    let own = 10_f32.powf(12.0 * random.number() - 6.0);
    let away = random.cube();
    add_triangle(&mut mesh, [(); 3].map(|()| own * (random.cube() + away)));
    let kind = random.index(8);
    let linear = f64::from(size) / f64::from(own) * linear(random, kind);
    Shape::Instance {
        mesh: Arc::new(mesh),
        to_world: DAffine3::from_mat3_translation(linear, center.as_dvec3()),
    }
}

/// For every place and 200 random shapes there: `check(name, surfaces of one shape, random)`.
fn for_each_place(
    shapes: impl Fn(&mut Random, Vec3, f32) -> Vec<Shape>,
    check: impl Fn(&str, &Surfaces, &mut Random),
) {
    let mut random = Random::new(4);
    for &(size, distance) in PLACES {
        for _ in 0..200 {
            let center = distance * random.direction();
            for shape in shapes(&mut random, center, size) {
                for (backend, surfaces) in built(std::slice::from_ref(&shape)) {
                    let name = format!("{backend:?}, {shape:?}");
                    check(&name, &surfaces, &mut random);
                }
            }
        }
    }
}

/// Half of them close to the tangent plane.
fn direction(random: &mut Random, normal: Vec3) -> Vec3 {
    let any = random.direction();
    match random.number() < 0.5 {
        true => any,
        false => (any - any.dot(normal) * normal * (1.0 - 1e-6 * random.number())).normalize(),
    }
}

/// Sampled by area, or found by a ray.
fn point_on(surfaces: &Surfaces, random: &mut Random) -> ShapeHit {
    let hit = surfaces.sample(0, 0, random.square());
    let surface = surfaces.surface(&hit);
    let towards = direction(random, surface.geometric_normal);
    let away = surfaces.bounds().size().max_element() * random.number() * towards;
    let ray = surfaces.connect(
        &Anchor::Point(surface.position + away),
        &Anchor::Surface(hit),
    );
    let longer = ray.up_to(2.0 * ray.t_max);
    surfaces.intersect(&longer).map_or(hit, |(_, hit)| hit)
}

#[test]
fn a_ray_from_a_flat_shape_never_meets_it() {
    for_each_place(flat_shapes, |name, surfaces, random| {
        for _ in 0..100 {
            let hit = point_on(surfaces, random);
            let surface = surfaces.surface(&hit);
            let normal = surface.geometric_normal;
            let ray = surfaces.spawn(&Anchor::Surface(hit), direction(random, normal));
            let again = surfaces.intersect(&ray);
            assert!(again.is_none(), "{name}: {hit:?}, {ray:?} met {again:?}");
            assert!(!surfaces.occluded(&ray), "{name}: {ray:?}");
        }
    });
}

#[test]
fn a_ray_from_a_sphere_meets_at_most_the_far_side() {
    let ball = |_: &mut Random, center, radius| vec![Shape::Sphere { center, radius }];
    for_each_place(ball, |name, surfaces, random| {
        let Shape::Sphere { center, radius } = *surfaces.shape(0) else {
            unreachable!("only spheres are built here")
        };
        for _ in 0..300 {
            let hit = point_on(surfaces, random);
            let surface = surfaces.surface(&hit);
            let normal = surface.geometric_normal;
            let towards = direction(random, normal);
            let ray = surfaces.spawn(&Anchor::Surface(hit), towards);
            let cosine = towards.dot(normal);
            let again = surfaces.intersect(&ray);
            let slack = ray.origin.distance(surface.position) + 1e-6 * (radius + center.length());
            match again {
                None => assert!(
                    cosine >= 0.0,
                    "{name}: {ray:?} from {hit:?} left the sphere"
                ),
                Some((t, _)) => {
                    assert!(cosine < 0.0, "{name}: {ray:?} from {hit:?} met it at {t}");
                    let chord = -2.0 * radius * cosine;
                    // A start off by `slack` moves the far end by so much over its cosine, but
                    // no farther than the half chord of a cap of that height.
                    let bound = (2.0 * slack / -cosine).min((8.0 * radius * slack).sqrt());
                    assert!(
                        (t - chord).abs() <= bound + slack,
                        "{name}: {t}, not {chord}"
                    );
                }
            }
        }
    });
}

#[test]
fn a_connection_meets_neither_end() {
    let pairs = |random: &mut Random, center, size| {
        let mut shapes = flat_shapes(random, center, size);
        shapes.push(Shape::Sphere {
            center,
            radius: size,
        });
        shapes
    };
    for_each_place(pairs, |name, surfaces, random| {
        for _ in 0..50 {
            let hit = point_on(surfaces, random);
            let surface = surfaces.surface(&hit);
            let normal = surface.geometric_normal;
            let towards = direction(random, normal);
            let outside = match surfaces.shape(0) {
                Shape::Sphere { .. } => towards * 1_f32.copysign(towards.dot(normal)),
                _ => towards,
            };
            let size = surfaces.bounds().size().max_element();
            let away = size * 10_f32.powf(4.0 * random.number() - 1.0) * outside;
            // A point in the surface to within rounding is on no side of it.
            let precision = match surfaces.shape(0) {
                Shape::Instance { .. } => 1e-4,
                _ => 4e-6,
            };
            let rounding = precision * (away.length() + size + surfaces.bounds().center().length());
            if away.dot(normal).abs() < rounding {
                continue;
            }
            let ends = [Anchor::Point(surface.position + away), Anchor::Surface(hit)];
            for (from, to) in [(ends[0], ends[1]), (ends[1], ends[0])] {
                let ray = surfaces.connect(&from, &to);
                assert!(ray.direction.is_normalized(), "{name}: {ray:?}");
                let met = surfaces.intersect(&ray);
                assert!(
                    met.is_none(),
                    "{name}: {ray:?} from {from:?} to {to:?} met {met:?}"
                );
                assert!(
                    !surfaces.occluded(&ray),
                    "{name}: {ray:?} from {from:?} to {to:?}"
                );
            }
        }
    });
}
