//! Positions, normals and texture coordinates of hits.

use crate::built;
use crate::random::Random;
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use std::sync::Arc;
use tyndall_core::Ray;
use tyndall_surface::{Mesh, Shape};

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
        let hit = |u, v| surfaces.hit(0, 0, Vec2::new(u, v));
        let shading = |u, v| surfaces.surface(&hit(u, v)).shading_normal;
        assert_close(shading(0.0, 0.0), Vec3::Z, "turned to the geometric side");
        let halfway = Vec3::new(0.5, 0.0, 1.0).normalize();
        assert_close(shading(0.5, 0.0), halfway, "interpolated");
        assert_close(shading(0.0, 1.0), Vec3::Z, "no normal: the geometric one");
        assert_eq!(surfaces.uv(&hit(0.25, 0.5)), Vec2::new(0.5, 2.0));
    }
}

/// Half a unit along u is 3 of x, a quarter along v is 2 of y − z.
#[test]
fn tangents_follow_the_texture_coordinates() {
    let mesh = Mesh {
        positions: vec![
            Vec3::ONE,
            Vec3::new(4.0, 1.0, 1.0),
            Vec3::new(1.0, 3.0, -1.0),
        ],
        uvs: vec![
            Vec2::splat(0.25),
            Vec2::new(0.75, 0.25),
            Vec2::new(0.25, 0.5),
        ],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let linear = DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 3.0));
    let changed = |uvs: [[f32; 2]; 3]| {
        let uvs = uvs.map(Vec2::from).to_vec();
        let uvs = if uvs == [Vec2::ZERO; 3] { vec![] } else { uvs };
        Shape::Mesh(Mesh {
            uvs,
            ..mesh.clone()
        })
    };
    let shapes = [
        Shape::Mesh(mesh.clone()),
        Shape::Instance {
            mesh: Arc::new(mesh.clone()),
            to_world: DAffine3::from_mat3_translation(linear, DVec3::splat(1e5)),
        },
        Shape::Quad {
            corner: Vec3::ONE,
            edge_u: 2.0 * Vec3::X,
            edge_v: Vec3::Y,
        },
        changed([[0.0; 2]; 3]),                          // none at all
        changed([[0.5; 2]; 3]),                          // all in one point
        changed([[0.0, 0.0], [0.1, 0.2], [0.3, 0.6]]),   // on a line, up to rounding
        changed([[0.0, 0.0], [1e-45, 0.0], [0.0, 1.0]]), // steeper than f32 can say
        Shape::Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        },
    ];
    let expected = [
        Some([Vec3::X * 6.0, Vec3::new(0.0, 8.0, -8.0)]),
        Some([Vec3::X * -12.0, Vec3::new(0.0, 8.0, -24.0)]),
        Some([2.0 * Vec3::X, Vec3::Y]),
        None,
        None,
        None,
        None,
        None,
    ];
    for (backend, surfaces) in built(&shapes) {
        for (i, expected) in expected.into_iter().enumerate() {
            let hit = surfaces.sample(i as u32, 0, [0.3, 0.6]);
            let found = surfaces.tangents(&hit);
            assert_eq!(found, expected, "{backend:?}, shape {i}");
        }
    }
}

/// The disc's own axes are its texture coordinates' too.
#[test]
fn tangents_of_a_disc_are_how_its_points_move() {
    let disk = Shape::Disk {
        center: Vec3::ONE,
        normal: Vec3::new(1.0, -2.0, 3.0),
        radius: 2.0,
    };
    for (_, surfaces) in built(&[disk]) {
        let hit = |u, v| surfaces.hit(0, 0, Vec2::new(u, v));
        let at = |u, v| surfaces.surface(&hit(u, v)).position;
        let [s, t] = surfaces.tangents(&hit(0.5, 0.5)).expect("a disc has them");
        assert_close(0.5 * s, at(0.75, 0.5) - at(0.25, 0.5), "along u");
        assert_close(0.5 * t, at(0.5, 0.75) - at(0.5, 0.25), "along v");
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
