//! What building and queries take of the heap, alone in a process.

use cap::Cap;
use glam::Vec3;
use std::alloc::System;
use tyndall_core::{Rgb, Sampler};
use tyndall_kd_tree::{Nearest, Photon, Photons};
use tyndall_testkit::rng;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

const PHOTONS: usize = 1_000_000;
/// For the queues of the thread pool.
const BASE: usize = 1 << 20;

/// Bytes that `work` allocates, in the quietest of ten rounds: the thread of the test's harness may
/// allocate, too.
fn allocated(mut work: impl FnMut()) -> usize {
    let mut round = || {
        let before = MEMORY.total_allocated();
        work();
        MEMORY.total_allocated() - before
    };
    (0..10).map(|_| round()).min().unwrap_or(0)
}

#[test]
fn building_keeps_its_bound_and_queries_allocate_nothing() {
    let mut random = rng(1);
    let mut point = || Vec3::from_array(random.next());
    let centers: Vec<Vec3> = (0..1000).map(|_| point()).collect();
    let photon = |position| Photon {
        position,
        direction: Vec3::Z,
        flux: Rgb::new(1.0, 2.0, 3.0),
    };
    let list: Vec<_> = (0..PHOTONS).map(|_| photon(point())).collect();
    let given = MEMORY.allocated();
    let photons = Photons::build(&list).unwrap();
    let peak = MEMORY.max_allocated() - given;
    assert!(peak <= 34 * PHOTONS + BASE, "{peak} bytes");
    let held = MEMORY.allocated() - given;
    assert!(held <= photons.bytes() + BASE, "{held} bytes");

    let mut nearest = Nearest::new(50);
    let mut distances = 0.0;
    let mut query = |nearest: &mut Nearest| {
        for &center in &centers {
            photons.nearest(center, f32::INFINITY, nearest);
            photons.within(center, 0.02, |_, distance| distances += distance);
        }
    };
    assert_eq!(allocated(|| query(&mut nearest)), 0);
    // The room is what the first of these queries takes.
    let mut first = |k| allocated(|| query(&mut Nearest::new(k)));
    assert_eq!(first(50), 50 * 2 * 8);
    assert_eq!(first(0), 0);
    assert!(distances > 0.0);
}
