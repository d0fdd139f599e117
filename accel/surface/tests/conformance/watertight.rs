//! A closed mesh has no holes, not even along its edges and at its vertices.

use crate::built;
use crate::random::Random;
use crate::scenes::{bumpy_ball, linear};
use glam::{DAffine3, Vec3};
use std::sync::Arc;
use tyndall_core::Ray;
use tyndall_surface::{Backend, Mesh, Shape};

#[test]
fn a_million_rays_do_not_leave_a_closed_mesh() {
    check(Vec3::ZERO, 1.0, 1_000_000);
}

#[test]
fn a_closed_mesh_is_closed_at_any_scale_and_place() {
    check(Vec3::ZERO, 1e-3, 100_000);
    check(Vec3::ZERO, 1e6, 100_000);
    check(Vec3::new(1e6, 1e6, -1e6), 1e3, 100_000);
}

#[test]
fn an_instance_of_a_closed_mesh_is_closed() {
    let mut random = Random::new(22);
    for (center, size) in [
        (Vec3::ZERO, 1.0),
        (Vec3::ZERO, 1e-6),
        (Vec3::splat(1e5), 1e2),
    ] {
        let mesh = bumpy_ball(Vec3::ZERO, 1e3);
        let turned = linear(&mut random, 4) * f64::from(size) * 1e-3;
        let to_world = DAffine3::from_mat3_translation(turned, center.as_dvec3());
        let mut ball = mesh.clone();
        for p in &mut ball.positions {
            *p = to_world.transform_point3(p.as_dvec3()).as_vec3();
        }
        let mesh = Arc::new(mesh);
        check_shape(
            Shape::Instance { mesh, to_world },
            &ball,
            center,
            size,
            100_000,
        );
    }
}

/// Where rays are aimed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    Vertex,
    Edge,
    Anywhere,
}

/// Embree lets 6 of 1,000 rays through a vertex that they are aimed at exactly: its robust test
/// rounds the edges around a vertex independently (its issues 174 and 181). Nothing else may pass,
/// but through instances, where the vertices of needles are close to edges and rays are rounded.
fn tolerated(backend: Backend, aim: Aim, instance: bool) -> f64 {
    match (backend, aim) {
        #[cfg(feature = "embree")]
        (Backend::Embree, Aim::Vertex) => 0.02,
        (other, _) if instance && other != Backend::Embedded => 1e-4,
        _ => 0.0,
    }
}

fn check(center: Vec3, size: f32, rays: usize) {
    let ball = bumpy_ball(center, size);
    assert!((10_000..11_000).contains(&ball.triangles.len()));
    check_shape(Shape::Mesh(ball.clone()), &ball, center, size, rays);
}

/// `ball` is where the triangles of the shape are.
fn check_shape(shape: Shape, ball: &Mesh, center: Vec3, size: f32, rays: usize) {
    let instance = matches!(shape, Shape::Instance { .. });
    for (backend, surfaces) in built(&[shape]) {
        let mut random = Random::new(3);
        for aim in [Aim::Vertex, Aim::Edge, Aim::Anywhere] {
            let mut passed = [0; 2];
            for _ in 0..rays / 3 {
                let origin = center + 0.5 * size * random.cube();
                let target = target(ball, aim, &mut random);
                let direction = target.map_or(random.direction(), |p| (p - origin).normalize());
                let ray = Ray::new(origin, direction);
                passed[1] += u32::from(!surfaces.occluded(&ray));
                let Some((t, hit)) = surfaces.intersect(&ray) else {
                    passed[0] += 1;
                    continue;
                };
                let radius = surfaces.surface(&hit).position.distance(center) / size;
                assert!(
                    (0.94..1.06).contains(&radius),
                    "{backend:?}: {ray:?} met {hit:?}"
                );
                assert!(t > 0.0 && t < 2.0 * size, "{backend:?}: {ray:?} at {t}");
            }
            let share = passed.map(|n| 3.0 * f64::from(n) / rays as f64);
            let bound = tolerated(backend, aim, instance);
            assert!(
                share.iter().all(|&s| s <= bound),
                "{backend:?}, {aim:?}: {share:?} of the rays passed"
            );
        }
    }
}

fn target(mesh: &Mesh, aim: Aim, random: &mut Random) -> Option<Vec3> {
    let corners = mesh.triangles[random.index(mesh.triangles.len())];
    let [a, b] = [corners[0], corners[1]].map(|i| mesh.positions[i as usize]);
    match aim {
        Aim::Vertex => Some(a),
        Aim::Edge => Some(a.lerp(b, random.number())),
        Aim::Anywhere => None,
    }
}
