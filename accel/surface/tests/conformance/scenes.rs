//! Shapes to shoot at.

use crate::random::Random;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;
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

/// Half of the shapes of [`jumble`], and a dozen instances of two meshes among them.
pub(crate) fn instances(seed: u64, center: Vec3, size: f32) -> Vec<Shape> {
    let mut random = Random::new(seed);
    let mut shapes = jumble(seed, center, size);
    shapes.truncate(20);
    let meshes = [1e-2_f32, 1e3].map(|own| {
        let mut mesh = Mesh::default();
        for _ in 0..20 {
            let p = random.cube();
            add_triangle(&mut mesh, [(); 3].map(|()| own * (p + 0.5 * random.cube())));
        }
        (own, Arc::new(mesh))
    });
    for kind in 0..24 {
        let (own, mesh) = &meshes[kind % 2];
        let origin = center + size * random.cube();
        let scale = 0.4 * f64::from(size) / f64::from(*own);
        shapes.push(Shape::Instance {
            mesh: mesh.clone(),
            to_world: DAffine3::from_mat3_translation(
                scale * linear(&mut random, kind / 2),
                origin.as_dvec3(),
            ),
        });
    }
    shapes
}

/// In turns a rotation, a strong scale along the axes, a shear, a scale along any axes; then the
/// same with a reflection.
pub(crate) fn linear(random: &mut Random, kind: usize) -> DMat3 {
    let mut rotation = || {
        let axis = random.direction().as_dvec3().normalize();
        DMat3::from_quat(DQuat::from_axis_angle(
            axis,
            6.0 * f64::from(random.number()),
        ))
    };
    let scale = DMat3::from_diagonal(DVec3::new(1.0, 0.05, 0.3));
    let linear = match kind % 4 {
        0 => rotation(),
        1 => rotation() * scale,
        2 => DMat3::from_cols(
            DVec3::X,
            DVec3::new(0.7, 0.8, 0.0),
            DVec3::new(0.3, -0.5, 0.6),
        ),
        _ => rotation() * scale * rotation(),
    };
    let side = if kind % 8 < 4 { 1.0 } else { -1.0 };
    linear * DMat3::from_diagonal(DVec3::new(side, 1.0, 1.0))
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
