//! Discs.

use crate::oracle::{Verdict, check_along, check_chords};
use crate::scenes::{PLACES, Places, centers, no_rays, radii, ray};
use glam::Vec3;
use tyndall_bvh::{BuildError, Discs, Quality};
use tyndall_core::{Ray, Sampler};
use tyndall_testkit::{TestSampler, rng};

/// Of one ray in five a rim is the target, of one in six a disc its end: about half as many discs as
/// are met for certain may be too close to call.
const AIMED: f64 = 0.5;

const QUALITIES: [Quality; 2] = [Quality::Fast, Quality::High];

fn build(centers: &[Vec3], radii: &[f32], quality: Quality) -> Discs {
    let discs = Discs::build(centers, radii, quality).expect("good discs");
    assert_eq!(discs.validate(), Ok(()));
    let mut order = discs.order().to_vec();
    for (slot, &index) in order.iter().enumerate() {
        assert_eq!(discs.center(slot), centers[index as usize]);
        assert_eq!(discs.radius(slot), radii[index as usize]);
    }
    order.sort_unstable();
    assert!(order.into_iter().eq(0..centers.len() as u32));
    discs
}

/// Holds rays through discs against brute force; `size` is that of the scene.
fn check(
    centers: &[Vec3],
    radii: &[f32],
    size: f32,
    rays: usize,
    random: &mut TestSampler,
) -> Verdict {
    let targets: Vec<_> = centers.iter().copied().zip(radii.iter().copied()).collect();
    let both = QUALITIES.map(|quality| build(centers, radii, quality));
    let mut sum = Verdict::default();
    for _ in 0..rays {
        let ray = ray(&targets, size, random);
        for discs in &both {
            for verdict in [check_along(discs, &ray), check_chords(discs, &ray)] {
                sum.met += verdict.met;
                sum.unsure += verdict.unsure;
            }
        }
    }
    sum
}

#[test]
fn few_and_many_in_all_places() {
    let mut random = rng(1);
    for count in [0, 1, 2, 8, 9, 63, 64, 65, 513, 4500] {
        for places in PLACES {
            let centers = centers(places, count, &mut random);
            let radius = 0.5 / (count as f32 + 1.0).cbrt();
            let radii = radii(radius, 0.3, count, &mut random);
            let verdict = check(&centers, &radii, 1.0, 40, &mut random);
            if count > 0 {
                verdict.assert(0, AIMED, (places, count));
            }
        }
    }
}

/// Of the discs at one point, those below the 2e-6 to which a place two units away is known are too
/// close to call: about seven decades in twelve.
#[test]
fn radii_over_twelve_decades() {
    let mut random = rng(2);
    for places in PLACES {
        let centers = centers(places, 3000, &mut random);
        let mut radii = radii(0.3, 12.0, 3000, &mut random);
        radii[..50].fill(0.0);
        let unsure = match places {
            Places::Coincident => 7.0 / 5.0,
            _ => AIMED,
        };
        check(&centers, &radii, 1.0, 60, &mut random).assert(1000, unsure, places);
    }
}

#[test]
fn scenes_of_any_scale() {
    let mut random = rng(3);
    for scale in [1e-12, 1e-8, 1e-3, 1e3, 1e8, 1e16] {
        let centers: Vec<_> = centers(Places::Uniform, 2000, &mut random)
            .into_iter()
            .map(|center| center * scale)
            .collect();
        let radii = radii(0.05 * scale, 1.0, 2000, &mut random);
        check(&centers, &radii, scale, 60, &mut random).assert(100, AIMED, scale);
    }
}

/// Centres in all corners of what is promised, with the largest radii and the smallest.
#[test]
fn places_and_radii_at_the_promised_extremes() {
    let mut random = rng(9);
    let corner = |i| Vec3::from_array([i, i / 2, i / 4].map(|i| (i % 2) as f32)) * 2.0 - 1.0;
    for (place, radius) in [(1e18, 1e18), (1e-18, 1e18), (1e-18, 1e-18)] {
        let centers: Vec<_> = (0..800).map(|i| place * corner(i)).collect();
        let verdict = check(&centers, &[radius; 800], radius, 100, &mut random);
        verdict.assert(1000, AIMED, (place, radius));
    }
}

#[test]
fn small_discs_far_from_the_origin() {
    let mut random = rng(4);
    let far = Vec3::new(1e4, -1e4, 1e4);
    let centers: Vec<_> = centers(Places::Uniform, 2000, &mut random)
        .into_iter()
        .map(|center| far + center)
        .collect();
    let radii = vec![1e-3; 2000];
    check(&centers, &radii, 1.0, 400, &mut random).assert(300, AIMED, far);
}

/// Of discs whose rim is nearer to the ray than their radius by a part in 2¹⁰, or farther.
#[test]
fn grazing_rays() {
    let mut random = rng(5);
    for quality in QUALITIES {
        for _ in 0..2000 {
            let direction = crate::scenes::direction(&mut random);
            let [distance, length] = random.next();
            let (distance, radius) = (50.0 * distance + 1.0, 10_f32.powf(-1.5 * length));
            let side = direction.any_orthonormal_vector();
            for (near, hits) in [(1.0 - 1.0 / 256.0, 1), (1.0 + 1.0 / 256.0, 0)] {
                let center = distance * direction + near * radius * side;
                let discs = build(&[center], &[radius], quality);
                let ray = Ray::new(Vec3::ZERO, direction);
                let mut met = [0, 0];
                discs.along(&ray, |_, _, _| met[0] += 1);
                discs.chords(&ray, |_, _, _| met[1] += 1);
                assert_eq!(met, [hits; 2], "{direction} {distance} {radius}");
            }
        }
    }
}

#[test]
fn a_hundred_thousand_at_one_point() {
    const COUNT: usize = 100_000;
    let center = Vec3::new(0.1, 0.2, 0.3);
    for quality in QUALITIES {
        let discs = build(&[center; COUNT], &[0.01; COUNT], quality);
        let ray = Ray::new(Vec3::new(0.1, 0.2, -1.0), Vec3::Z);
        assert_eq!(check_along(&discs, &ray).met, COUNT);
        assert_eq!(check_chords(&discs, &ray).met, COUNT);
        assert_eq!(check_along(&discs, &ray.up_to(1.2)).met, 0);
        let aside = Ray::new(ray.origin + 0.02 * Vec3::X, Vec3::Z);
        assert_eq!(check_along(&discs, &aside).met, 0);
    }
}

#[test]
fn behind_the_eye_and_beyond_the_end() {
    const NONE: [(f32, f32); 0] = [];
    for quality in QUALITIES {
        let discs = build(&[Vec3::ZERO], &[1.0], quality);
        let hits = |z: f32, t_max: f32| {
            let ray = Ray::new(Vec3::new(0.6, 0.0, z), Vec3::Z).up_to(t_max);
            let (mut along, mut chords) = (Vec::new(), Vec::new());
            discs.along(&ray, |_, t, d2| along.push((t, d2)));
            discs.chords(&ray, |_, t, d2| chords.push((t, d2)));
            (along, chords)
        };
        let d2 = 0.6 * 0.6;
        let both = |t| (vec![(t, d2)], vec![(t, d2)]);
        let sphere = |t| (NONE.to_vec(), vec![(t, d2)]);
        let none = || (NONE.to_vec(), NONE.to_vec());
        assert_eq!(hits(-2.0, f32::INFINITY), both(2.0));
        assert_eq!(hits(-2.0, 2.0), both(2.0));
        assert_eq!(hits(-2.0, 1.9), sphere(2.0));
        assert_eq!(hits(-2.0, 1.1), none());
        assert_eq!(hits(0.5, f32::INFINITY), sphere(-0.5));
        assert_eq!(hits(0.9, f32::INFINITY), none());
        // A disc is met in a point, a sphere is not.
        assert_eq!(hits(0.0, 0.0), (vec![(0.0, d2)], NONE.to_vec()));
    }
}

/// Their chords are less than a unit in the last place of where they begin.
#[test]
fn small_spheres_far_along_the_ray() {
    for quality in QUALITIES {
        for (distance, radius) in [(1e6_f32, 1e-3), (1e6, 1e-9), (1e18, 1.0), (1e18, 1e-18)] {
            let discs = build(&[distance * Vec3::Z], &[radius], quality);
            let aside = 0.5 * radius;
            let ray = Ray::new(aside * Vec3::X, Vec3::Z);
            for ray in [ray, ray.up_to(distance)] {
                let mut hits = Vec::new();
                discs.chords(&ray, |_, t, d2| hits.push((t, d2)));
                assert_eq!(hits, [(distance, aside * aside)]);
            }
            discs.chords(&ray.up_to(distance.next_down()), |_, _, _| panic!("met"));
        }
    }
}

#[test]
fn radius_zero_is_never_met() {
    let discs = build(&[Vec3::ZERO; 9], &[0.0; 9], Quality::Fast);
    let ray = Ray::new(Vec3::NEG_Z, Vec3::Z);
    discs.along(&ray, |_, _, _| panic!("met"));
    discs.chords(&ray, |_, _, _| panic!("met"));
}

#[test]
fn rays_that_are_no_rays_meet_nothing() {
    let discs = build(&[Vec3::ZERO; 9], &[1.0; 9], Quality::Fast);
    for ray in no_rays() {
        discs.along(&ray, |_, _, _| panic!("met by {ray:?}"));
        discs.chords(&ray, |_, _, _| panic!("met by {ray:?}"));
    }
}

#[test]
fn bad_discs_are_errors() {
    let build = |center, radius| {
        let discs = Discs::build(&[Vec3::ZERO, center], &[1.0, radius], Quality::Fast);
        discs.map(|_| ()).map_err(|e| e.to_string())
    };
    let place = "primitive 1: a coordinate is not finite or beyond 1e18; correct it";
    let radius = "primitive 1: its radius is negative, not finite or beyond 1e18; correct it";
    for center in [Vec3::NAN, Vec3::NEG_INFINITY, Vec3::new(0.0, 2e18, 0.0)] {
        assert_eq!(build(center, 1.0), Err(place.into()));
    }
    for bad in [-1.0, f32::NAN, f32::INFINITY, 2e18] {
        assert_eq!(build(Vec3::ZERO, bad), Err(radius.into()));
    }
    assert_eq!(build(Vec3::splat(1e18), 1e18), Ok(()));
    let lengths = Discs::build(&[Vec3::ZERO], &[], Quality::Fast).map(|_| ());
    let [centers, radii] = [1, 0];
    assert_eq!(lengths, Err(BuildError::Lengths { centers, radii }));
}

#[test]
fn the_same_on_any_number_of_threads() {
    let mut random = rng(6);
    let centers = centers(Places::Clustered, 60_000, &mut random);
    let radii = radii(0.05, 1.0, 60_000, &mut random);
    for quality in QUALITIES {
        let [one, two, five] = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let discs = pool
                .expect("threads")
                .install(|| build(&centers, &radii, quality));
            let mut random = rng(7);
            let mut seen = Vec::new();
            for _ in 0..50 {
                let ray = ray(&[(centers[0], radii[0])], 1.0, &mut random);
                discs.along(&ray, |slot, t, d2| {
                    seen.push((slot, t.to_bits(), d2.to_bits()))
                });
            }
            assert!(seen.len() > 100);
            (discs.order().to_vec(), seen)
        });
        assert!(one == two && one == five);
    }
}

#[test]
fn memory_a_disc() {
    let mut random = rng(8);
    let count = 100_000;
    let centers = centers(Places::Uniform, count, &mut random);
    for (quality, limit) in [(Quality::Fast, 23.0), (Quality::High, 24.0)] {
        let discs = build(&centers, &vec![0.01; count], quality);
        let each = discs.bytes() as f64 / count as f64;
        assert!((20.0..limit).contains(&each), "{quality:?}: {each}");
    }
    let none = build(&[], &[], Quality::Fast);
    assert!(none.is_empty() && none.bytes() == 0);
}
