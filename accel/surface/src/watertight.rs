//! Triangles without gaps between them.

use glam::Vec3;
use tyndall_core::Ray;

/// A ray prepared for the test of Woop, Benthin & Wald (2013), "Watertight Ray/Triangle
/// Intersection": a rotation of the axes and a shear that turn its direction into +z. Where it turns
/// into −z first, triangles are seen mirrored, which the test does not mind.
pub(crate) struct Shear {
    origin: Vec3,
    /// The axis that becomes z, along which the direction is longest; the two after it become x and
    /// y.
    axis: usize,
    shear: [f32; 3],
}

impl Shear {
    pub(crate) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let size = ray.direction.abs();
        let axis = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let [x, y, z] = turn(d, axis);
        Self {
            origin: ray.origin,
            axis,
            shear: [x / z, y / z, 1.0 / z],
        }
    }

    /// The distance, in (0, `t_max`], at which the ray meets the triangle.
    ///
    /// Two triangles that share an edge see the same three products of it, so a ray between them
    /// meets at least one. The sign of an edge function is exact: rounding is monotone, and where
    /// both products round to the same number they are taken again in `f64`, which holds them. So
    /// they are for the distance of a hit, as few digits of their difference may be left.
    #[inline]
    pub(crate) fn meet(&self, triangle: &[Vec3; 3], t_max: f32) -> Option<f32> {
        let corners = triangle.map(|p| (p - self.origin).to_array());
        let [a, b, c] = match self.axis {
            0 => corners.map(|p| self.apply(turn(p, 0))),
            1 => corners.map(|p| self.apply(turn(p, 1))),
            _ => corners.map(|p| self.apply(p)),
        };
        let edges = [edge(c, b), edge(a, c), edge(b, a)];
        if !edges.contains(&0.0) && !same_sign(edges) {
            return None;
        }
        let edges = [edge_f64(c, b), edge_f64(a, c), edge_f64(b, a)];
        let [u, v, w] = edges;
        let determinant = u + v + w;
        if !same_sign(edges) || determinant == 0.0 {
            return None;
        }
        let depth = u * f64::from(a[2]) + v * f64::from(b[2]) + w * f64::from(c[2]);
        let t = (depth / determinant) as f32;
        (0.0 < t && t <= t_max).then_some(t)
    }

    fn apply(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [sx, sy, sz] = self.shear;
        [x - sx * z, y - sy * z, sz * z]
    }
}

/// Turns the axes so that `z` comes last.
fn turn([a, b, c]: [f32; 3], z: usize) -> [f32; 3] {
    match z {
        0 => [b, c, a],
        1 => [c, a, b],
        _ => [a, b, c],
    }
}

fn same_sign<T: PartialOrd + From<f32>>(edges: [T; 3]) -> bool {
    let zero = T::from(0.0);
    edges.iter().all(|e| *e >= zero) || edges.iter().all(|e| *e <= zero)
}

/// The edge function of two points of the sheared plane.
fn edge(p: [f32; 3], q: [f32; 3]) -> f32 {
    p[0] * q[1] - p[1] * q[0]
}

fn edge_f64(p: [f32; 3], q: [f32; 3]) -> f64 {
    let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(f64::from);
    px * qy - py * qx
}
