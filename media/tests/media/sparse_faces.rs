//! Rays through media of sparse grids along the faces, edges and corners of voxels, leaves and nodes,
//! and rays that start, end or stay there.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::sparse::{check_bounds, column, medium, transmitted};
use glam::{DAffine3, DVec3, IVec3, Vec3};
use std::ops::ControlFlow::Continue;
use tyndall_core::{Medium, Ray, Sampler};
use tyndall_media::{Field, Filter, Precision, SparseBuilder, SparseGrid, TileSize};
use tyndall_testkit::{rng, stats::check_means};

const FALSE_ALARM: f64 = 1e-6;
const FILTERS: [Filter; 2] = [Filter::Trilinear, Filter::Nearest];
const SIGMA_T: f32 = 0.25;

/// Where voxels, leaves and both kinds of nodes meet.
const PLANES: [i32; 8] = [-4096, -128, -8, 0, 1, 8, 128, 4096];

/// Noise around (c, c, c) for each of the planes. Across one axis the voxels that begin (c > 0) or end
/// the leaves there stand out, so that bounds are wrong which leave them out.
fn corners(axis: usize, filter: Filter, precision: Precision) -> SparseGrid {
    let mut random = rng(1);
    let mut grid = SparseBuilder::new(0.0).with_precision(precision);
    for c in PLANES {
        for i in 0..7_i32.pow(3) {
            let offset = IVec3::new(i / 49, i / 7 % 7, i % 7) - 3;
            let stands_out = offset[axis] == if c > 0 { 0 } else { -1 };
            let most = if stands_out { 5.0 } else { 1.0 };
            grid.voxel(IVec3::splat(c) + offset, most * random.next_1d())
                .unwrap();
        }
    }
    let grid = grid.build(DAffine3::IDENTITY).unwrap();
    grid.with_filter(filter)
}

/// x, y and z in the order that begins with this axis.
fn turned(axis: usize, [x, y, z]: [f32; 3]) -> Vec3 {
    let mut turned = Vec3::ZERO;
    turned[axis] = x;
    turned[(axis + 1) % 3] = y;
    turned[(axis + 2) % 3] = z;
    turned
}

/// Along each axis, both ways, on the planes and half a voxel beside them; and in the diagonals of
/// faces and of space through the corner.
fn rays(c: f32) -> Vec<Ray> {
    let mut rays = Vec::new();
    let sides = [-0.5, 0.0, 0.5];
    for (y, z) in sides.into_iter().flat_map(|y| sides.map(|z| (y, z))) {
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let origin = turned(axis, [c - 10.0 * sign, c + y, c + z]);
                rays.push(Ray::new(origin, turned(axis, [sign, 0.0, -0.0])));
            }
        }
        let corner = Vec3::splat(c);
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let across = turned(axis, [sign, 1.0, 0.0]);
                let origin = corner + turned(axis, [0.0, y, z]) - 8.0 * across;
                rays.push(Ray::new(origin, across.normalize()));
            }
        }
        for space in [
            Vec3::ONE,
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(-1.0, -1.0, 1.0),
        ] {
            rays.push(Ray::new(corner - y - 8.0 * space, space.normalize()));
        }
    }
    rays
}

/// Ends within the voxels around one corner: the others are not met.
fn tested(axis: usize, filter: Filter, precision: Precision) {
    let grid = corners(axis, filter, precision);
    let medium = medium(grid.clone(), SIGMA_T);
    let mut random = rng(2);
    let mut cases = Vec::new();
    for c in PLANES {
        for ray in rays(c as f32) {
            let ray = ray.up_to(30.0);
            check_bounds(&grid, &medium, &ray, 30.0);
            let expected = (-f64::from(SIGMA_T) * column(&grid, filter, &ray)).exp();
            let estimate = transmitted(&medium, &ray, 500, &mut random);
            // Where little comes from a few samples, their mean is not normal.
            if expected > 0.1 {
                cases.push(("transmittance", estimate, expected));
            }
        }
    }
    assert!(cases.len() > 250, "{}", cases.len());
    check_means(&cases, FALSE_ALARM).unwrap();
}

#[test]
fn rays_along_faces_edges_and_corners_meet_what_is_read_there() {
    for filter in FILTERS {
        tested(0, filter, Precision::Single);
        tested(1, filter, Precision::Half);
        tested(2, filter, Precision::Single);
    }
}

/// Cubes of one value, of every size of tile: transmittance is exact along their faces, just inside
/// of them and beyond.
#[test]
fn rays_along_tiles_are_exact() {
    for (size, edge) in [
        (TileSize::Leaf, 8.0),
        (TileSize::Lower, 128.0),
        (TileSize::Upper, 4096.0),
    ] {
        for filter in FILTERS {
            let mut grid = SparseBuilder::new(0.0);
            grid.tile(IVec3::ZERO, size, 0.5, true).unwrap();
            let grid = grid.build(DAffine3::IDENTITY).unwrap();
            let grid = grid.with_filter(filter);
            let medium = medium(grid.clone(), 2.0 / edge);
            let mut random = rng(3);
            let mut cases = Vec::new();
            // Voxels of the value have their centres at 0 to `edge` - 1.
            for y in [-1.25, -0.75, -0.5, -0.25, 0.0, 1.0, edge - 1.0, edge - 0.75] {
                for axis in 0..3 {
                    let origin = turned(axis, [-10.0, y, 0.5 * edge]);
                    let ray = Ray::new(origin, turned(axis, [1.0, 0.0, 0.0]));
                    let expected = (-f64::from(2.0 / edge) * column(&grid, filter, &ray)).exp();
                    let estimate = transmitted(&medium, &ray, 1_000, &mut random);
                    cases.push(("tile", estimate, expected));
                }
            }
            check_means(&cases, FALSE_ALARM).unwrap();
        }
    }
}

/// From and to the faces of the box, of cells and of voxels, the corners, and nowhere.
#[test]
fn rays_may_start_and_end_on_a_boundary() {
    for filter in FILTERS {
        let grid = corners(0, filter, Precision::Single);
        let medium = medium(grid.clone(), SIGMA_T);
        let bounds = Field::bounds(&grid);
        let mut random = rng(4);
        let mut cases = Vec::new();
        let starts =
            [-4.0, -3.5, -0.5, 0.0, 0.5, 3.5, 4.0].map(|x| Vec3::new(x, x.abs() - 1.0, 0.5));
        for start in starts.into_iter().chain([bounds.min, bounds.max]) {
            for axis in 0..3 {
                for direction in [
                    turned(axis, [1.0, 0.0, 0.0]),
                    turned(axis, [-1.0, 0.0, 0.0]),
                ] {
                    for length in [0.0, f32::MIN_POSITIVE, 1e-6, 0.5, 3.5, f32::INFINITY] {
                        let ray = Ray::new(start, direction).up_to(length);
                        let expected = (-f64::from(SIGMA_T) * column(&grid, filter, &ray)).exp();
                        let estimate = transmitted(&medium, &ray, 200, &mut random);
                        cases.push(("transmittance", estimate, expected));
                    }
                }
            }
        }
        check_means(&cases, FALSE_ALARM).unwrap();
    }
}

#[test]
fn rays_of_no_length_meet_nothing() {
    let grid = corners(0, Filter::Trilinear, Precision::Single);
    let medium = medium(grid, 100.0_f32);
    let mut random = rng(5);
    for c in PLANES {
        let ray = Ray::new(Vec3::splat(c as f32), Vec3::X).up_to(0.0);
        for _ in 0..100 {
            assert_eq!(medium.transmittance(&ray, &mut random), 1.0);
            let flight = medium.sample_free_flight(&ray, 1.0, &mut random);
            assert!(flight.collision.is_none() && flight.weight == 1.0);
        }
        let mut stretches = Vec::new();
        medium.majorants(&ray, |majorant| {
            stretches.push(majorant);
            Continue(())
        });
        assert_eq!(stretches, []);
    }
}

/// A voxel a millionth of the distance from the origin: places are known to 1/16 of it.
#[test]
fn grids_far_from_the_origin_are_read_to_the_rounding_of_places() {
    const ROUNDING: f64 = 1.0 / 16.0;
    for filter in FILTERS {
        let far = DVec3::new(1e6, -1e6, 1e6);
        let mut random = rng(6);
        let mut grid = SparseBuilder::new(0.0);
        for i in 0..24_i32.pow(3) {
            let voxel = IVec3::new(i / 576, i / 24 % 24, i % 24);
            grid.voxel(voxel, random.next_1d()).unwrap();
        }
        let grid = grid.build(DAffine3::from_translation(far)).unwrap();
        let grid = grid.with_filter(filter);
        let medium = medium(grid.clone(), 0.1_f32);
        for i in 0..100 {
            let place = 24.0 * Vec3::from(random.next::<3>());
            let direction = turned(i % 3, [1.0, 0.0, 0.0]);
            let origin = (far + place.as_dvec3()).as_vec3() - 40.0 * direction;
            let ray = Ray::new(origin, if i % 2 == 0 { direction } else { -direction });
            let ray = if i % 2 == 0 {
                ray
            } else {
                Ray::new(origin + 80.0 * direction, -direction)
            };
            check_bounds(&grid, &medium, &ray, 80.0);
            let expected = (-0.1 * column(&grid, filter, &ray)).exp();
            let estimate = transmitted(&medium, &ray, 1_000, &mut random);
            // Of 25 steps between voxels each moves by up to half a rounding, either way: linear
            // pieces lose the square of it at their ends.
            let bias = match filter {
                Filter::Nearest => 0.1 * 25.0 * 0.5 * ROUNDING,
                Filter::Trilinear => 0.1 * 25.0 * 2.0 * ROUNDING * ROUNDING / 8.0,
            };
            let off = (estimate.mean - expected).abs();
            assert!(off < 6.0 * estimate.standard_error + bias, "{ray:?}: {off}");
        }
    }
}
