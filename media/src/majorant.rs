//! Bounds of the extinction along a ray.

use crate::lattice::{Lattice, clip};
use glam::{DVec3, Vec3};
use std::ops::ControlFlow;
use tyndall_core::{Aabb, Ray};

/// Voxels along an edge of a majorant cell, unless there would be more than [`MOST_CELLS`].
const VOXELS: usize = 8;
/// Majorant cells along an edge of the grid.
const MOST_CELLS: usize = 64;

/// What is known of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// No channel of σt exceeds this in it.
    pub(crate) sigma_bar: f32,
    /// Mean of the density in and around it.
    pub(crate) density: f32,
}

/// A coarse grid of bounds of the extinction.
#[derive(Clone, Debug)]
pub(crate) struct MajorantGrid {
    bounds: Aabb,
    lattice: Lattice,
    cells: Vec<Cell>,
}

impl MajorantGrid {
    /// Cells for a grid of `resolution` voxels in `bounds`; `describe` looks
    /// at a region.
    pub(crate) fn new(
        bounds: Aabb,
        resolution: [usize; 3],
        mut describe: impl FnMut(Aabb) -> Cell,
    ) -> Self {
        let voxels = resolution.map(|n| n.div_ceil(MOST_CELLS).max(VOXELS));
        let count: [usize; 3] = std::array::from_fn(|i| resolution[i].div_ceil(voxels[i]));
        let size = bounds.size().as_dvec3();
        let cell = DVec3::from_array(std::array::from_fn(|i| {
            size[i] / resolution[i] as f64 * voxels[i] as f64
        }));
        let origin = bounds.min.as_dvec3();
        let corner = |x: usize, y: usize, z: usize| -> Vec3 {
            (origin + cell * DVec3::new(x as f64, y as f64, z as f64)).as_vec3()
        };
        let mut cells = Vec::with_capacity(count.iter().product());
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let (min, max) = (corner(x, y, z), corner(x + 1, y + 1, z + 1));
                    cells.push(describe(Aabb { min, max }));
                }
            }
        }
        let lattice = Lattice {
            origin,
            cell,
            count,
        };
        Self {
            bounds,
            lattice,
            cells,
        }
    }

    /// Visits the stretches of the ray whose bound is positive, in order.
    #[inline]
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        mut visit: impl FnMut(f64, f64, Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(span) = clip(ray, self.bounds) else {
            return ControlFlow::Continue(());
        };
        let [nx, ny, _] = self.lattice.count;
        self.lattice.walk(ray, span, |[x, y, z], enter, leave| {
            let cell = self.cells[(z * ny + y) * nx + x];
            if cell.sigma_bar > 0.0 {
                visit(enter, leave, cell)
            } else {
                ControlFlow::Continue(())
            }
        })
    }
}
