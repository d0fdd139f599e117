//! Walking a ray through the cells of a regular lattice.

use glam::{DVec3, Vec3};
use std::ops::ControlFlow;
use tyndall_core::{Aabb, Ray};

/// A box-shaped lattice of equal cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    /// Smallest corner.
    pub(crate) origin: DVec3,
    /// Edge lengths of a cell, positive.
    pub(crate) cell: DVec3,
    /// Cells in each axis, at least one.
    pub(crate) count: [usize; 3],
}

/// One axis of a walk.
#[derive(Clone, Copy)]
struct Axis {
    index: usize,
    count: usize,
    /// Distance along the ray to plane 0, and from one plane to the next.
    first: f64,
    step: f64,
    forward: bool,
}

impl Axis {
    fn new(origin: f64, direction: f64, start: f64, cell: f64, count: usize) -> Self {
        // A negative or NaN position becomes 0 in the conversion.
        let index = (((origin + start * direction) / cell) as usize).min(count - 1);
        Self {
            index,
            count,
            first: -origin / direction,
            step: cell / direction,
            forward: direction > 0.0,
        }
    }

    /// Distance at which the ray leaves the current cell; never past the last plane.
    #[inline]
    fn exit(&self) -> f64 {
        let (plane, last) = if self.forward {
            (self.index + 1, self.index + 1 == self.count)
        } else {
            (self.index, self.index == 0)
        };
        if last || self.step.is_infinite() {
            f64::INFINITY
        } else {
            self.first + plane as f64 * self.step
        }
    }
}

impl Lattice {
    /// Coordinates along the ray in units of cells: `origin + t·slope`.
    #[inline]
    pub(crate) fn coordinates(&self, ray: &Ray) -> [DVec3; 2] {
        let origin = (ray.origin.as_dvec3() - self.origin) / self.cell;
        [origin, ray.direction.as_dvec3() / self.cell]
    }

    /// Visits the cells that the ray meets between `start` and `end` in order, with the distances
    /// at which it enters and leaves. The stretches join without a gap and cover \[start, end\],
    /// which the caller has clipped to the lattice: what sticks out by rounding belongs to the
    /// outermost cell. At most Σ count cells are visited, whatever the ray.
    ///
    /// Amanatides & Woo (1987), with distances computed from the index of the plane instead of
    /// summed, in `f64`.
    #[inline]
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        [start, end]: [f64; 2],
        mut visit: impl FnMut([usize; 3], f64, f64) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let origin = ray.origin.as_dvec3() - self.origin;
        let direction = ray.direction.as_dvec3();
        let mut axes: [Axis; 3] = std::array::from_fn(|i| {
            Axis::new(origin[i], direction[i], start, self.cell[i], self.count[i])
        });
        let mut exits = axes.map(|axis| axis.exit());
        let mut t = start;
        loop {
            let next = nearest(exits);
            let leave = exits[next].max(t).min(end);
            if leave > t {
                visit(axes.map(|axis| axis.index), t, leave)?;
            }
            if exits[next] >= end {
                return ControlFlow::Continue(());
            }
            t = leave;
            if axes[next].forward {
                axes[next].index += 1;
            } else {
                axes[next].index -= 1;
            }
            exits[next] = axes[next].exit();
        }
    }
}

/// The axis of the smallest distance.
#[inline]
fn nearest(exits: [f64; 3]) -> usize {
    let first = if exits[1] < exits[0] { 1 } else { 0 };
    if exits[2] < exits[first] { 2 } else { first }
}

/// The part of the ray inside `bounds`, in distances along it; `None` if it misses or only touches.
///
/// Slabs (Kay & Kajiya 1986) in `f64`; a ray along a face is inside.
#[inline]
pub(crate) fn clip(ray: &Ray, bounds: Aabb) -> Option<[f64; 2]> {
    let (mut start, mut end) = (0.0, f64::from(ray.t_max));
    for i in 0..3 {
        let (o, d) = (f64::from(ray.origin[i]), f64::from(ray.direction[i]));
        let (min, max) = (f64::from(bounds.min[i]), f64::from(bounds.max[i]));
        if d == 0.0 {
            if o < min || o > max {
                return None;
            }
        } else {
            let (a, b) = ((min - o) / d, (max - o) / d);
            start = f64::max(start, a.min(b));
            end = f64::min(end, a.max(b));
        }
    }
    (start < end).then_some([start, end])
}

/// Voxel counts as a vector.
#[inline]
pub(crate) fn counts(resolution: [usize; 3]) -> Vec3 {
    Vec3::from(resolution.map(|n| n as f32))
}
