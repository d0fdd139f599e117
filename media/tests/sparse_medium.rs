//! Media of sparse grids: against quadrature, closed forms and what a single bound would cost.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3, Vec3};
use std::ops::ControlFlow::Continue;
use std::sync::atomic::{AtomicU64, Ordering};
use tyndall_core::{Aabb, Coefficients, Medium, Ray, Rgb, Sampler, Spectrum, warp};
use tyndall_media::{
    Cells, Field, Filter, GridMedium, Hint, MediumError, Phase, Precision, Range, Region,
    SparseBuilder, SparseGrid, TileSize,
};
use tyndall_testkit::{
    rng,
    stats::{Moments, check_means, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;

/// Turned, sheared, mirrored and moved.
fn skewed() -> DAffine3 {
    let turn = DMat3::from_quat(DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(-1.1));
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.3, 1.0, 0.0), DVec3::Z);
    let scale = DMat3::from_diagonal(DVec3::new(0.1, -0.2, 0.15));
    DAffine3::from_mat3_translation(turn * shear * scale, DVec3::new(3.0, -2.0, 5.0))
}

/// Balls of noise in a box of 64³ voxels, most of it empty, and a tile.
fn cloud(to_world: DAffine3, precision: Precision) -> SparseGrid {
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

fn medium<S: Spectrum, D: Field<f32>>(density: D, sigma_t: S) -> GridMedium<S, D> {
    let coefficients = Coefficients {
        sigma_a: sigma_t * 0.25,
        sigma_s: sigma_t * 0.75,
        emission: S::default(),
    };
    GridMedium::new(density, coefficients, Phase::Isotropic).unwrap()
}

/// A ray through the box of the cloud: from inside or outside, ending anywhere or never.
fn ray(to_world: DAffine3, random: &mut impl Sampler) -> Ray {
    let place = 60.0 * (Vec3::from(random.next::<3>()) - 0.5);
    let p = to_world.transform_point3(place.as_dvec3()).as_vec3();
    let direction = warp::uniform_sphere(random.next());
    let voxel = to_world.matrix3.determinant().abs().cbrt() as f32;
    let back = if random.next_1d() < 0.5 {
        0.0
    } else {
        70.0 * voxel
    };
    let ray = Ray::new(p - back * direction, direction);
    if random.next_1d() < 0.5 {
        return ray;
    }
    ray.up_to(back + 40.0 * voxel * random.next_1d())
}

/// ∫ value dt: between the planes of the voxels the value is a cubic, which two points of Gauss
/// integrate exactly.
fn column(grid: &SparseGrid, ray: &Ray) -> f64 {
    let to_index = grid.to_world().inverse();
    let origin = to_index.transform_point3(ray.origin.as_dvec3());
    let direction = to_index.transform_vector3(ray.direction.as_dvec3());
    let [first, last] = grid.content().unwrap().map(|ijk| ijk.as_dvec3());
    let mut cuts = vec![0.0];
    let end = f64::from(ray.t_max).min(1e4);
    for i in 0..3 {
        let planes = (first[i] as i32 - 1)..=(last[i] as i32 + 1);
        cuts.extend(planes.map(|plane| (f64::from(plane) - origin[i]) / direction[i]));
    }
    cuts.retain(|t| (0.0..=end).contains(t));
    cuts.push(end);
    cuts.sort_by(f64::total_cmp);
    let value = |t: f64| {
        let x = origin + t * direction;
        let base = x.floor();
        (0..8).fold(0.0, |sum, corner| {
            let corner = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
            let weight = (1.0 - (x - base - corner.as_dvec3()).abs()).element_product();
            sum + weight * f64::from(grid.voxel(base.as_ivec3() + corner))
        })
    };
    let pieces = cuts.windows(2).map(|piece| {
        let (middle, half) = (0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0]));
        half * (value(middle - half / 3_f64.sqrt()) + value(middle + half / 3_f64.sqrt()))
    });
    pieces.sum()
}

/// A thousand rays, three channels that differ by 30, either precision of voxels.
#[test]
fn transmittances_are_those_of_the_field() {
    let sigma_t = Rgb::new(0.3, 1.0, 9.0);
    for precision in [Precision::Single, Precision::Half] {
        let grid = cloud(skewed(), precision);
        let medium = medium(grid.clone(), sigma_t);
        let mut random = rng(2);
        let mut cases = Vec::new();
        for _ in 0..1_000 {
            let ray = ray(skewed(), &mut random);
            let depth = sigma_t.map(|s| s * column(&grid, &ray) as f32);
            let mut moments = [Moments::new(); 3];
            for _ in 0..1_000 {
                let transmittance = medium.transmittance(&ray, &mut random);
                (0..3).for_each(|c| moments[c].push(f64::from(transmittance.channel(c))));
            }
            // Where little comes from a few samples, their mean is not normal.
            cases.extend((0..3).filter(|c| depth.channel(*c) < 2.0).map(|c| {
                let expected = (-f64::from(depth.channel(c))).exp();
                ("transmittance", moments[c].estimate(), expected)
            }));
        }
        assert!(cases.len() > 1_500);
        check_means(&cases, FALSE_ALARM).unwrap();
    }
}

#[test]
fn flights_collide_where_the_field_is() {
    let grid = cloud(skewed(), Precision::Single);
    let medium = medium(grid.clone(), 0.8_f32);
    let center = skewed().transform_point3(DVec3::ZERO).as_vec3();
    let ray = Ray::new(center - 5.0 * Vec3::X, Vec3::X).up_to(10.0);
    let mut random = rng(3);
    let (mut distances, mut passed) = (Vec::new(), Moments::new());
    for _ in 0..50_000 {
        let flight = medium.sample_free_flight(&ray, 1.0, &mut random);
        assert!((flight.weight - 1.0).abs() < 1e-5);
        passed.push(if flight.collision.is_none() { 1.0 } else { 0.0 });
        distances.extend(flight.collision.map(|c| f64::from(c.t)));
    }
    let depth = |t: f64| 0.8 * column(&grid, &ray.up_to(t as f32));
    let whole = depth(10.0);
    assert!((0.5..4.0).contains(&whole), "{whole}");
    check_means(
        &[("passed", passed.estimate(), (-whole).exp())],
        FALSE_ALARM,
    )
    .unwrap();
    distances.truncate(5_000);
    let cdf = |t: f64| (-depth(t)).exp_m1() / (-whole).exp_m1();
    kolmogorov_smirnov(&mut distances, cdf, FALSE_ALARM).unwrap();
}

/// Emission in proportion to extinction: the source function times what is not let through.
#[test]
fn emission_is_found_wherever_it_is() {
    let grid = cloud(skewed(), Precision::Single);
    let coefficients = Coefficients {
        sigma_a: 0.5_f32,
        sigma_s: 0.5,
        emission: 3.0,
    };
    let glowing = GridMedium::new(grid.clone(), coefficients, Phase::Isotropic).unwrap();
    let mut random = rng(4);
    let mut cases = Vec::new();
    for _ in 0..100 {
        let ray = ray(skewed(), &mut random);
        let expected = -3.0 * (-column(&grid, &ray)).exp_m1();
        let emitted = |_| f64::from(glowing.emitted(&ray, &mut random));
        let moments: Moments = (0..2_000).map(emitted).collect();
        cases.push(("emitted", moments.estimate(), expected));
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// Along edges and faces of voxels, leaves and nodes, through corners, and anywhere.
#[test]
fn majorants_cover_what_is_read() {
    for filter in [Filter::Trilinear, Filter::Nearest] {
        let grid = cloud(DAffine3::IDENTITY, Precision::Single).with_filter(filter);
        let medium = medium(grid.clone(), 1.0_f32);
        let mut random = rng(5);
        let mut rays: Vec<_> = (0..2_000)
            .map(|_| ray(DAffine3::IDENTITY, &mut random))
            .collect();
        let planes = [-24.0, -8.5, -8.0, -0.5, 0.0, 0.5, 7.5, 8.0, 15.5, 24.0];
        for (y, z) in planes.iter().flat_map(|y| planes.map(|z| (*y, z))) {
            for turn in 0..3 {
                let place =
                    |v: [f32; 3]| Vec3::new(v[turn % 3], v[(turn + 1) % 3], v[(turn + 2) % 3]);
                rays.push(Ray::new(place([-90.0, y, z]), place([1.0, 0.0, -0.0])));
                rays.push(Ray::new(place([90.0, y, z]), place([-1.0, 0.0, 0.0])));
                let slanted = place([1.0, 1.0, 0.0]).normalize();
                rays.push(Ray::new(place([y, y, z]) - 64.0 * slanted, slanted));
            }
        }
        rays.push(Ray::new(Vec3::splat(-50.0), Vec3::ONE.normalize()));
        for ray in rays {
            check_bounds(&grid, &medium, &ray);
        }
    }
}

fn check_bounds(grid: &SparseGrid, medium: &GridMedium<f32, SparseGrid>, ray: &Ray) {
    let mut stretches = Vec::new();
    medium.majorants(ray, |majorant| {
        stretches.push(majorant);
        Continue(())
    });
    assert!(
        stretches
            .windows(2)
            .all(|pair| pair[0].t_max <= pair[1].t_min)
    );
    let end = ray.t_max.min(200.0);
    for i in 0..400 {
        let t = end * (i as f32 + 0.37) / 400.0;
        let value = Field::lookup(grid, ray.at(t), &mut Hint::default());
        let bound = (stretches.iter().filter(|s| s.t_min <= t && t <= s.t_max))
            .fold(0.0, |bound, s| s.sigma_bar.max(bound));
        assert!(
            value <= bound * 1.000_1 + 1e-5,
            "{ray:?} at {t}: {value} over {bound}"
        );
    }
}

/// A field that counts how often it is asked, with its own cells or a single one.
#[derive(Debug)]
struct Counted {
    grid: SparseGrid,
    one_cell: bool,
    lookups: AtomicU64,
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
        self.grid.range(region)
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

/// Puffs that fill 5 % of 256³ voxels: ten times fewer lookups than with one bound for all.
#[test]
fn empty_space_is_skipped() {
    let mut random = rng(6);
    let puffs: Vec<_> = (0..20)
        .map(|_| 30.0 + 196.0 * Vec3::from(random.next()))
        .collect();
    let mut grid = SparseBuilder::new(0.0_f32);
    for i in 0..32_i32.pow(3) {
        let origin = 8 * IVec3::new(i / 1024, i / 32 % 32, i % 32);
        let mut values = [0.0; 512];
        for (slot, value) in values.iter_mut().enumerate() {
            let [x, y, z] = [slot >> 6, (slot >> 3) & 7, slot & 7].map(|i| i as i32);
            let p = (origin + IVec3::new(x, y, z)).as_vec3();
            let near = puffs
                .iter()
                .map(|c| p.distance(*c))
                .fold(f32::MAX, f32::min);
            *value = (1.0 - near / 22.0).max(0.0) * (0.5 + 0.5 * random.next_1d());
        }
        if values.iter().any(|v| *v > 0.0) {
            grid.leaf(origin, &values, [u64::MAX; 8]).unwrap();
        }
    }
    let grid = grid
        .build(DAffine3::from_scale(DVec3::splat(1.0 / 256.0)))
        .unwrap();
    let mut lookups = [0; 2];
    for one_cell in [false, true] {
        let counted = Counted {
            grid: grid.clone(),
            one_cell,
            lookups: AtomicU64::new(0),
        };
        let medium = medium(counted, 100.0_f32);
        let mut random = rng(7);
        for _ in 0..2_000 {
            let direction = warp::uniform_sphere(random.next());
            let ray = Ray::new(Vec3::from(random.next()) - 2.0 * direction, direction);
            let _ = medium.transmittance(&ray, &mut random);
            let _ = medium.sample_free_flight(&ray, 1.0, &mut random);
        }
        lookups[usize::from(one_cell)] = medium.density().lookups.load(Ordering::Relaxed);
    }
    assert!(lookups[1] >= 10 * lookups[0], "{lookups:?}");
}

/// A ray through the centre of a single voxel crosses a tent of area one voxel, whatever its size.
#[test]
fn a_single_voxel_is_a_tent_at_every_scale() {
    for scale in [1e-6, 1.0, 1e6] {
        for density in [1e-6_f32, 1.0, 1e6] {
            let mut grid = SparseBuilder::new(0.0);
            grid.voxel(IVec3::new(5, -3, 1_000), density).unwrap();
            let grid = grid
                .build(DAffine3::from_scale(DVec3::splat(scale)))
                .unwrap();
            let sigma_t = (1.0 / (f64::from(density) * scale)) as f32;
            let medium = medium(grid, sigma_t);
            let center = (DVec3::new(5.0, -3.0, 1_000.0) * scale).as_vec3();
            let ray = Ray::new(center - 9.0 * scale as f32 * Vec3::X, Vec3::X);
            let mut random = rng(8);
            let moments: Moments = (0..100_000)
                .map(|_| f64::from(medium.transmittance(&ray, &mut random)))
                .collect();
            // Its place is known to 1e-4 of a voxel.
            let expected = (-1.0_f64).exp();
            let estimate = moments.estimate();
            let off = (estimate.mean - expected).abs();
            assert!(
                off < 6.0 * estimate.standard_error + 1e-4,
                "{scale} {density}: {off}"
            );
        }
    }
}

#[test]
fn what_no_medium_can_take_is_an_error() {
    let built = |value| {
        let mut grid = SparseBuilder::new(0.0_f32);
        grid.voxel(IVec3::ZERO, value).unwrap();
        let grid = grid.build(DAffine3::IDENTITY).unwrap();
        let coefficients = Coefficients {
            sigma_a: 1.0_f32,
            sigma_s: 1.0,
            emission: 0.0,
        };
        GridMedium::new(grid, coefficients, Phase::Isotropic).map(drop)
    };
    assert!(built(1.0).is_ok());
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(
            built(bad),
            Err(MediumError::Voxel {
                voxel: [0, 0, 0],
                ..
            })
        ));
    }
    assert!(matches!(built(1e30), Err(MediumError::TooDense { .. })));
}

#[test]
fn an_empty_medium_is_not_there() {
    let grid = SparseBuilder::new(0.0_f32).build(skewed()).unwrap();
    let medium = medium(grid, 1.0_f32);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let mut random = rng(9);
    assert_eq!(medium.transmittance(&ray, &mut random), 1.0);
    assert!(
        medium
            .sample_free_flight(&ray, 1.0, &mut random)
            .collision
            .is_none()
    );
    assert_eq!(medium.coefficients(Vec3::ZERO), Coefficients::default());
}
