//! Media.

use crate::file::Part;
use crate::media::{Boxed, ColourValues, Density, Glow, Grid, MediumDescription, Scalars};
use crate::{Scene, SceneFile};
use glam::{DVec3, Vec3};
use serde::Serialize;
use tyndall_core::{Aabb, PhaseFunction, Ray, Spectrum};
use tyndall_media::{Field, Hint, SparseGrid};

/// A medium of a scene. Where it varies in space, numbers are those of its densest point (of an
/// atmosphere, at its origin); where they vary with the channel, there are three.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MediumSummary {
    /// Its name in the file.
    pub name: String,
    /// `homogeneous`, `atmosphere`, `grid` or `sparse grid`.
    pub kind: &'static str,
    /// Voxels of a grid along its edges.
    pub voxels: Option<[usize; 3]>,
    /// Active voxels of a sparse grid.
    pub active_voxels: Option<u64>,
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
    /// of 3·16² lines along the axes and the four diagonals; of an atmosphere, that of a scale height
    /// at most.
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
    let ambient = scene.boundaries.filling(scene.boundaries.ambient());
    let named = file.media_names.iter().zip(&file.media).enumerate();
    let summaries = named.map(|(m, (name, medium))| {
        let material = |part: &Part| &file.materials[part.material];
        let named_outside = |part: &Part| material(part).outside.iter().flatten().any(|&o| o == m);
        let fills_space = ambient.contains(&m) || file.parts.iter().any(named_outside);
        let filled =
            |part: &&Part| material(part).bsdf.transmits() && material(part).inside.contains(&m);
        let boxes = file.parts.iter().filter(filled).map(|part| part.bounds);
        let mut boxes: Vec<_> = boxes.collect();
        let shapes = boxes.len();
        if fills_space {
            boxes.push(EVERYWHERE);
        }
        let filled = Filled {
            shapes,
            fills_space,
            boxes,
        };
        summary(name, medium, &filled, file.origin)
    });
    summaries.collect()
}

/// Where a medium is.
struct Filled {
    shapes: usize,
    fills_space: bool,
    boxes: Vec<Aabb>,
}

fn summary(
    name: &str,
    medium: &MediumDescription,
    filled: &Filled,
    origin: DVec3,
) -> MediumSummary {
    let grid = medium.grid();
    let densest = grid.map_or(1.0, |grid| grid.density.max());
    let sigma_t = medium.coefficients.sigma_t() * densest;
    let albedo = match grid.and_then(|grid| grid.albedo.as_ref()) {
        Some(albedo) => albedo.max(),
        None => medium.coefficients.albedo(),
    };
    let grid_box = grid.map(|grid| grid.density.bounds(origin));
    let boxes = filled.boxes.iter().filter(|b| !b.is_empty());
    let boxes = boxes.map(|b| grid_box.map_or(*b, |grid| overlap(*b, grid)));
    let extent = boxes.map(|b| b.size().length()).fold(0.0, f32::max);
    let largest = sigma_t.max_channel();
    let optical_depth = match &medium.density {
        // A coefficient of 0 times an infinite extent.
        _ if largest == 0.0 || extent == 0.0 => 0.0,
        Density::Constant => largest * extent,
        Density::Exponential { scale_height, .. } => largest * extent.min(*scale_height),
        Density::Grid(grid) => {
            medium.coefficients.sigma_t().max_channel() * longest_column(&grid.density)
        }
    };
    let (kind, voxels, active_voxels) = match (&medium.density, grid.map(|grid| &grid.density)) {
        (_, Some(Scalars::Dense(boxed))) => ("grid", Some(boxed.grid.resolution()), None),
        (_, Some(Scalars::Sparse(grid))) => ("sparse grid", None, Some(grid.statistics().voxels)),
        (Density::Exponential { .. }, _) => ("atmosphere", None, None),
        _ => ("homogeneous", None, None),
    };
    MediumSummary {
        name: name.to_owned(),
        kind,
        voxels,
        active_voxels,
        shapes: filled.shapes,
        fills_space: filled.fills_space,
        sigma_t: sigma_t.0.to_array(),
        albedo: albedo.0.to_array(),
        anisotropy: medium.phase.mean_cosine(),
        mean_free_path: (largest > 0.0).then(|| 1.0 / largest),
        extent,
        optical_depth,
        emits: !medium.coefficients.emission.is_black() || grid.is_some_and(|g| g.glow.is_some()),
        grid_bytes: grid.map_or(0, bytes),
    }
}

/// What two boxes share; of no size where that is nothing.
fn overlap(a: Aabb, b: Aabb) -> Aabb {
    let min = a.min.max(b.min);
    let max = a.max.min(b.max).max(min);
    Aabb { min, max }
}

/// The largest of the integrals of the density along lines through its box, of the file.
fn longest_column(density: &Scalars) -> f32 {
    let columns = |bounds: Aabb, along: &dyn Fn(Ray) -> f64| {
        let lines = lines(bounds).map(along);
        lines.fold(0.0, f64::max) as f32
    };
    match density {
        Scalars::Dense(boxed) => {
            // Of the box in the file it has the shape only.
            let size = (boxed.corners[1] - boxed.corners[0]).as_vec3();
            let bounds = Aabb {
                min: Vec3::ZERO,
                max: size,
            };
            let placed = boxed.grid.clone().with_bounds(bounds);
            placed.map_or(0.0, |grid| columns(bounds, &|ray| grid.line_integral(&ray)))
        }
        Scalars::Sparse(grid) => columns(grid.bounds(), &|ray| sampled_column(grid, &ray)),
    }
}

/// By the midpoint rule, about twice a voxel.
fn sampled_column(grid: &SparseGrid, ray: &Ray) -> f64 {
    const MOST: f64 = 4096.0;
    let length = f64::from(ray.t_max);
    let voxels = (grid.to_world().inverse().matrix3 * ray.direction.as_dvec3()).length() * length;
    let steps = (2.0 * voxels).clamp(1.0, MOST).ceil();
    let mut hint = Hint::default();
    let densities = (0..steps as u32).map(|i| {
        let t = length * (f64::from(i) + 0.5) / steps;
        f64::from(grid.lookup(ray.at(t as f32), &mut hint))
    });
    densities.sum::<f64>() * length / steps
}

/// Lines across a box along its axes, and its diagonals.
fn lines(bounds: Aabb) -> impl Iterator<Item = Ray> {
    const LINES: usize = 16;
    let (min, size) = (bounds.min, bounds.size());
    let fraction = |i: usize| (i as f32 + 0.5) / LINES as f32;
    let across = (0..3).flat_map(move |axis| {
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
    across.chain(diagonals).map(move |ends| {
        let [from, to] = ends.map(|p| min + p * size);
        let (direction, length) = (to - from).normalize_and_length();
        Ray::new(from, direction).up_to(length)
    })
}

fn bytes(grid: &Grid) -> u64 {
    let coloured = |values: &ColourValues| match values {
        ColourValues::Dense(boxed) => dense_bytes(boxed),
        ColourValues::Sparse(grid) => grid.bytes(),
        ColourValues::Grey(grid) => grid.bytes(),
    };
    let scalar = |values: &Scalars| match values {
        Scalars::Dense(boxed) => dense_bytes(boxed),
        Scalars::Sparse(grid) => grid.bytes(),
    };
    let glow = match &grid.glow {
        None => 0,
        Some(Glow::Emission(emission)) => coloured(&emission.values),
        Some(Glow::Heat { temperature, .. }) => scalar(temperature),
    };
    let albedo = grid.albedo.as_ref().map_or(0, |a| coloured(&a.values));
    (scalar(&grid.density) + albedo + glow) as u64
}

fn dense_bytes<T: Spectrum>(boxed: &Boxed<T>) -> usize {
    size_of_val(boxed.grid.values())
}
