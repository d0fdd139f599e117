//! Photons in a tree: against brute force, at extremes, and in memory.
// A failing test tells at which scene it was.
#![allow(clippy::print_stdout)]

mod brute_force;
mod extremes;
mod storage;

use glam::Vec3;
use tyndall_core::{Rgb, Sampler};
use tyndall_kd_tree::{Photon, Photons};
use tyndall_testkit::rng;

/// Photons at these positions; the flux tells their number.
fn photons_at(positions: &[Vec3]) -> Vec<Photon<Rgb>> {
    let photon = |(i, &position): (usize, &Vec3)| Photon {
        position,
        direction: Vec3::AXES[i % 3],
        flux: Rgb::new(i as f32, -(i as f32), 0.5),
    };
    positions.iter().enumerate().map(photon).collect()
}

/// The tree, validated.
fn tree(photons: &[Photon<Rgb>]) -> Photons<Rgb> {
    let photons = Photons::build(photons).unwrap();
    assert_eq!(photons.validate(), Ok(()));
    photons
}

/// Random points of the unit cube.
fn uniform(seed: u64, len: usize) -> Vec<Vec3> {
    let mut random = rng(seed);
    (0..len).map(|_| Vec3::from_array(random.next())).collect()
}
