//! Sparse grids to test media with, rays through them, and quadratures of what they read.

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3, Vec3};
use std::ops::ControlFlow::Continue;
use std::sync::atomic::{AtomicU64, Ordering};
use tyndall_core::{Aabb, Coefficients, Majorant, Medium, Ray, Sampler, Spectrum, warp};
use tyndall_media::{
    Cells, Field, Filter, GridMedium, Hint, MediumError, Phase, Precision, Range, Region,
    SparseBuilder, SparseGrid, TileSize,
};
use tyndall_testkit::{
    rng,
    stats::{Estimate, Moments},
};

/// Turned, sheared, mirrored and moved.
pub(crate) fn skewed() -> DAffine3 {
    let turn = DMat3::from_quat(DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(-1.1));
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.3, 1.0, 0.0), DVec3::Z);
    let scale = DMat3::from_diagonal(DVec3::new(0.1, -0.2, 0.15));
    DAffine3::from_mat3_translation(turn * shear * scale, DVec3::new(3.0, -2.0, 5.0))
}

/// Balls of noise in a box of 64³ voxels, most of it empty, and a tile.
pub(crate) fn cloud(to_world: DAffine3, precision: Precision) -> SparseGrid {
    let mut random = rng(1);
    let mut grid = SparseBuilder::new(0.0).with_precision(precision);
    grid.tile(IVec3::new(-16, 8, 8), TileSize::Leaf, 0.75, true)
        .unwrap();
    for (center, radius) in [([-20, -20, -20], 9), ([0, 3, -1], 12), ([25, 20, -10], 6)] {
        for i in 0..(2 * radius + 1_i32).pow(3) {
            let n = 2 * radius + 1;
            let offset = IVec3::new(i / (n * n), i / n % n, i % n) - radius;
            let voxel = IVec3::from(center) + offset;
            let in_tile = (voxel - IVec3::new(-16, 8, 8)).cmpge(IVec3::ZERO).all()
                && (voxel - IVec3::new(-16, 8, 8)).cmplt(IVec3::splat(8)).all();
            if offset.length_squared() <= radius * radius && !in_tile {
                grid.voxel(voxel, (1.5 * random.next_1d() - 0.3).max(0.0))
                    .unwrap();
            }
        }
    }
    grid.build(to_world).unwrap()
}

pub(crate) fn medium<S: Spectrum, D: Field<f32>>(density: D, sigma_t: S) -> GridMedium<S, D> {
    let coefficients = Coefficients {
        sigma_a: sigma_t * 0.25,
        sigma_s: sigma_t * 0.75,
        emission: S::default(),
    };
    GridMedium::new(density, coefficients, Phase::Isotropic).unwrap()
}

/// A ray through the box of the cloud: from inside or outside, ending anywhere or never. Places are
/// even in voxels, whatever their shape.
pub(crate) fn ray(to_world: DAffine3, random: &mut impl Sampler) -> Ray {
    let place = (60.0 * (Vec3::from(random.next::<3>()) - 0.5)).as_dvec3();
    let direction = warp::uniform_sphere(random.next()).as_dvec3();
    // Of 70 voxels.
    let back = if random.next_1d() < 0.5 { 0.0 } else { 70.0 };
    let origin = to_world.transform_point3(place - back * direction);
    let along = to_world.transform_vector3(direction);
    let ray = Ray::new(origin.as_vec3(), along.normalize().as_vec3());
    if random.next_1d() < 0.5 {
        return ray;
    }
    let end = (back + 40.0 * f64::from(random.next_1d())) * along.length();
    ray.up_to(end as f32)
}

/// The part of a ray inside the box that a grid fills, in voxels: origin, direction, start and end.
fn through(grid: &SparseGrid, filter: Filter, ray: &Ray) -> Option<(DVec3, DVec3, [f64; 2])> {
    let to_index = grid.to_world().inverse();
    let origin = to_index.transform_point3(ray.origin.as_dvec3());
    let direction = to_index.transform_vector3(ray.direction.as_dvec3());
    let reach = match filter {
        Filter::Trilinear => 1.0,
        Filter::Nearest => 0.5,
    };
    let [first, last] = grid.content()?;
    let [first, last] = [first.as_dvec3() - reach, last.as_dvec3() + reach];
    let (mut start, mut end) = (0.0_f64, f64::from(ray.t_max));
    for i in 0..3 {
        let [a, b] = [first[i] - origin[i], last[i] - origin[i]];
        if direction[i] != 0.0 {
            let [a, b] = [a / direction[i], b / direction[i]];
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        } else if a > 0.0 || b < 0.0 {
            return None;
        }
    }
    (start < end).then_some((origin, direction, [start, end]))
}

/// ∫ value dt: between the planes of the voxels the value is a cubic, which two points of Gauss
/// integrate exactly, or constant.
pub(crate) fn column(grid: &SparseGrid, filter: Filter, ray: &Ray) -> f64 {
    let Some((origin, direction, [start, end])) = through(grid, filter, ray) else {
        return 0.0;
    };
    let half = match filter {
        Filter::Trilinear => 0.0,
        Filter::Nearest => 0.5,
    };
    let mut cuts = vec![start, end];
    for i in (0..3).filter(|&i| direction[i] != 0.0) {
        let [a, b] = [start, end].map(|t| origin[i] + t * direction[i] - half);
        let planes = a.min(b).ceil() as i64..=a.max(b).floor() as i64;
        cuts.extend(planes.map(|plane| (plane as f64 + half - origin[i]) / direction[i]));
    }
    cuts.retain(|t| (start..=end).contains(t));
    cuts.sort_by(f64::total_cmp);
    let value = |t: f64| read(grid, filter, origin + t * direction);
    let pieces = cuts.windows(2).map(|piece| {
        let (middle, half) = (0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0]));
        half * (value(middle - half / 3_f64.sqrt()) + value(middle + half / 3_f64.sqrt()))
    });
    pieces.sum()
}

/// The value at a place in voxels, in `f64`.
fn read(grid: &SparseGrid, filter: Filter, x: DVec3) -> f64 {
    if filter == Filter::Nearest {
        return f64::from(grid.voxel((x + 0.5).floor().as_ivec3()));
    }
    let base = x.floor();
    (0..8).fold(0.0, |sum, corner| {
        let corner = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
        let weight = (1.0 - (x - base - corner.as_dvec3()).abs()).element_product();
        sum + weight * f64::from(grid.voxel(base.as_ivec3() + corner))
    })
}

/// The mean of ratio-tracked transmittances.
pub(crate) fn transmitted(
    medium: &impl Medium<Spectrum = f32>,
    ray: &Ray,
    samples: usize,
    random: &mut impl Sampler,
) -> Estimate {
    let moments: Moments = (0..samples)
        .map(|_| f64::from(medium.transmittance(ray, random)))
        .collect();
    moments.estimate()
}

/// No majorant is below a value on its stretch of the ray, and none is missing.
pub(crate) fn check_bounds(
    grid: &SparseGrid,
    medium: &GridMedium<f32, SparseGrid>,
    ray: &Ray,
    end: f32,
) {
    let mut stretches: Vec<Majorant> = Vec::new();
    medium.majorants(ray, |majorant| {
        stretches.push(majorant);
        Continue(())
    });
    let joined = |pair: &[Majorant]| pair[0].t_max <= pair[1].t_min;
    assert!(stretches.windows(2).all(joined));
    let end = ray.t_max.min(end);
    for i in 0..400 {
        let t = end * (i as f32 + 0.37) / 400.0;
        let p = ray.at(t);
        let value = medium.coefficients(p).sigma_t();
        let bound = (stretches.iter().filter(|s| s.t_min <= t && t <= s.t_max))
            .fold(0.0, |bound, s| s.sigma_bar.max(bound));
        let place = grid.to_world().inverse().transform_point3(p.as_dvec3());
        assert!(
            value <= bound * 1.000_1,
            "{ray:?} at {t}, {place} in voxels: {value} over {bound}"
        );
    }
}

/// A field that counts how often it is asked, with its own cells or a single one.
#[derive(Debug)]
pub(crate) struct Counted {
    pub(crate) grid: SparseGrid,
    pub(crate) one_cell: bool,
    pub(crate) lookups: AtomicU64,
    /// Bounds asked for, and those of them that are not zero.
    pub(crate) ranges: [AtomicU64; 2],
}

impl Counted {
    pub(crate) fn new(grid: SparseGrid, one_cell: bool) -> Self {
        Self {
            grid,
            one_cell,
            lookups: AtomicU64::new(0),
            ranges: [AtomicU64::new(0), AtomicU64::new(0)],
        }
    }
}

impl Field<f32> for Counted {
    fn bounds(&self) -> Aabb {
        self.grid.bounds()
    }

    fn lookup(&self, p: Vec3, hint: &mut Hint) -> f32 {
        self.lookups.fetch_add(1, Ordering::Relaxed);
        self.grid.lookup(p, hint)
    }

    fn range(&self, region: &Region) -> Range<f32> {
        let range = self.grid.range(region);
        self.ranges[0].fetch_add(1, Ordering::Relaxed);
        if range.max > 0.0 {
            self.ranges[1].fetch_add(1, Ordering::Relaxed);
        }
        range
    }

    fn check(&self) -> Result<(), MediumError> {
        self.grid.check()
    }

    fn cells(&self) -> Cells {
        let whole = Cells {
            to_world: Region::of(self.bounds()).to_world,
            size: DVec3::ONE,
        };
        if self.one_cell {
            whole
        } else {
            self.grid.cells()
        }
    }
}
