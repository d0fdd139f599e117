//! Points sampled on shapes.

use crate::built;
use crate::random::Random;
use crate::scenes::{add_triangle, triangle};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;
use tyndall_core::{Anchor, Ray};
use tyndall_surface::{Mesh, Shape};

const SAMPLES: usize = 100_000;

/// Shapes with their areas and centres of mass.
fn shapes() -> [(Shape, f32, Vec3); 5] {
    let shift = Vec3::new(1.0, 2.0, 3.0);
    let linear = DMat3::from_cols(DVec3::X, DVec3::new(4.0, 0.0, -3.0), 7.0 * DVec3::Y);
    let mut mesh = Mesh::default();
    add_triangle(&mut mesh, [Vec3::ZERO, 3.0 * Vec3::X, 2.0 * Vec3::Y]);
    [
        (
            triangle([Vec3::ZERO, 3.0 * Vec3::X, 2.0 * Vec3::Y]),
            3.0,
            Vec3::new(1.0, 2.0 / 3.0, 0.0),
        ),
        (
            Shape::Instance {
                mesh: Arc::new(mesh),
                to_world: DAffine3::from_mat3_translation(linear, shift.as_dvec3()),
            },
            9.0,
            shift + Vec3::new(1.0 + 8.0 / 3.0, 0.0, -2.0),
        ),
        (
            Shape::Sphere {
                center: shift,
                radius: 0.5,
            },
            PI,
            shift,
        ),
        (
            Shape::Quad {
                corner: shift,
                edge_u: 3.0 * Vec3::X,
                edge_v: Vec3::new(1.0, 2.0, 0.0),
            },
            6.0,
            shift + Vec3::new(2.0, 1.0, 0.0),
        ),
        (
            Shape::Disk {
                center: shift,
                normal: Vec3::new(1.0, -2.0, 3.0),
                radius: 2.0,
            },
            4.0 * PI,
            shift,
        ),
    ]
}

/// The mean of many points is the centre of mass. 5 standard errors in each of 3 coordinates of 5
/// shapes: a false alarm in 100,000 seeds.
#[test]
fn points_are_uniform_by_area() {
    for (shape, area, centroid) in shapes() {
        let (_, surfaces) = built(&[shape]).next().expect("there is a backend");
        assert!((surfaces.area(0, 0) / area - 1.0).abs() < 1e-6);
        let mut random = Random::new(9);
        let (mut sum, mut squares) = ([0.0_f64; 3], [0.0_f64; 3]);
        for _ in 0..SAMPLES {
            let hit = surfaces.sample(0, 0, random.square());
            let apart = surfaces.surface(&hit).position - centroid;
            for axis in 0..3 {
                let x = f64::from(apart[axis]);
                sum[axis] += x;
                squares[axis] += x * x;
            }
        }
        for axis in 0..3 {
            let count = SAMPLES as f64;
            let error = (squares[axis] / count).sqrt() / count.sqrt();
            let mean = sum[axis] / count;
            assert!(
                mean.abs() <= 5.0 * error + 1e-6,
                "axis {axis}: {mean} ± {error}"
            );
        }
    }
}

/// The second moment about the centre, r²/2 = 2, tells a disc that is uniform by area from one that
/// is uniform by radius, r²/3. The standard deviation of ρ² is r²/√12: 5 standard errors, a false
/// alarm in 2 million seeds.
#[test]
fn a_disc_is_uniform_by_area() {
    let [.., (disk, _, center)] = shapes();
    let (_, surfaces) = built(&[disk]).next().expect("there is a backend");
    let mut random = Random::new(10);
    let sum: f64 = (0..SAMPLES)
        .map(|_| {
            let hit = surfaces.sample(0, 0, random.square());
            f64::from(surfaces.surface(&hit).position.distance_squared(center))
        })
        .sum();
    let mean = sum / SAMPLES as f64;
    let error = 4.0 / 12_f64.sqrt() / (SAMPLES as f64).sqrt();
    assert!((mean - 2.0).abs() <= 5.0 * error, "{mean} ± {error}");
}

/// What is sampled can be found by a ray, at the same place.
#[test]
fn sampled_points_are_hit() {
    for (shape, ..) in shapes() {
        for (backend, surfaces) in built(std::slice::from_ref(&shape)) {
            let mut random = Random::new(11);
            for _ in 0..1_000 {
                let sampled = surfaces.sample(0, 0, random.square());
                let surface = surfaces.surface(&sampled);
                let from = surface.position + 3.0 * surface.geometric_normal;
                let ray = surfaces.connect(&Anchor::Point(from), &Anchor::Surface(sampled));
                assert!(surfaces.intersect(&ray).is_none(), "{backend:?}: {ray:?}");
                let longer = Ray::new(ray.origin, ray.direction);
                // Rounding may push a point of the outline off the shape.
                if let Some((_, hit)) = surfaces.intersect(&longer) {
                    let found = surfaces.surface(&hit).position;
                    assert!(found.distance(surface.position) < 1e-5, "{backend:?}");
                }
            }
        }
    }
}
