//! A leaf that is a tree.

use super::tree::Tree;
use crate::meet::Line;
use glam::{DAffine3, DVec3};
use std::sync::Arc;
use tyndall_core::{Aabb, Ray};

/// An instance: the tree of its mesh, and how rays are taken there.
pub(super) struct Placed {
    tree: Arc<Tree>,
    to_mesh: DAffine3,
    bounds: Aabb,
}

impl Placed {
    pub(super) fn new(tree: Arc<Tree>, to_world: &DAffine3, bounds: Aabb) -> Self {
        Self {
            tree,
            to_mesh: to_world.inverse(),
            bounds,
        }
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.bounds
    }

    #[cfg(test)]
    pub(super) fn tree(&self) -> &Arc<Tree> {
        &self.tree
    }

    /// The nearest hit within (0, `t_max`]: its distance in the world, and the triangle.
    #[inline(never)]
    pub(super) fn nearest(&self, line: &Line, t_max: f32) -> Option<(f32, u32)> {
        let (ray, skipped) = self.enter(line, t_max);
        let met = self.tree.nearest(&ray, &[])?;
        let t = (f64::from(met.t) + skipped) as f32;
        Some((t.min(t_max), met.primitive))
    }

    /// Whether any triangle is met within (0, `t_max`].
    #[inline(never)]
    pub(super) fn any(&self, line: &Line, t_max: f32) -> bool {
        let (ray, _) = self.enter(line, t_max);
        self.tree.any(&ray, &[])
    }

    /// The ray in the coordinates of the mesh, and by how much it starts late.
    ///
    /// Its direction is not normalised, so that distances are those in the world. A ray from far
    /// away starts near the mesh, so that `f32` still resolves it.
    fn enter(&self, line: &Line, t_max: f32) -> (Ray, f64) {
        let away = self.bounds.center().as_dvec3() - line.origin;
        let size = self.bounds.size().as_dvec3().length();
        let skipped = (away.dot(line.direction) - size).max(0.0);
        let origin: DVec3 = line.origin + skipped * line.direction;
        let left = (f64::from(t_max) - skipped) as f32;
        let ray = Ray {
            origin: self.to_mesh.transform_point3(origin).as_vec3(),
            direction: self.to_mesh.transform_vector3(line.direction).as_vec3(),
            t_max: if skipped > 0.0 { left.next_up() } else { left },
        };
        (ray, skipped)
    }
}
