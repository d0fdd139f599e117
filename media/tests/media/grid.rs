//! Lookups, exact line integrals and majorants of grids.

use crate::support::rays::{BOUNDS, awkward_rays, noise, ray};
use glam::Vec3;
use std::ops::ControlFlow;
use tyndall_core::{Aabb, Coefficients, Majorant, Medium, Ray, Rgb, Spectrum};
use tyndall_media::{DenseGrid, Filter, GridMedium, MediumError, Phase, plume};
use tyndall_testkit::rng;

/// What Mitsuba 3.9.1 reads from the same 12 values, `gridvolume` with `wrap_mode` clamp (its
/// default), under `to_world` = translate(−1, 2, 0)·scale(3, 1, ½): point, trilinear, nearest.
const MITSUBA: [([f32; 3], f32, f32); 10] = [
    ([-0.94, 2.52, 0.485], 3.19, 2.5),
    ([0.5, 2.999, 0.005], 3.0, 3.0),
    ([-0.985, 2.821, 0.3985], 2.5, 2.5),
    ([0.404, 2.303, 0.139], 1.90765, 2.0),
    ([-0.235, 2.445, 0.2525], 1.822273, 4.0),
    ([0.659, 2.996, 0.3965], 0.86925, 0.75),
    ([0.866, 2.989, 0.1075], 1.9935, 3.0),
    ([-0.52, 2.613, 0.022], 0.137, 0.0),
    ([-0.892, 2.515, 0.233], 1.51804, 0.0),
    ([1.751, 2.629, 0.257], 0.819976, 1.5),
];

#[test]
fn reads_as_mitsuba_does() {
    let values = vec![
        0.5, 2.0, 1.0, 0.0, 3.0, 0.25, 4.0, 1.0, 0.125, 2.5, 0.75, 1.5,
    ];
    let (min, max) = (Vec3::new(-1.0, 2.0, 0.0), Vec3::new(2.0, 3.0, 0.5));
    let linear = DenseGrid::new([3, 2, 2], Aabb { min, max }, values).unwrap();
    let nearest = linear.clone().with_filter(Filter::Nearest);
    for (p, trilinear, constant) in MITSUBA {
        let p = Vec3::from(p);
        assert!((linear.lookup(p) - trilinear).abs() < 1e-5, "{p}");
        assert_eq!(nearest.lookup(p), constant, "{p}");
    }
}

/// ∫ by the midpoint rule, off by at most half a step times the jump at each discontinuity.
fn midpoint(grid: &DenseGrid, ray: &Ray) -> f64 {
    const STEPS: usize = 40_000;
    let inside = |p: Vec3| BOUNDS.contains(p);
    let (near, far) = (0.0, f64::from(ray.t_max.min(40.0)));
    let h = (far - near) / STEPS as f64;
    let value = |i: usize| {
        let p = ray.at(((i as f64 + 0.5) * h) as f32);
        if inside(p) {
            f64::from(grid.lookup(p))
        } else {
            0.0
        }
    };
    (0..STEPS).map(value).sum::<f64>() * h
}

#[test]
fn line_integrals_are_exact() {
    let resolution = [13, 7, 20];
    let mut sampler = rng(1);
    let linear = noise(resolution, &mut sampler);
    let nearest = linear.clone().with_filter(Filter::Nearest);
    let random = (0..100).map(|_| ray(&mut sampler));
    for ray in random.chain(awkward_rays(resolution).into_iter().step_by(5)) {
        // A step of 1e-3 at most at each end and at each of about 40 discontinuities of at most 1.
        let numeric = midpoint(&linear, &ray);
        let exact = linear.line_integral(&ray);
        assert!(
            (exact - numeric).abs() < 2e-3,
            "{ray:?}: {exact} for {numeric}"
        );
        // A ray within a face of voxels belongs to either side.
        let on_a_plane = (0..3).any(|i| ray.direction[i] == 0.0);
        let numeric = midpoint(&nearest, &ray);
        let exact = nearest.line_integral(&ray);
        let near = (exact - numeric).abs() < 2e-2;
        assert!(
            near || on_a_plane,
            "nearest, {ray:?}: {exact} for {numeric}"
        );
    }
}

/// Splitting a ray changes nothing, to the rounding of `f64` and of interpolation in `f32`.
#[test]
fn line_integrals_add_up() {
    let mut sampler = rng(2);
    let grid = noise([40, 30, 50], &mut sampler);
    for _ in 0..1000 {
        let ray = ray(&mut sampler).up_to(10.0);
        let whole = grid.line_integral(&ray);
        let parts: f64 = (0..8)
            .map(|i| {
                let start = 1.25 * i as f32;
                grid.line_integral(&Ray::new(ray.at(start), ray.direction).up_to(1.25))
            })
            .sum();
        // The parts start at points rounded to 1e-6: their ends shift by as much.
        assert!((whole - parts).abs() < 1e-5, "{ray:?}: {whole}, {parts}");
    }
}

fn collect(medium: &impl Medium, ray: &Ray) -> Vec<Majorant> {
    let mut stretches = Vec::new();
    medium.majorants(ray, |stretch| {
        stretches.push(stretch);
        ControlFlow::Continue(())
    });
    stretches
}

fn grey(sigma_a: f32, sigma_s: f32, emission: f32) -> Coefficients<f32> {
    Coefficients {
        sigma_a,
        sigma_s,
        emission,
    }
}

/// On every ray, at every point: σt is at most the majorant of its stretch, and zero in gaps.
#[test]
fn majorants_bound_the_extinction() {
    for (seed, resolution) in [(3, [70, 9, 16]), (4, [1, 1, 1]), (5, [8, 17, 600])] {
        let mut sampler = rng(seed);
        for filter in [Filter::Trilinear, Filter::Nearest] {
            let grid = noise(resolution, &mut sampler).with_filter(filter);
            let medium = GridMedium::new(grid, grey(0.5, 2.0, 0.0), Phase::Isotropic).unwrap();
            let random = (0..300).map(|_| ray(&mut sampler));
            for ray in random.chain(awkward_rays(resolution)) {
                check_bounds(&medium, &ray);
            }
        }
    }
}

/// A lone voxel shines into the neighbouring majorant cell, wherever it stands.
#[test]
fn majorants_cover_the_footprint_of_interpolation() {
    for lone in 0..20 {
        let mut values = vec![0.0; 20];
        values[lone] = 1.0;
        let grid = DenseGrid::new([20, 1, 1], BOUNDS, values).unwrap();
        let medium = GridMedium::new(grid, grey(0.5, 2.0, 0.0), Phase::Isotropic).unwrap();
        check_bounds(
            &medium,
            &Ray::new(BOUNDS.center() - 2.0 * Vec3::X, Vec3::X).up_to(4.0),
        );
    }
}

fn check_bounds(medium: &GridMedium<f32>, ray: &Ray) {
    let stretches = collect(medium, ray);
    for pair in stretches.windows(2) {
        assert!(pair[0].t_max <= pair[1].t_min, "{ray:?}: {pair:?}");
    }
    for Majorant {
        t_min,
        t_max,
        sigma_bar,
    } in &stretches
    {
        let sound = 0.0 <= *t_min && t_min <= t_max && *t_max <= ray.t_max && *sigma_bar > 0.0;
        assert!(sound, "{ray:?}: [{t_min}, {t_max}], {sigma_bar}");
    }
    let far = ray.t_max.min(40.0);
    for i in 0..500 {
        let t = far * (i as f32 + 0.5) / 500.0;
        let sigma_t = medium.coefficients(ray.at(t)).sigma_t();
        // A point within rounding of a boundary may belong to either side.
        let bound = stretches
            .iter()
            .filter(|s| s.t_min - 1e-5 <= t && t <= s.t_max + 1e-5)
            .fold(0.0, |bound, s| s.sigma_bar.max(bound));
        let rounding = 1.0 + 1e-6;
        let outside = !inset(t, ray);
        assert!(
            sigma_t <= bound * rounding || outside,
            "{ray:?}, {t}: {sigma_t} over {bound}"
        );
    }
}

/// Whether the point is inside the box by more than rounding, in every axis in which the ray moves.
fn inset(t: f32, ray: &Ray) -> bool {
    let p = ray.at(t);
    (0..3).all(|i| {
        let margin = 1e-5 * ray.direction[i].abs().min(1.0);
        BOUNDS.min[i] + margin <= p[i] && p[i] <= BOUNDS.max[i] - margin
    })
}

#[test]
fn visits_stop_when_told() {
    let medium = plume([64; 3], BOUNDS, 1).unwrap();
    let medium = GridMedium::new(medium, grey(1.0, 1.0, 0.0), Phase::Isotropic).unwrap();
    let ray = Ray::new(BOUNDS.center() - 9.0 * Vec3::Y, Vec3::Y);
    assert!(collect(&medium, &ray).len() > 2);
    let mut visits = 0;
    medium.majorants(&ray, |_| {
        visits += 1;
        ControlFlow::Break(())
    });
    assert_eq!(visits, 1);
}

#[test]
fn emission_has_a_majorant() {
    let resolution = [32, 32, 32];
    let density = DenseGrid::new(resolution, BOUNDS, vec![0.0; 32768]).unwrap();
    let glow = DenseGrid::new([1, 1, 1], BOUNDS, vec![2.0]).unwrap();
    let dark = GridMedium::new(density, grey(1.0, 1.0, 1.0), Phase::Isotropic).unwrap();
    let ray = Ray::new(BOUNDS.center(), Vec3::Z);
    assert!(collect(&dark, &ray).is_empty());
    let bright = dark.with_emission(glow).unwrap();
    assert_eq!(collect(&bright, &ray)[0].t_min, 0.0);
}

#[test]
fn albedo_and_emission_have_grids_of_their_own() {
    let density = DenseGrid::new([1, 1, 1], BOUNDS, vec![2.0]).unwrap();
    let colours = vec![Rgb::new(1.0, 0.5, 0.0), Rgb::new(0.0, 0.5, 1.0)];
    let albedo = DenseGrid::new([2, 1, 1], BOUNDS, colours).unwrap();
    let glow = DenseGrid::new([1, 1, 2], BOUNDS, vec![0.0, 3.0]).unwrap();
    let per_density = Coefficients {
        sigma_a: Rgb::new(1.0, 2.0, 3.0),
        sigma_s: Rgb::new(0.0, 1.0, 2.0),
        emission: Rgb::splat(7.0),
    };
    let medium = GridMedium::new(density, per_density, Phase::Isotropic)
        .and_then(|m| m.with_albedo(albedo))
        .unwrap()
        .with_emission(glow.map(Rgb::splat).unwrap())
        .unwrap();
    let here = medium.coefficients(BOUNDS.min);
    assert_eq!(here.sigma_s, Rgb::new(2.0, 3.0, 0.0));
    assert_eq!(here.sigma_a, Rgb::new(0.0, 3.0, 10.0));
    assert_eq!(here.emission, Rgb::splat(0.0));
    assert_eq!(medium.coefficients(BOUNDS.max).emission, Rgb::splat(3.0));
    let beyond = BOUNDS.max + Vec3::splat(1e-3);
    assert_eq!(medium.coefficients(beyond), Coefficients::default());
}

#[test]
fn wrong_numbers_are_named() {
    let grid = |resolution, values: &[f32]| DenseGrid::new(resolution, BOUNDS, values.to_vec());
    let voxel = grid([2, 3, 1], &[0.0, 1.0, 1.0, -2.0, f32::NAN, 0.0]).unwrap_err();
    let expected = MediumError::Voxel {
        voxel: [1, 1, 0],
        channel: 0,
        value: -2.0,
    };
    assert_eq!(voxel, expected);
    assert!(
        voxel
            .to_string()
            .contains("voxel [1, 1, 0] of a grid is -2")
    );
    for value in [f32::NAN, f32::INFINITY] {
        let error = grid([1, 1, 1], &[value]).unwrap_err();
        assert!(matches!(
            error,
            MediumError::Voxel {
                voxel: [0, 0, 0],
                ..
            }
        ));
    }
    for resolution in [[2, 2, 2], [0, 1, 1], [usize::MAX, 2, 2]] {
        let error = grid(resolution, &[1.0]).unwrap_err();
        assert_eq!(
            error,
            MediumError::GridValues {
                resolution,
                values: 1
            }
        );
    }
    assert!(matches!(
        grid([0, 0, 0], &[]),
        Err(MediumError::GridValues { .. })
    ));
    let flat = Aabb {
        max: BOUNDS.max.with_y(BOUNDS.min.y),
        ..BOUNDS
    };
    let endless = Aabb {
        max: Vec3::INFINITY,
        ..BOUNDS
    };
    for bounds in [flat, endless, Aabb::EMPTY] {
        let error = DenseGrid::new([1, 1, 1], bounds, vec![1.0]).unwrap_err();
        assert_eq!(error, MediumError::GridBounds);
    }
    let dense = grid([1, 1, 1], &[1e30]).unwrap();
    let overflow = GridMedium::new(dense, grey(1e30, 0.0, 0.0), Phase::Isotropic).unwrap_err();
    assert!(matches!(
        overflow,
        MediumError::Coefficient {
            field: "sigma_a",
            ..
        }
    ));
    let medium = GridMedium::new(
        grid([1; 3], &[1.0]).unwrap(),
        grey(1.0, 1.0, 0.0),
        Phase::Isotropic,
    );
    let error = medium
        .unwrap()
        .with_albedo(grid([1, 2, 1], &[0.5, 1.5]).unwrap());
    let expected = MediumError::Albedo {
        channel: 0,
        value: 1.5,
    };
    assert_eq!(error.unwrap_err(), expected);
}

#[test]
fn the_plume_is_the_same_at_every_resolution() {
    let (coarse, fine) = (
        plume([24; 3], BOUNDS, 5).unwrap(),
        plume([72; 3], BOUNDS, 5).unwrap(),
    );
    // Every third centre of the finer grid is a centre of the coarser.
    for i in 0..24_usize.pow(3) {
        let voxel = Vec3::new((i % 24) as f32, (i / 24 % 24) as f32, (i / 576) as f32);
        let p = BOUNDS.min + BOUNDS.size() * (voxel + 0.5) / 24.0;
        assert!((coarse.lookup(p) - fine.lookup(p)).abs() < 1e-3, "{p}");
    }
    let outside_of_face = BOUNDS.center().with_x(BOUNDS.min.x);
    assert!(fine.max() > 0.9 && fine.lookup(outside_of_face) < 1e-2);
}
