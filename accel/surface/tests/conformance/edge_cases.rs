//! Rays and shapes at the border of what can be met.

use crate::built;
use crate::random::Random;
use crate::scenes::{add_triangle, triangle};
use glam::{DAffine3, Vec3};
use std::sync::Arc;
use tyndall_core::Ray;
use tyndall_surface::{Backend, Mesh, Shape};

fn quad(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Shape {
    Shape::Quad {
        corner,
        edge_u,
        edge_v,
    }
}

#[test]
fn an_empty_scene_meets_nothing() {
    let empty = Shape::Instance {
        mesh: Arc::new(Mesh::default()),
        to_world: DAffine3::IDENTITY,
    };
    let nothing = [vec![], vec![Shape::Mesh(Mesh::default())], vec![empty]];
    for shapes in nothing {
        for (backend, surfaces) in built(&shapes) {
            let ray = Ray::new(Vec3::ONE, Vec3::X);
            assert!(surfaces.intersect(&ray).is_none(), "{backend:?}");
            assert!(!surfaces.occluded(&ray), "{backend:?}");
            assert!(surfaces.bounds().is_empty());
        }
    }
}

#[test]
fn triangles_without_area_are_never_met() {
    let mut random = Random::new(5);
    let mut mesh = Mesh::default();
    for i in 0..1_000 {
        let a = random.cube();
        let (b, c) = match i % 3 {
            0 => (a, a),
            1 => (a, random.cube()),
            _ => (Vec3::new(-a.y, a.x, a.z), Vec3::new(-a.y, a.x, a.z)),
        };
        add_triangle(&mut mesh, [a, b, c]);
        // On a line, exactly: small integers.
        let step = (8.0 * random.cube()).round();
        add_triangle(&mut mesh, [step, 3.0 * step, -2.0 * step]);
    }
    for (backend, surfaces) in built(&[Shape::Mesh(mesh.clone())]) {
        for _ in 0..100_000 {
            let origin = 2.0 * random.cube();
            let corners = mesh.triangles[random.index(mesh.triangles.len())];
            let [a, b] = [corners[0], corners[1]].map(|i| mesh.positions[i as usize]);
            let target = a.lerp(b, random.number());
            let ray = Ray::new(origin, (target - origin).normalize());
            let met = surfaces.intersect(&ray);
            assert!(met.is_none(), "{backend:?}: {ray:?} met {met:?}");
            assert!(!surfaces.occluded(&ray), "{backend:?}: {ray:?}");
        }
    }
}

/// Along the axes the plane holds the ray exactly, so that it must miss.
#[test]
fn rays_within_the_plane_of_an_aligned_quad_miss_it() {
    let shapes = [quad(
        Vec3::new(-1.0, -1.0, 0.5),
        2.0 * Vec3::X,
        2.0 * Vec3::Y,
    )];
    let mut random = Random::new(6);
    for (backend, surfaces) in built(&shapes) {
        for _ in 0..100_000 {
            let origin = (3.0 * random.cube()).with_z(0.5);
            let direction = match random.index(3) {
                0 => Vec3::X,
                1 => -Vec3::Y,
                _ => random.cube().with_z(0.0).normalize(),
            };
            let ray = Ray::new(origin, direction);
            let met = surfaces.intersect(&ray);
            assert!(met.is_none(), "{backend:?}: {ray:?} met {met:?}");
            assert!(!surfaces.occluded(&ray), "{backend:?}: {ray:?}");
        }
    }
}

/// In any other plane rounding decides; either way the answer is a point of the quad.
#[test]
fn rays_along_a_slanted_plane_meet_a_point_of_the_quad_or_nothing() {
    let mut random = Random::new(7);
    for _ in 0..200 {
        let [corner, u, v] = [random.cube(), random.cube(), random.cube()];
        for (backend, surfaces) in built(&[quad(corner, u, v)]) {
            for _ in 0..500 {
                let mut on_plane =
                    || corner + 3.0 * random.cube().x * u + 3.0 * random.cube().y * v;
                let (origin, target) = (on_plane(), on_plane());
                let ray = Ray::new(origin, (target - origin).normalize());
                let Some((t, hit)) = surfaces.intersect(&ray) else {
                    continue;
                };
                let at = surfaces.surface(&hit).position;
                let apart = ray.at(t).distance(at);
                assert!(t.is_finite() && hit.uv.is_finite(), "{backend:?}: {ray:?}");
                assert!(
                    apart <= 1e-3 * (t + origin.length()),
                    "{backend:?}: {ray:?} met {hit:?} at {t}, {apart} off"
                );
            }
        }
    }
}

#[test]
fn rays_end_at_t_max() {
    let shapes = [
        quad(Vec3::new(-1.0, -1.0, 2.0), 2.0 * Vec3::X, 2.0 * Vec3::Y),
        Shape::Sphere {
            center: Vec3::Z * 10.0,
            radius: 1.0,
        },
        Shape::Disk {
            center: Vec3::X * 5.0,
            normal: Vec3::Z,
            radius: 1.0,
        },
        triangle([Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p - 9.0 * Vec3::X)),
    ];
    let rays = [
        (Ray::new(Vec3::ZERO, Vec3::Z), 2.0),
        (Ray::new(Vec3::Z * 4.0, Vec3::Z), 5.0),
        (Ray::new(Vec3::Z * 9.5, Vec3::Z), 1.5), // from within the sphere
        (Ray::new(Vec3::new(5.0, 0.5, -3.0), Vec3::Z), 3.0),
        (Ray::new(Vec3::new(-8.75, 0.25, -1.0), Vec3::Z), 1.0),
        (Ray::new(Vec3::Z * -1e7, Vec3::Z), 1e7 + 2.0),
    ];
    for (backend, surfaces) in built(&shapes) {
        for (ray, expected) in rays {
            let (t, _) = surfaces.intersect(&ray).expect("the ray aims at a shape");
            assert!((t - expected).abs() <= 1e-6 * expected, "{backend:?}: {t}");
            for (factor, met) in [(0.9999, false), (1.0001, true)] {
                let ray = ray.up_to(factor * expected);
                assert_eq!(
                    surfaces.intersect(&ray).is_some(),
                    met,
                    "{backend:?}: {ray:?}"
                );
                assert_eq!(surfaces.occluded(&ray), met, "{backend:?}: {ray:?}");
            }
        }
    }
}

#[test]
fn coincident_triangles_are_told_apart_by_their_number() {
    let mut mesh = Mesh::default();
    for _ in 0..10_000 {
        add_triangle(&mut mesh, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }
    let ray = Ray::new(Vec3::new(0.25, 0.25, -1.0), Vec3::Z);
    for (backend, surfaces) in built(&[Shape::Mesh(mesh)]) {
        let (t, hit) = surfaces.intersect(&ray).expect("the ray aims at them");
        assert_eq!(t, 1.0, "{backend:?}");
        if backend == Backend::Embedded {
            assert_eq!(hit.primitive, 0);
        }
    }
}

/// Sizes from 1e-12 to 1e12 in one tree, each a level below the next.
#[test]
fn the_tree_holds_shapes_of_all_sizes() {
    let balls: Vec<Shape> = (-40..=40)
        .map(|i| {
            let size = 2_f32.powi(i);
            Shape::Sphere {
                center: Vec3::new(3.0 * size, 0.0, 0.0),
                radius: size,
            }
        })
        .collect();
    for (backend, surfaces) in built(&balls) {
        for (i, ball) in (0..).zip(&balls) {
            let Shape::Sphere { center, radius } = *ball else {
                unreachable!("only spheres are built here")
            };
            let ray = Ray::new(center + 1.5 * radius * Vec3::Z, -Vec3::Z);
            let (t, hit) = surfaces.intersect(&ray).expect("the ray aims at a ball");
            assert_eq!(hit.shape, i, "{backend:?}");
            assert!((t / radius - 0.5).abs() < 1e-5, "{backend:?}: {t}");
        }
    }
}

/// However near a ray starts to a surface, and on it too, it ends, and meets what is ahead of it:
/// to 1e-6, the rounding of a shape of size 1 over a cosine of 0.1.
#[test]
fn rays_may_start_close_to_what_they_meet() {
    let shapes = [
        quad(Vec3::new(-0.5, -0.5, 0.0), Vec3::X, Vec3::Y),
        triangle([
            Vec3::new(-0.5, -0.72, 0.0),
            Vec3::new(0.5, -0.5, 0.0),
            Vec3::new(0.5, 0.9, 0.0),
        ]),
        Shape::Disk {
            center: Vec3::ZERO,
            normal: Vec3::Z,
            radius: 0.5,
        },
        Shape::Sphere {
            center: Vec3::new(0.0, 0.0, 0.5),
            radius: 0.5,
        },
    ];
    let mut random = Random::new(9);
    for shape in shapes {
        for (backend, surfaces) in built(std::slice::from_ref(&shape)) {
            for _ in 0..100 {
                let mut direction = random.direction();
                direction.z = direction.z.abs();
                if direction.z < 0.1 {
                    continue;
                }
                for away in (1..47).map(|i| 10_f32.powi(-i)).chain([0.0]) {
                    let origin = -away * direction;
                    let met = surfaces.intersect(&Ray::new(origin, direction));
                    if away >= 1e-5 {
                        let (t, _) = met.expect("the shape is ahead");
                        let off = (t - away).abs();
                        assert!(off < 1e-6, "{backend:?} {shape:?} from {origin}: {t}");
                    } else if let Some((t, _)) = met {
                        assert!(t >= 0.0, "{backend:?} {shape:?} from {origin}: {t}");
                    }
                }
            }
        }
    }
}
