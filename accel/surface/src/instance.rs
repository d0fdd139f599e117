//! Meshes placed by an affine transformation.

use crate::shape::{Mesh, Shape};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The most that [`shear`] may be where rays are taken into the space of a mesh: a factor on the
/// rounding there. Instances beyond it are copied.
const STEEPEST: f64 = 16.0;

/// Lengths of the axes between which the determinant and the inverse are within `f32`.
const LENGTHS: RangeInclusive<f64> = 1e-12..=1e12;

/// From where on a shear is nothing but the rounding of a transformation that flattens.
const FLAT: f64 = 1e12;

/// The meshes that instances share, each once.
#[derive(Default)]
pub(crate) struct Shared<'a> {
    pub(crate) meshes: Vec<&'a Mesh>,
    /// For each shape, if it is such an instance: which of `meshes` it places, and where.
    pub(crate) of_shape: Vec<Option<(usize, &'a DAffine3)>>,
}

impl<'a> Shared<'a> {
    pub(crate) fn of(shapes: &'a [Shape]) -> Self {
        let mut shared = Self::default();
        let mut numbers: HashMap<*const Mesh, usize> = HashMap::new();
        for shape in shapes {
            let placed = match shape {
                Shape::Instance { mesh, to_world } if is_shared(to_world) => {
                    let number = *numbers.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
                        shared.meshes.push(mesh);
                        shared.meshes.len() - 1
                    });
                    Some((number, to_world))
                }
                _ => None,
            };
            shared.of_shape.push(placed);
        }
        shared
    }
}

/// What the rounding of a transformation grows by: the product of the lengths of its axes over the
/// volume that they span. One for rotations, scales along the axes of the mesh and reflections,
/// however strong; infinite if the mesh is flattened.
pub(crate) fn shear(to_world: &DAffine3) -> f64 {
    let [a, b, c] = axes(to_world);
    let volume = a.dot(b.cross(c)).abs();
    a.length() * b.length() * c.length() / volume
}

/// Whether a transformation has no inverse, up to rounding: an instance cannot have it.
pub fn is_flat(to_world: &DAffine3) -> bool {
    let shear = shear(to_world);
    shear.is_nan() || shear > FLAT
}

/// Whether the mesh is stored once for all such instances of it.
pub(crate) fn is_shared(to_world: &DAffine3) -> bool {
    let fits = |axis: DVec3| LENGTHS.contains(&axis.length());
    shear(to_world) <= STEEPEST && axes(to_world).into_iter().all(fits)
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

fn axes(to_world: &DAffine3) -> [DVec3; 3] {
    let m = &to_world.matrix3;
    [m.x_axis, m.y_axis, m.z_axis]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn placed(linear: DMat3) -> DAffine3 {
        DAffine3::from_mat3_translation(linear, DVec3::new(1e6, -3.0, 0.0))
    }

    #[test]
    fn only_shear_keeps_meshes_from_being_shared() {
        let turn = DMat3::from_quat(DQuat::from_axis_angle(DVec3::ONE.normalize(), 1.0));
        let scale = DMat3::from_diagonal(DVec3::new(1e-6, -1.0, 1e6));
        assert!((shear(&placed(turn * scale)) - 1.0).abs() < 1e-9);
        assert!(is_shared(&placed(turn * scale)));
        let angle =
            |a: f64| DMat3::from_cols(DVec3::X, DVec3::new(a.cos(), a.sin(), 0.0), DVec3::Z);
        assert!((shear(&placed(angle(0.1))) - 1.0 / 0.1_f64.sin()).abs() < 1e-9);
        assert!(is_shared(&placed(angle(0.1))));
        assert!(!is_shared(&placed(angle(0.01))) && !is_flat(&placed(angle(0.01))));
        assert!(is_flat(&placed(angle(1e-13))) && is_flat(&placed(DMat3::ZERO)));
        assert!(!is_shared(&placed(1e13 * turn)) && !is_flat(&placed(1e13 * turn)));
    }
}
