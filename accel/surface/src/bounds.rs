//! Boxes around shapes.

use crate::shape::{Mesh, Shape, quad_corners};
use glam::{DAffine3, DVec3, Vec3};
use std::collections::HashMap;
use std::sync::Arc;
use tyndall_core::Aabb;

/// The smallest box around each shape, up to rounding outwards; for an instance that around the box
/// of its mesh, which is measured once for all of them.
pub(crate) fn boxes(shapes: &[Shape]) -> Vec<Aabb> {
    let mut meshes: HashMap<*const Mesh, Aabb> = HashMap::new();
    let of_shape = |shape: &Shape| match *shape {
        Shape::Mesh(ref mesh) => of_mesh(mesh),
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => {
            let own = meshes.entry(Arc::as_ptr(mesh));
            placed(*own.or_insert_with(|| of_mesh(mesh)), to_world)
        }
        Shape::Sphere { center, radius } => of_sphere(center, radius),
        Shape::Quad {
            corner,
            edge_u,
            edge_v,
        } => Aabb::of_points(quad_corners(corner, edge_u, edge_v)),
        Shape::Disk {
            center,
            normal,
            radius,
        } => of_disk(center, normal, radius),
    };
    shapes.iter().map(of_shape).collect()
}

pub(crate) fn of_sphere(center: Vec3, radius: f32) -> Aabb {
    around(center.as_dvec3(), DVec3::splat(radius.into()))
}

pub(crate) fn of_disk(center: Vec3, normal: Vec3, radius: f32) -> Aabb {
    let n = normal.as_dvec3().normalize();
    let sine = (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt);
    around(center.as_dvec3(), f64::from(radius) * sine)
}

fn of_mesh(mesh: &Mesh) -> Aabb {
    let used = mesh.triangles.iter().flatten();
    Aabb::of_points(used.map(|&i| mesh.positions[i as usize]))
}

/// A box around a box of the mesh.
fn placed(own: Aabb, to_world: &DAffine3) -> Aabb {
    if own.is_empty() {
        return Aabb::EMPTY;
    }
    let [min, max] = [own.min, own.max].map(|p| p.as_dvec3());
    let half = 0.5 * (max - min);
    let reach = to_world.matrix3.abs() * half;
    around(to_world.transform_point3(min + half), reach)
}

fn around(center: DVec3, half: DVec3) -> Aabb {
    Aabb {
        min: (center - half).as_vec3().map(f32::next_down),
        max: (center + half).as_vec3().map(f32::next_up),
    }
}
