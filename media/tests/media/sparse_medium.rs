//! Media of sparse grids: against quadrature, closed forms and what a single bound would cost.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::sparse::{Counted, check_bounds, cloud, column, medium, ray, skewed};
use glam::{DAffine3, DVec3, IVec3, Vec3};
use std::sync::atomic::Ordering;
use tyndall_core::{Coefficients, Medium, Ray, Rgb, Sampler, Spectrum, warp};
use tyndall_media::{Filter, GridMedium, Phase, Precision, SparseBuilder};
use tyndall_testkit::{
    rng,
    stats::{Moments, check_means, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;

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
            let depth = sigma_t.map(|s| s * column(&grid, Filter::Trilinear, &ray) as f32);
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
    let depth = |t: f64| 0.8 * column(&grid, Filter::Trilinear, &ray.up_to(t as f32));
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
        let expected = -3.0 * (-column(&grid, Filter::Trilinear, &ray)).exp_m1();
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
            check_bounds(&grid, &medium, &ray, 200.0);
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
        let counted = Counted::new(grid.clone(), one_cell);
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
