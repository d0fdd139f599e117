//! Shapes to shoot at.

use crate::random::Random;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use tyndall_surface::{Mesh, Shape};

/// Some of everything within the cube of half width `size` around `center`, degenerate triangles
/// included.
pub(crate) fn jumble(seed: u64, center: Vec3, size: f32) -> Vec<Shape> {
    let mut random = Random::new(seed);
    let mut soup = Mesh::default();
    for i in 0..60 {
        let p = center + size * random.cube();
        let mut corner = || p + 0.4 * size * random.cube();
        let (a, b) = (corner(), corner());
        let c = match i % 6 {
            0 => a,                 // two corners in one
            1 => a + 2.0 * (b - a), // a line, up to rounding
            _ => corner(),
        };
        add_triangle(&mut soup, [a, b, c]);
    }
    let mut shapes = vec![Shape::Mesh(soup), Shape::Mesh(Mesh::default())];
    for _ in 0..12 {
        let radius = size * (0.01 + 0.3 * random.number().powi(3));
        let (p, q) = (center + size * random.cube(), center + size * random.cube());
        let (u, v) = (0.4 * size * random.cube(), 0.4 * size * random.cube());
        let normal = random.cube();
        shapes.push(Shape::Sphere { center: p, radius });
        shapes.push(Shape::Quad {
            corner: q,
            edge_u: u,
            edge_v: v,
        });
        shapes.push(Shape::Disk {
            center: center + size * random.cube(),
            normal,
            radius,
        });
    }
    shapes
}

/// One triangle by itself.
pub(crate) fn triangle(corners: [Vec3; 3]) -> Shape {
    let mut mesh = Mesh::default();
    add_triangle(&mut mesh, corners);
    Shape::Mesh(mesh)
}

/// Adds a triangle that shares no vertex.
pub(crate) fn add_triangle(mesh: &mut Mesh, corners: [Vec3; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}

/// A closed bumpy ball of about 10,000 triangles around `center`, outward normals. Seventy-two
/// needles meet at each pole.
pub(crate) fn bumpy_ball(center: Vec3, size: f32) -> Mesh {
    const RINGS: u32 = 72;
    const SECTORS: u32 = 72;
    let mut random = Random::new(7);
    let mut positions = vec![center + size * Vec3::Z];
    for ring in 1..RINGS {
        let (sin, cos) = (PI * ring as f32 / RINGS as f32).sin_cos();
        for sector in 0..SECTORS {
            let (y, x) = (TAU * sector as f32 / SECTORS as f32).sin_cos();
            let radius = size * (0.95 + 0.1 * random.number());
            positions.push(center + radius * Vec3::new(sin * x, sin * y, cos));
        }
    }
    positions.push(center - size * Vec3::Z);
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, sector: u32| match ring {
        0 => 0,
        RINGS => last,
        _ => 1 + (ring - 1) * SECTORS + sector % SECTORS,
    };
    let mut triangles = Vec::new();
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            if ring > 0 {
                triangles.push([a, d, b]);
            }
            if ring < RINGS - 1 {
                triangles.push([a, c, d]);
            }
        }
    }
    Mesh {
        positions,
        triangles,
        ..Mesh::default()
    }
}
