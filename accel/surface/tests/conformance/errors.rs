//! What cannot be built, and what is said about it.

use crate::BACKENDS;
use crate::scenes::triangle;
use glam::{DAffine3, Vec2, Vec3};
use std::sync::Arc;
use tyndall_surface::{Mesh, Shape, Surfaces};

fn error(shape: Shape) -> String {
    let good = triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
    for &backend in BACKENDS {
        let built = Surfaces::build(vec![good.clone(), shape.clone()], backend);
        if let Err(error) = built {
            return error.to_string();
        }
    }
    panic!("{shape:?} should not build")
}

fn sphere(center: Vec3, radius: f32) -> Shape {
    Shape::Sphere { center, radius }
}

fn changed(change: impl Fn(&mut Mesh)) -> Shape {
    let mut mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    change(&mut mesh);
    Shape::Mesh(mesh)
}

#[test]
fn faulty_numbers_are_named() {
    let cases = [
        (sphere(Vec3::NAN, 1.0), "shape 1: center 0 is not finite"),
        (sphere(Vec3::ZERO, 0.0), "shape 1: the radius is 0"),
        (sphere(Vec3::ZERO, -1.0), "shape 1: the radius is -1"),
        (sphere(Vec3::ZERO, f32::NAN), "shape 1: radius 0 is not"),
        (
            Shape::Quad {
                corner: Vec3::ZERO,
                edge_u: Vec3::ZERO,
                edge_v: Vec3::X,
            },
            "shape 1: edge_u and edge_v must be",
        ),
        (
            Shape::Disk {
                center: Vec3::ZERO,
                normal: Vec3::ZERO,
                radius: 1.0,
            },
            "shape 1: the normal is zero",
        ),
    ];
    for (shape, message) in cases {
        let error = error(shape);
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn faulty_transformations_are_named() {
    let placed = |linear: [Vec3; 3], translation: Vec3| {
        let Shape::Mesh(mesh) = changed(|_| {}) else {
            unreachable!("changed gives meshes")
        };
        let [x, y, z] = linear.map(|c| c.as_dvec3());
        Shape::Instance {
            mesh: Arc::new(mesh),
            to_world: DAffine3::from_cols(x, y, z, translation.as_dvec3()),
        }
    };
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let cases = [
        (
            placed([x, Vec3::NAN, z], Vec3::ZERO),
            "shape 1: to_world 1 is not finite",
        ),
        (
            placed([x, y, z], Vec3::INFINITY),
            "shape 1: to_world 3 is not finite",
        ),
        (
            placed([x, y, Vec3::ZERO], Vec3::ZERO),
            "shape 1: to_world flattens the mesh (determinant 0e0)",
        ),
        (
            placed([x, y, x - 3.0 * y], Vec3::ZERO),
            "shape 1: to_world flattens the mesh (determinant 0e0)",
        ),
        (
            placed([9e17 * x, 9e17 * x + 9e17 * y, z], 9e17 * x),
            "shape 1: to_world takes the mesh beyond 1e18",
        ),
        (
            placed([x, y, 1e-20 * z], Vec3::ZERO),
            "shape 1: to_world takes the mesh beyond 1e18, or its inverse",
        ),
    ];
    for (shape, message) in cases {
        let error = error(shape);
        assert!(error.starts_with(message), "{error}");
    }
    let Shape::Instance { to_world, .. } = placed([x, y, z], Vec3::ZERO) else {
        unreachable!("placed gives instances")
    };
    let mesh = Arc::new(Mesh {
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    let error = error(Shape::Instance { mesh, to_world });
    assert!(
        error.starts_with("shape 1: triangle 0 refers to"),
        "{error}"
    );
}

#[test]
fn faulty_meshes_are_named() {
    let cases = [
        (
            changed(|m| m.positions[2].y = f32::INFINITY),
            "shape 1: positions 2 is not finite",
        ),
        (changed(|m| m.positions[1].x = 2e18), "shape 1: positions 1"),
        (
            changed(|m| m.triangles[0][1] = 3),
            "shape 1: triangle 0 refers to vertex 3, but there are 3",
        ),
        (
            changed(|m| m.normals = vec![Vec3::Z; 2]),
            "shape 1: 2 normals for 3 vertices",
        ),
        (
            changed(|m| m.uvs = vec![Vec2::NAN; 3]),
            "shape 1: uvs 0 is not finite",
        ),
    ];
    for (shape, message) in cases {
        let error = error(shape);
        assert!(error.starts_with(message), "{error}");
    }
}
