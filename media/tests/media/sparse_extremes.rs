//! Media of sparse grids of extreme sizes, places, values and shapes.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::sparse::{
    Counted, check_bounds, cloud, column, medium, ray, skewed, transmitted,
};
use glam::{DAffine3, DMat3, DVec3, IVec3, Vec3};
use std::ops::ControlFlow::Continue;
use std::sync::atomic::Ordering;
use tyndall_core::{Coefficients, Medium, Ray, Sampler, warp};
use tyndall_media::{Field, Filter, GridMedium, Phase, Precision, SparseBuilder, SparseGrid};
use tyndall_testkit::{
    rng,
    stats::{Moments, check_means},
};

const FALSE_ALARM: f64 = 1e-6;

fn exact(grid: &SparseGrid, sigma_t: f32, ray: &Ray) -> f64 {
    (-f64::from(sigma_t) * column(grid, Filter::Trilinear, ray)).exp()
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
            let estimate = transmitted(&medium, &ray, 100_000, &mut rng(8));
            // Its place is known to 1e-4 of a voxel.
            let off = (estimate.mean - (-1.0_f64).exp()).abs();
            assert!(
                off < 6.0 * estimate.standard_error + 1e-4,
                "{scale} {density}: {off}"
            );
        }
    }
}

/// Leaves of noise at these places, in leaves.
fn leaves(places: impl IntoIterator<Item = IVec3>, to_world: DAffine3) -> SparseGrid {
    let mut random = rng(10);
    let mut grid = SparseBuilder::new(0.0);
    for place in places {
        let values = std::array::from_fn(|_| random.next_1d());
        grid.leaf(8 * place, &values, [u64::MAX; 8]).unwrap();
    }
    grid.build(to_world).unwrap()
}

/// Thirty-two leaves in 2048³ voxels: memory and bounds go with the leaves, and what is between them
/// is crossed.
#[test]
fn a_large_grid_costs_what_its_leaves_cost() {
    let mut random = rng(11);
    let mut place = || (256.0 * Vec3::from(random.next::<3>())).as_ivec3();
    let places: Vec<_> = (0..64).map(|_| place()).collect();
    let scale = DAffine3::from_scale(DVec3::splat(1.0 / 256.0));
    for n in [1, 8, 64] {
        let grid = leaves(places[..n].iter().copied(), scale);
        // A leaf: 2048 bytes, its mask, its range. A node of 16³ slots around each: two masks of
        // 640 bytes with their counts. One node of 32³ slots: 10 KiB.
        assert!(grid.bytes() < 3584 * n + 12_288, "{} of {n}", grid.bytes());
        let counted = medium(Counted::new(grid, false), 200.0_f32);
        let ranges = &counted.density().ranges;
        let [asked, filled] = [&ranges[0], &ranges[1]].map(|n| n.load(Ordering::Relaxed) as usize);
        // Cells overlap a leaf by half a voxel and interpolation reaches one further: 27 cells see
        // it, and 8 nodes on each of two levels; each node asks for its 512 children.
        assert!(filled <= 2 + 43 * n, "{filled} of {n}");
        assert!(asked <= 2 + 512 * (1 + 16 * n), "{asked} of {n}");
    }
    let grid = leaves(places, scale);
    let whole = medium(grid.clone(), 50.0_f32);
    let mut cases = Vec::new();
    let mut random = rng(12);
    grid.visit(|origin, _| {
        let center = (origin.as_vec3() + 8.0 * Vec3::from(random.next::<3>())) / 256.0;
        let direction = warp::uniform_sphere(random.next());
        let ray = Ray::new(center - 20.0 * direction, direction);
        let estimate = transmitted(&whole, &ray, 4_000, &mut random);
        cases.push(("transmittance", estimate, exact(&grid, 50.0, &ray)));
        check_bounds(&grid, &whole, &ray, 40.0);
    });
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// The first and the last leaf that can be counted, each seen from where the transform puts it near
/// the origin.
#[test]
fn the_ends_of_the_index_space_are_media() {
    for at in [
        IVec3::splat(1 << 30),
        IVec3::new(1 << 30, -(1 << 30), 0),
        IVec3::splat(i32::MIN),
        IVec3::splat(i32::MAX - 7),
    ] {
        let near = DAffine3::from_translation(-at.as_dvec3() - 3.5);
        let grid = leaves([at / 8], near);
        assert_eq!(grid.content(), Some([at, at + 7]));
        let medium = medium(grid.clone(), 0.3_f32);
        let mut random = rng(13);
        let mut cases = Vec::new();
        for _ in 0..50 {
            // Within the leaf: a voxel beyond the last cannot be counted.
            let place = 6.8 * (Vec3::from(random.next::<3>()) - 0.5);
            let ray = Ray::new(place, warp::uniform_sphere(random.next())).up_to(2.0);
            let inside = |p: Vec3| p.abs().max_element() < 3.5;
            if inside(ray.at(2.0)) {
                let estimate = transmitted(&medium, &ray, 2_000, &mut random);
                cases.push(("transmittance", estimate, exact(&grid, 0.3, &ray)));
            }
            check_bounds(&grid, &medium, &ray, 2.0);
        }
        assert!(cases.len() > 10);
        check_means(&cases, FALSE_ALARM).unwrap();
    }
}

/// Two leaves 2³¹ voxels apart: what is between them costs nothing, whatever the leaves hold.
#[test]
fn the_widest_grid_is_a_medium() {
    let ends = [IVec3::splat(-(1 << 27)), IVec3::splat((1 << 27) - 1)];
    let scale = DAffine3::from_scale(DVec3::splat(1e-6));
    let grid = leaves(ends, scale);
    let coefficients = Coefficients {
        sigma_a: 1e6,
        sigma_s: 0.0_f32,
        emission: 0.0,
    };
    let medium = GridMedium::new(grid.clone(), coefficients, Phase::Isotropic).unwrap();
    let mut random = rng(14);
    let origin = scale.transform_point3((8 * ends[0]).as_dvec3()).as_vec3();
    let toward = Ray::new(2.0 * origin, -origin.normalize());
    for _ in 0..1_000 {
        let transmittance = medium.transmittance(&toward, &mut random);
        assert!((0.0..=1.0).contains(&transmittance), "{transmittance}");
        let flight = medium.sample_free_flight(&toward, 1.0, &mut random);
        assert!(flight.weight.is_finite());
    }
    // Nothing else is there but the ends.
    let mut length = 0.0;
    medium.majorants(&toward, |majorant| {
        assert!(majorant.sigma_bar.is_finite());
        length += majorant.t_max - majorant.t_min;
        Continue(())
    });
    assert!(length < 0.01, "{length}");
}

/// Thirteen leaves, each ten times as dense as the last: what is thin emits what it should, what is
/// dense hides what is behind it.
#[test]
fn densities_span_twelve_decades() {
    const VOXEL: f64 = 0.05;
    let decade = |k: i32| 10_f32.powi(k - 6);
    let mut grid = SparseBuilder::new(0.0);
    let mut random = rng(15);
    for k in 0..13 {
        let values = std::array::from_fn(|_| decade(k) * (0.5 + random.next_1d()));
        let origin = IVec3::new(16 * k, 0, 0);
        grid.leaf(origin, &values, [u64::MAX; 8]).unwrap();
    }
    let grid = grid
        .build(DAffine3::from_scale(DVec3::splat(VOXEL)))
        .unwrap();
    let coefficients = Coefficients {
        sigma_a: 0.25_f32,
        sigma_s: 0.25,
        emission: 3.0,
    };
    let medium = GridMedium::new(grid.clone(), coefficients, Phase::Isotropic).unwrap();
    let at = |x: f64, y: f64| (VOXEL * DVec3::new(x, y, 3.3)).as_vec3();
    // The bound of a leaf reaches half a voxel into what is empty before it: up to 3e5 null
    // collisions a sample.
    let samples = |k: i32| if k < 9 { 20_000 } else { 50 };
    let across = |k| {
        (
            Ray::new(at(f64::from(16 * k) + 3.7, -20.0), Vec3::Y),
            samples(k),
        )
    };
    let along = [(-20.0, Vec3::X), (230.0, Vec3::NEG_X)];
    let along = along.map(|(x, direction)| (Ray::new(at(x, 4.2), direction), samples(12)));
    let (mut emitted, mut passed) = (Vec::new(), Vec::new());
    for (ray, samples) in (0..13).map(across).chain(along) {
        let depth = 0.5 * column(&grid, Filter::Trilinear, &ray);
        let moments: Moments = (0..samples)
            .map(|_| f64::from(medium.emitted(&ray, &mut random)))
            .collect();
        // The source function is emission over σt.
        let expected = -6.0 * (-depth).exp_m1();
        emitted.push(("emitted", moments.estimate(), expected));
        // Thinner than that, nothing is seen of it.
        assert!(
            moments.estimate().standard_error < 0.05 * expected,
            "{ray:?}"
        );
        let estimate = transmitted(&medium, &ray, samples, &mut random);
        // Where little comes from a few samples, their mean is not normal.
        if depth < 2.0 {
            passed.push(("transmittance", estimate, (-depth).exp()));
        } else {
            assert!(estimate.mean < 0.5, "{ray:?}");
        }
    }
    check_means(&emitted, FALSE_ALARM).unwrap();
    check_means(&passed, FALSE_ALARM).unwrap();
}

fn transforms() -> Vec<(&'static str, DAffine3)> {
    let sheared = DMat3::from_cols(
        DVec3::X,
        DVec3::new(5.0, 1.0, 0.0),
        DVec3::new(0.0, -3.0, 1.0),
    );
    let far = DAffine3::from_translation(DVec3::new(100.0, -50.0, 20.0));
    vec![
        ("skewed", skewed()),
        ("mirrored", DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
        ("point-mirrored", far * DAffine3::from_scale(DVec3::NEG_ONE)),
        (
            "axes exchanged",
            DAffine3::from_mat3(DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::Z)),
        ),
        ("sheared", DAffine3::from_mat3(sheared)),
        ("needles", DAffine3::from_scale(DVec3::new(1e-3, 1.0, -1e3))),
        ("tiny", DAffine3::from_scale(DVec3::splat(1e-6))),
        ("huge", DAffine3::from_scale(DVec3::splat(1e6))),
        (
            "tiny and skewed",
            DAffine3::from_scale(DVec3::splat(1e-6)) * skewed(),
        ),
        (
            "huge and skewed",
            DAffine3::from_scale(DVec3::splat(1e6)) * skewed(),
        ),
    ]
}

/// ∫ Tr dt to the end of the ray, by Simpson's rule: the mean length of free flights that end there.
fn mean_flight(grid: &SparseGrid, sigma_t: f32, ray: &Ray) -> f64 {
    const PIECES: i32 = 256;
    let end = f64::from(ray.t_max);
    let sum: f64 = (0..=PIECES)
        .map(|i| {
            let weight = match i {
                0 | PIECES => 1.0,
                _ => f64::from(2 + 2 * (i % 2)),
            };
            let t = end * f64::from(i) / f64::from(PIECES);
            weight * exact(grid, sigma_t, &ray.up_to(t as f32))
        })
        .sum();
    sum * end / f64::from(3 * PIECES)
}

/// Transmittance, the mean of free flights and majorants where voxels are of any shape and size.
#[test]
fn voxels_may_have_any_shape() {
    for (name, to_world) in transforms() {
        let grid = cloud(to_world, Precision::Single);
        let mut random = rng(16);
        let (mut passed, mut flown) = (Vec::new(), Vec::new());
        let longest = Field::bounds(&grid).size().length();
        let sigma_t = 6.0 / longest;
        let medium = medium(grid.clone(), sigma_t);
        for i in 0..300 {
            let ray = ray(to_world, &mut random);
            check_bounds(&grid, &medium, &ray, 2.0 * longest);
            let expected = exact(&grid, sigma_t, &ray);
            let estimate = transmitted(&medium, &ray, 500, &mut random);
            passed.push((name, estimate, expected));
            if ray.t_max.is_finite() && i % 8 == 0 {
                let moments: Moments = (0..2_000)
                    .map(|_| {
                        let flight = medium.sample_free_flight(&ray, 1.0, &mut random);
                        f64::from(flight.collision.map_or(ray.t_max, |c| c.t))
                    })
                    .collect();
                flown.push((name, moments.estimate(), mean_flight(&grid, sigma_t, &ray)));
            }
        }
        let seen = |(_, _, tr): &&(&str, _, f64)| (0.1..0.9).contains(tr);
        assert!(passed.iter().filter(seen).count() > 30, "{name}");
        check_means(&passed, FALSE_ALARM).unwrap();
        check_means(&flown, FALSE_ALARM).unwrap();
    }
}
