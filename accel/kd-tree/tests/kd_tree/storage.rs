//! What is kept of a photon, in how much memory, and in which order.

use crate::{photons_at, tree, uniform};
use glam::Vec3;
use rayon::ThreadPoolBuilder;
use tyndall_core::Sampler;
use tyndall_kd_tree::Photons;
use tyndall_testkit::rng;

#[test]
fn photons_come_back_whole() {
    let mut given = photons_at(&uniform(1, 5000));
    let photons = tree(&given);
    let mut kept: Vec<_> = (0..photons.len()).map(|slot| photons.get(slot)).collect();
    for list in [&mut given, &mut kept] {
        list.sort_by_key(|photon| photon.position.to_array().map(f32::to_bits));
    }
    assert_eq!(kept, given);
}

/// The bound is that of the doc of the packing, with the rounding of `f32` on top.
#[test]
fn directions_keep_their_angle() {
    let mut random = rng(1);
    let mut directions = vec![
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::NEG_X,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
    ];
    let axes = directions.len();
    directions.extend((0..1_000_000).map(|_| {
        let [u, v] = random.next();
        let (z, phi) = (1.0 - 2.0 * u, std::f32::consts::TAU * v);
        let (sin, cos) = phi.sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, z).normalize()
    }));
    let mut given = photons_at(&vec![Vec3::ZERO; directions.len()]);
    given
        .iter_mut()
        .zip(&directions)
        .for_each(|(photon, &d)| photon.direction = d);
    let photons = tree(&given);
    let mut worst = 0.0_f64;
    for slot in 0..photons.len() {
        let index = photons.flux(slot).0.x as usize;
        let (stored, given) = (photons.direction(slot), directions[index]);
        assert!((stored.as_dvec3().length() - 1.0).abs() < 2e-7);
        assert!(index >= axes || stored == given, "{given} became {stored}");
        let (a, b) = (stored.as_dvec3(), given.as_dvec3());
        worst = worst.max(a.cross(b).length().atan2(a.dot(b)));
    }
    assert!(worst < 6.5e-5, "{worst}");
    // If the bound were loose, it would not be the worst angle.
    assert!(worst > 6.0e-5, "{worst}");
}

#[test]
fn bytes_are_bounded() {
    for len in (0..3000).chain([530_000, 1_000_000, 1_050_000]) {
        let photons = Photons::build(&photons_at(&uniform(1, len))).unwrap();
        let bytes = photons.bytes() as f64;
        assert!(bytes <= 29.5 * len as f64 + 400.0, "{bytes} of {len}");
    }
}

#[test]
fn the_same_on_any_number_of_threads() {
    let positions: Vec<Vec3> = uniform(1, 50_000).iter().map(|p| p * p * p).collect();
    let given = photons_at(&positions);
    let on = |threads| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let photons = Photons::build(&given).unwrap();
            let all: Vec<_> = (0..photons.len()).map(|slot| photons.get(slot)).collect();
            (all, photons.nearest_radii(10, 0.02))
        })
    };
    let one = on(1);
    assert!(on(2) == one && on(7) == one);
}
