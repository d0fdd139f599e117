//! Trees over boxes of any kind.

use crate::scenes::{PLACES, Places, centers, direction, ray};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_bvh::{BuildError, Bvh, LEAF, Quality};
use tyndall_core::warp::uniform_sphere;
use tyndall_core::{Aabb, Ray, Sampler};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, assert_mean};

/// Where the ray is inside the box, its boundary included; exact but for rounding in `f64`.
fn interval(bounds: Aabb, ray: &Ray) -> Option<(f64, f64)> {
    let (mut near, mut far) = (0.0, f64::from(ray.t_max));
    for axis in 0..3 {
        let [min, max, origin, direction] =
            [bounds.min, bounds.max, ray.origin, ray.direction].map(|v| f64::from(v[axis]));
        if direction == 0.0 {
            if origin < min || max < origin {
                return None;
            }
        } else {
            let [a, b] = [min, max].map(|plane| (plane - origin) / direction);
            (near, far) = (f64::max(near, a.min(b)), f64::min(far, a.max(b)));
        }
    }
    (near <= far).then_some((near, far))
}

/// Points, needles, sheets and bricks.
#[test]
fn no_box_is_missed_and_no_leaf_met_twice() {
    let mut random = rng(20);
    for places in PLACES {
        for count in [1, 64, 65, 3000] {
            let bounds: Vec<_> = centers(places, count, &mut random)
                .into_iter()
                .map(|center| {
                    let size =
                        Vec3::from_array([(); 3].map(|()| (random.next_1d() - 0.5).max(0.0)));
                    Aabb {
                        min: center,
                        max: center + 0.5 * size,
                    }
                })
                .collect();
            let corners: Vec<_> = bounds
                .iter()
                .map(|b| (b.min, b.size().max_element()))
                .collect();
            for quality in [Quality::Fast, Quality::High] {
                let (tree, order) = Bvh::build(&bounds, quality).expect("good boxes");
                let of_slot = |slot: usize| bounds[order[slot] as usize];
                assert_eq!(tree.validate(of_slot), Ok(()));
                for _ in 0..200 {
                    let ray = ray(&corners, 1.0, &mut random);
                    let mut seen = vec![false; count];
                    tree.traverse(&ray, |slots| {
                        for slot in slots {
                            assert!(!std::mem::replace(&mut seen[slot], true), "{slot} twice");
                        }
                    });
                    for (slot, seen) in seen.into_iter().enumerate() {
                        assert!(
                            seen || interval(of_slot(slot), &ray).is_none(),
                            "{:?} {ray:?}",
                            of_slot(slot)
                        );
                    }
                }
            }
        }
    }
}

/// A tree over what lies in a row is asked for little of it.
#[test]
fn leaves_off_the_ray_are_not_met() {
    let bounds: Vec<_> = (0..64_000)
        .map(|i| Aabb::of_points([Vec3::X * i as f32, Vec3::X * i as f32 + 0.5]))
        .collect();
    for quality in [Quality::Fast, Quality::High] {
        let (tree, _) = Bvh::build(&bounds, quality).expect("good boxes");
        let mut met = 0;
        let across = Ray::new(Vec3::new(7000.2, 0.2, -5.0), Vec3::Z);
        tree.traverse(&across, |slots| met += slots.len());
        assert_eq!(met, 64);
        let short = Ray::new(Vec3::new(7000.2, 0.2, 0.1), Vec3::X).up_to(100.0);
        met = 0;
        tree.traverse(&short, |slots| met += slots.len());
        assert!((100..=192).contains(&met), "{met}");
    }
}

#[test]
fn bad_boxes_are_errors() {
    let build = |min: Vec3, max: Vec3| {
        let good = Aabb::of_points([Vec3::ZERO, Vec3::ONE]);
        Bvh::build(&[good, Aabb { min, max }], Quality::High).map(|_| ())
    };
    let index = 1;
    assert_eq!(
        build(Vec3::ONE, Vec3::ZERO),
        Err(BuildError::Empty { index })
    );
    assert_eq!(
        build(Vec3::INFINITY, Vec3::NEG_INFINITY),
        Err(BuildError::Empty { index })
    );
    for bad in [Vec3::NAN, Vec3::INFINITY, Vec3::splat(1.1e18)] {
        assert_eq!(build(Vec3::ZERO, bad), Err(BuildError::NotFinite { index }));
    }
    assert_eq!(build(Vec3::ZERO, Vec3::ZERO), Ok(()));
}

#[test]
fn no_boxes_make_an_empty_tree() {
    let (tree, order) = Bvh::build(&[], Quality::Fast).expect("nothing is good");
    assert!(tree.is_empty() && order.is_empty() && tree.bytes() == 0);
    tree.traverse(&Ray::new(Vec3::ZERO, Vec3::Z), |_| panic!("met"));
}

/// Rays that end where they enter a box, as near as an `f32` can say.
#[test]
fn boxes_that_begin_where_the_ray_ends_are_met() {
    let mut random = rng(22);
    let mut ends = 0;
    for _ in 0..20_000 {
        let center = Vec3::from_array(random.next()) - 0.5;
        let size = Vec3::from_array(random.next());
        let bounds = Aabb {
            min: center - size,
            max: center + size,
        };
        let direction = uniform_sphere(random.next());
        let target = center + size * (Vec3::from_array(random.next()) - 0.5);
        let ray = Ray::new(target - 30.0 * direction, direction);
        let (entry, _) = interval(bounds, &ray).expect("aimed at the box");
        let t_max = entry as f32;
        let t_max = if f64::from(t_max) < entry {
            t_max.next_up()
        } else {
            t_max
        };
        let (tree, _) = Bvh::build(&[bounds], Quality::Fast).expect("a good box");
        tree.traverse(&ray.up_to(t_max), |_| ends += 1);
        tree.traverse(&ray.up_to(t_max * (1.0 - 1e-5)), |_| panic!("too early"));
    }
    assert_eq!(ends, 20_000);
}

/// Needles of all lengths among one another: what `High` is for. A line through a sphere of radius
/// R, all lines alike, meets a box of surface S in it with probability S/(4πR²) (Cauchy): so many
/// slots are leaves expected to show, in either quality, and those of `High` fewer by the tenth
/// that the README promises.
#[test]
fn high_quality_shows_rays_less_where_sizes_differ() {
    const RADIUS: f32 = 2.0;
    const RAYS: u32 = 4000;
    let mut random = rng(21);
    let bounds: Vec<_> = centers(Places::Uniform, 20_000, &mut random)
        .into_iter()
        .map(|from| {
            let length = 10_f32.powf(-3.0 * random.next_1d());
            Aabb::of_points([from, from + length * direction(&mut random)])
        })
        .collect();
    let [fast, high] = [Quality::Fast, Quality::High].map(|quality| {
        let (tree, order) = Bvh::build(&bounds, quality).expect("good boxes");
        let leaf = |slots: &[u32]| {
            let boxes = slots.iter().map(|&index| bounds[index as usize]);
            let size = boxes.fold(Aabb::EMPTY, Aabb::union).size().as_dvec3();
            slots.len() as f64 * 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
        };
        let surfaces: f64 = order.chunks(LEAF).map(leaf).sum();
        let expected = surfaces / (4.0 * PI * f64::from(RADIUS).powi(2));
        let mut mean = Moments::new();
        for _ in 0..RAYS {
            let direction = uniform_sphere(random.next());
            let [radius, angle] = random.next();
            let (sin, cos) = (std::f32::consts::TAU * angle).sin_cos();
            let (x, y) = direction.any_orthonormal_pair();
            let aside = RADIUS * radius.sqrt() * (cos * x + sin * y);
            let mut shown = 0;
            tree.traverse(&Ray::new(aside - 5.0 * direction, direction), |slots| {
                shown += slots.len()
            });
            mean.push(shown as f64);
        }
        let name = format!("slots shown by {quality:?}");
        assert_mean(&name, mean.estimate(), expected, 1e-6);
        expected
    });
    assert!(high < 0.9 * fast, "{high} of {fast}");
}
