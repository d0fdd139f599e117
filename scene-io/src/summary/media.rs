//! Media.

use crate::file::Part;
use crate::media::{Grid, MediumDescription};
use crate::{Scene, SceneFile};
use glam::Vec3;
use serde::Serialize;
use tyndall_core::{Aabb, PhaseFunction, Ray, Rgb, Spectrum};

/// A medium of a scene. Where it varies in space, numbers are those of its densest point; where
/// they vary with the channel, there are three.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MediumSummary {
    /// Its name in the file.
    pub name: String,
    /// `homogeneous` or `grid`.
    pub kind: &'static str,
    /// Voxels of a grid.
    pub voxels: Option<[usize; 3]>,
    /// Shapes that it fills.
    pub shapes: usize,
    /// Whether it fills space outside of shapes, that of some at least: as the medium of the camera
    /// or named by `outside`.
    pub fills_space: bool,
    /// Extinction σt, 1/scene unit.
    pub sigma_t: [f32; 3],
    /// Albedo σs/σt.
    pub albedo: [f32; 3],
    /// Mean cosine g of scattering; positive is forward.
    pub anisotropy: f32,
    /// 1/σt of the densest channel, scene units; `None` where light is never met.
    pub mean_free_path: Option<f32>,
    /// Length of the longest straight way through it: the diagonal of the largest box that it
    /// fills; infinite where it fills space without end. Scene units.
    pub extent: f32,
    /// ∫σt along the longest way, of the densest channel, perhaps infinite; of a grid, the largest
    /// of 3·16² lines along the axes and the four diagonals.
    pub optical_depth: f32,
    /// Whether it glows.
    pub emits: bool,
    /// Bytes of its grids.
    pub grid_bytes: u64,
}

impl MediumSummary {
    /// Whether light meets it anywhere.
    pub(super) fn matters(&self) -> bool {
        self.optical_depth > 0.0
    }

    /// Largest albedo of a channel.
    pub(super) fn largest_albedo(&self) -> f32 {
        self.albedo.into_iter().fold(0.0, f32::max)
    }

    /// Of the light that crosses it the longest way, the largest share that it scatters: albedo
    /// times 1 − e^−τ.
    pub(super) fn scattered_share(&self) -> f32 {
        self.largest_albedo() * -(-self.optical_depth).exp_m1()
    }
}

/// The box of all space.
const EVERYWHERE: Aabb = Aabb {
    min: Vec3::NEG_INFINITY,
    max: Vec3::INFINITY,
};

pub(super) fn summarise<S: Spectrum>(file: &SceneFile, scene: &Scene<S>) -> Vec<MediumSummary> {
    let ambient = scene.boundaries.medium(scene.boundaries.ambient());
    let named = file.media_names.iter().zip(&file.media).enumerate();
    let summaries = named.map(|(m, (name, medium))| {
        let named_outside = |part: &Part| file.materials[part.material].outside == Some(Some(m));
        let fills_space = ambient == Some(m) || file.parts.iter().any(named_outside);
        let boxes = file.parts.iter().filter(|part| {
            let material = &file.materials[part.material];
            material.bsdf.transmits() && material.inside == Some(m)
        });
        let mut boxes: Vec<_> = boxes.map(|part| part.bounds).collect();
        let shapes = boxes.len();
        if fills_space {
            boxes.push(EVERYWHERE);
        }
        summary(name, medium, shapes, fills_space, &boxes)
    });
    summaries.collect()
}

fn summary(
    name: &str,
    medium: &MediumDescription,
    shapes: usize,
    fills_space: bool,
    boxes: &[Aabb],
) -> MediumSummary {
    let grid = medium.grid.as_ref();
    let densest = grid.map_or(1.0, |grid| grid.density.max());
    let sigma_t = medium.coefficients.sigma_t() * densest;
    let albedo = match grid.and_then(|grid| grid.albedo.as_ref()) {
        Some(albedo) => albedo.max(),
        None => medium.coefficients.albedo(),
    };
    let filled = boxes.iter().filter(|b| !b.is_empty());
    let extents = filled.map(|b| match grid {
        Some(grid) => overlap(*b, grid.density.bounds()).size().length(),
        None => b.size().length(),
    });
    let extent = extents.fold(0.0, f32::max);
    let largest = sigma_t.max_channel();
    let optical_depth = match grid {
        Some(grid) if extent > 0.0 => {
            medium.coefficients.sigma_t().max_channel() * longest_column(grid)
        }
        // A coefficient of 0 times an infinite extent.
        _ if largest == 0.0 => 0.0,
        _ => largest * extent,
    };
    let glow = grid.and_then(|grid| grid.emission.as_ref());
    MediumSummary {
        name: name.to_owned(),
        kind: if grid.is_some() {
            "grid"
        } else {
            "homogeneous"
        },
        voxels: grid.map(|grid| grid.density.resolution()),
        shapes,
        fills_space,
        sigma_t: sigma_t.0.to_array(),
        albedo: albedo.0.to_array(),
        anisotropy: medium.phase.mean_cosine(),
        mean_free_path: (largest > 0.0).then(|| 1.0 / largest),
        extent,
        optical_depth,
        emits: !medium.coefficients.emission.is_black() || glow.is_some(),
        grid_bytes: grid.map_or(0, bytes),
    }
}

/// What two boxes share; of no size where that is nothing.
fn overlap(a: Aabb, b: Aabb) -> Aabb {
    let min = a.min.max(b.min);
    let max = a.max.min(b.max).max(min);
    Aabb { min, max }
}

/// The largest of the integrals of the density along lines through its box.
fn longest_column(grid: &Grid) -> f32 {
    const LINES: usize = 16;
    let bounds = grid.density.bounds();
    let (min, size) = (bounds.min, bounds.size());
    let along = |from: Vec3, to: Vec3| {
        let (direction, length) = (to - from).normalize_and_length();
        let ray = Ray::new(from, direction).up_to(length);
        grid.density.line_integral(&ray)
    };
    let fraction = |i: usize| (i as f32 + 0.5) / LINES as f32;
    let across = (0..3).flat_map(|axis| {
        (0..LINES * LINES).map(move |i| {
            let mut from = Vec3::ZERO;
            from[(axis + 1) % 3] = fraction(i % LINES);
            from[(axis + 2) % 3] = fraction(i / LINES);
            let mut to = from;
            to[axis] = 1.0;
            [from, to]
        })
    });
    let diagonals = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|from| [from, Vec3::ONE - from]);
    let columns = across
        .chain(diagonals)
        .map(|[from, to]| along(min + from * size, min + to * size));
    columns.fold(0.0, f64::max) as f32
}

fn bytes(grid: &Grid) -> u64 {
    let voxels = |resolution: [usize; 3]| resolution.into_iter().product::<usize>() as u64;
    let coloured = [&grid.albedo, &grid.emission].into_iter().flatten();
    let coloured = coloured.map(|g| voxels(g.resolution()) * size_of::<Rgb>() as u64);
    voxels(grid.density.resolution()) * size_of::<f32>() as u64 + coloured.sum::<u64>()
}
