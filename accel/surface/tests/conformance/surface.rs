//! Positions, normals and texture coordinates of hits.

use crate::built;
use crate::random::Random;
use glam::{Vec2, Vec3};
use tyndall_core::Ray;
use tyndall_surface::{Mesh, Shape, ShapeHit};

fn assert_close(a: Vec3, b: Vec3, what: &str) {
    assert!(a.distance(b) < 1e-6, "{what}: {a}, not {b}");
}

#[test]
fn geometric_normals_follow_the_orientation_of_the_shape() {
    let shapes = [
        crate::scenes::triangle([Vec3::ZERO, Vec3::X, Vec3::Y]),
        Shape::Quad {
            corner: Vec3::new(0.0, 0.0, 2.0),
            edge_u: Vec3::Y,
            edge_v: Vec3::X,
        },
        Shape::Disk {
            center: Vec3::new(0.0, 0.0, 4.0),
            normal: Vec3::Z * -3.0,
            radius: 1.0,
        },
        Shape::Sphere {
            center: Vec3::new(0.0, 0.0, 6.0),
            radius: 1.0,
        },
    ];
    let [x, y] = [0.25, 0.25];
    let on_ball = Vec3::new(x, y, -(1.0 - x * x - y * y).sqrt());
    let expected = [Vec3::Z, -Vec3::Z, -Vec3::Z, on_ball];
    for (backend, surfaces) in built(&shapes) {
        for (i, normal) in expected.into_iter().enumerate() {
            let start = Vec3::new(x, y, 2.0 * i as f32 - 1.0);
            let ray = Ray::new(start, Vec3::Z);
            let (t, hit) = surfaces.intersect(&ray).expect("the ray aims at a shape");
            let surface = surfaces.surface(&hit);
            let name = format!("{backend:?}, shape {i}");
            assert_close(surface.geometric_normal, normal, &name);
            assert_close(surface.shading_normal, normal, &name);
            assert_close(surface.position, ray.at(t), &name);
        }
    }
}

#[test]
fn attributes_are_interpolated_and_shading_keeps_the_side() {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![-Vec3::Z, Vec3::new(-1.0, 0.0, -1.0), Vec3::ZERO],
        uvs: vec![Vec2::ZERO, Vec2::new(2.0, 0.0), Vec2::new(0.0, 4.0)],
        triangles: vec![[0, 1, 2]],
    };
    for (_, surfaces) in built(&[Shape::Mesh(mesh.clone())]) {
        let hit = |u, v| ShapeHit {
            shape: 0,
            primitive: 0,
            uv: Vec2::new(u, v),
        };
        let shading = |u, v| surfaces.surface(&hit(u, v)).shading_normal;
        assert_close(shading(0.0, 0.0), Vec3::Z, "turned to the geometric side");
        let halfway = Vec3::new(0.5, 0.0, 1.0).normalize();
        assert_close(shading(0.5, 0.0), halfway, "interpolated");
        assert_close(shading(0.0, 1.0), Vec3::Z, "no normal: the geometric one");
        assert_eq!(surfaces.uv(&hit(0.25, 0.5)), Vec2::new(0.5, 2.0));
    }
}

/// Directions survive the map of the sphere's `uv` in every octant and at its seams.
#[test]
fn sphere_hits_keep_their_normal() {
    let ball = Shape::Sphere {
        center: Vec3::new(1e3, 0.0, 0.0),
        radius: 1.0,
    };
    let mut random = Random::new(8);
    let seams = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    for (_, surfaces) in built(std::slice::from_ref(&ball)) {
        let directions = (0..10_000).map(|_| random.direction()).chain(seams);
        for normal in directions {
            let origin = Vec3::new(1e3, 0.0, 0.0) + 2.0 * normal;
            let direction = (Vec3::new(1e3, 0.0, 0.0) - origin).normalize();
            let (_, hit) = surfaces
                .intersect(&Ray::new(origin, direction))
                .expect("the ray aims at the centre");
            let found = surfaces.surface(&hit).geometric_normal;
            assert_close(found, -direction, "normal");
        }
    }
}
