//! What a search takes, on photons of known density.

use super::FALSE_ALARM;
use glam::Vec3;
use tyndall_core::Sampler;
use tyndall_density::{Dimension, Kernel};
use tyndall_kd_tree::{Nearest, Photon, Photons};
use tyndall_photons::{Neighbours, Search};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, check_mean, sidak};

const KERNELS: [Kernel; 5] = [
    Kernel::Constant,
    Kernel::Epanechnikov,
    Kernel::Biweight,
    Kernel::Cone,
    Kernel::Gaussian,
];

/// `count` photons of equal flux in a cube of side 2 around the origin, a watt together.
fn cube(count: usize, seed: u64) -> Photons<f32> {
    let mut sampler = rng(seed);
    let photons = (0..count).map(|_| Photon {
        position: 2.0 * Vec3::from(sampler.next()) - 1.0,
        direction: Vec3::Z,
        flux: 1.0 / count as f32,
    });
    Photons::build(&photons.collect::<Vec<_>>()).expect("photons")
}

/// The density at the origin.
fn density(photons: &Photons<f32>, search: Search, kernel: Kernel) -> f64 {
    let (mut sum, mut room) = (0.0, Nearest::new(0));
    search.visit(photons, Vec3::ZERO, &mut room, |slot, d2, radius| {
        sum += f64::from(photons.flux(slot) * kernel.weight_3d(d2, radius));
    });
    sum
}

#[test]
fn every_search_finds_the_density() {
    // A watt in a volume of 8: with the k-th photon dropped, the mean is 1/8 for any k and kernel.
    let nearest = |photons, max_radius| {
        Search::Nearest(Neighbours {
            photons,
            dimension: Dimension::Three,
            max_radius,
        })
    };
    let searches = [
        Search::Within(0.4),
        nearest(3.0, f32::INFINITY),
        nearest(40.0, f32::INFINITY),
        nearest(18.7, f32::INFINITY),
        // Reached by some of the searches only.
        nearest(40.0, 0.44),
        nearest(13.7, 0.3),
    ];
    let cases = || {
        searches
            .into_iter()
            .flat_map(|s| KERNELS.map(|kernel| (s, kernel)))
    };
    let mut found: Vec<_> = cases().map(|_| Moments::new()).collect();
    for seed in 0..4000 {
        let photons = cube(800, seed);
        for ((search, kernel), moments) in cases().zip(&mut found) {
            moments.push(density(&photons, search, kernel));
        }
    }
    for ((search, kernel), moments) in cases().zip(&found) {
        let each = sidak(FALSE_ALARM, found.len());
        check_mean("density", moments.estimate(), 0.125, each)
            .unwrap_or_else(|why| panic!("{search:?} {kernel:?}: {why}"));
    }
}
