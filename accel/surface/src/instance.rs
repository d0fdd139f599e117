//! Meshes placed by an affine transformation.

use crate::shape::Mesh;
use glam::{DAffine3, DMat3, DVec3};
use tyndall_core::Aabb;

/// The most that [`shear`] may be where rays are taken into the space of a mesh: a factor on the
/// rounding there. Instances beyond it are copied.
const STEEPEST: f64 = 16.0;

/// From where on a shear is nothing but the rounding of a transformation that flattens.
const FLAT: f64 = 1e12;

/// What the rounding of a transformation grows by: the product of the lengths of its axes over the
/// volume that they span. One for rotations, scales along the axes of the mesh and reflections,
/// however strong; infinite if the mesh is flattened.
pub(crate) fn shear(to_world: &DAffine3) -> f64 {
    let [a, b, c] = axes(to_world);
    let volume = a.dot(b.cross(c)).abs();
    a.length() * b.length() * c.length() / volume
}

/// Whether the transformation has no inverse, up to rounding.
pub(crate) fn is_flat(to_world: &DAffine3) -> bool {
    let shear = shear(to_world);
    shear.is_nan() || shear > FLAT
}

/// Whether the mesh is stored once for all such instances of it.
pub(crate) fn is_shared(to_world: &DAffine3) -> bool {
    shear(to_world) <= STEEPEST
}

/// What takes normals to the world: areas too, if their vectors are (p1−p0) × (p2−p0).
///
/// It is |det M|·M⁻ᵀ. A reflection thus reverses the winding of a triangle and not its outside, as
/// glTF has it.
pub(crate) fn of_normals(to_world: &DAffine3) -> DMat3 {
    let [a, b, c] = axes(to_world);
    let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b));
    cofactors * a.dot(b.cross(c)).signum()
}

/// The vertices of a triangle in the world.
pub(crate) fn corners(mesh: &Mesh, to_world: &DAffine3, triangle: u32) -> [DVec3; 3] {
    (mesh.corners(triangle)).map(|p| to_world.transform_point3(p.as_dvec3()))
}

/// A box around the corners of a box of the mesh.
pub(crate) fn bounds(of_mesh: Aabb, to_world: &DAffine3) -> Aabb {
    if of_mesh.is_empty() {
        return Aabb::EMPTY;
    }
    let [min, max] = [of_mesh.min, of_mesh.max].map(|p| p.as_dvec3());
    let half = 0.5 * (max - min);
    let [a, b, c] = axes(to_world);
    let reach = a.abs() * half.x + b.abs() * half.y + c.abs() * half.z;
    let center = to_world.transform_point3(min + half);
    Aabb {
        min: (center - reach).as_vec3().map(f32::next_down),
        max: (center + reach).as_vec3().map(f32::next_up),
    }
}

fn axes(to_world: &DAffine3) -> [DVec3; 3] {
    let m = &to_world.matrix3;
    [m.x_axis, m.y_axis, m.z_axis]
}
