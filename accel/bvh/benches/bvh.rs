//! Discs of 30 nearest neighbours in a unit cube: builds by quality, and rays through them against
//! the number of discs. `TYNDALL_BENCH_MAX=10000000` goes up to ten million; figures of one core
//! need `RAYON_NUM_THREADS=1`.
#![allow(missing_docs)] // of what criterion_group makes

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use std::hint::black_box;
use std::time::Duration;
use tyndall_bvh::{Discs, Quality};
use tyndall_core::{Ray, Sampler};
use tyndall_testkit::rng;

const RAYS: u64 = 2000;

/// Counts of discs.
fn counts() -> impl Iterator<Item = usize> {
    let max = std::env::var("TYNDALL_BENCH_MAX").ok();
    let max = max.and_then(|max| max.parse().ok()).unwrap_or(1_000_000);
    [10_000, 100_000, 500_000, 1_000_000, 10_000_000]
        .into_iter()
        .filter(move |&count| count <= max)
}

/// Uniform centres, and the radius of a sphere that holds 30 of them.
fn discs(count: usize) -> (Vec<Vec3>, Vec<f32>) {
    let mut random = rng(1);
    let centers = (0..count).map(|_| Vec3::from_array(random.next()));
    let volume = 30.0 / count as f32;
    let radius = (volume * 0.75 / std::f32::consts::PI).cbrt();
    (centers.collect(), vec![radius; count])
}

/// Rays of neighbouring pixels, as an integrator sends them.
fn camera() -> Vec<Ray> {
    let eye = Vec3::new(0.5, 0.45, -1.2);
    let pixel = |i: u64| {
        Vec3::new(
            0.1 + 0.02 * (i % 40) as f32,
            0.1 + 0.016 * (i / 40) as f32,
            0.0,
        )
    };
    let ray = |i| Ray::new(eye, (pixel(i) - eye).normalize());
    (0..RAYS).map(ray).collect()
}

/// Rays between random points of the cube: the worst for caches.
fn scattered() -> Vec<Ray> {
    let mut random = rng(2);
    let ray = |_| {
        let [from, to] = [(); 2].map(|()| Vec3::from_array(random.next()));
        let direction = (to - from).normalize();
        Ray::new(from - 2.0 * direction, direction)
    };
    (0..RAYS).map(ray).collect()
}

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    for count in counts() {
        let (centers, radii) = discs(count);
        group.throughput(Throughput::Elements(count as u64));
        for quality in [Quality::Fast, Quality::High] {
            let id = BenchmarkId::new(format!("{quality:?}"), count);
            group.bench_function(id, |b| {
                b.iter(|| Discs::build(&centers, &radii, quality).expect("good discs"))
            });
        }
    }
}

/// Sums a kernel over the discs of all rays; the throughput is that of discs met.
fn rays(criterion: &mut Criterion) {
    for (name, rays) in [("camera", camera()), ("scattered", scattered())] {
        let mut group = criterion.benchmark_group(name);
        for count in counts() {
            let (centers, radii) = discs(count);
            let discs = Discs::build(&centers, &radii, Quality::Fast).expect("good discs");
            let kernel = 1.0 / radii[0].powi(2);
            let mut met = 0;
            for ray in &rays {
                discs.along(ray, |_, _, _| met += 1);
            }
            group.throughput(Throughput::Elements(met));
            group.bench_function(BenchmarkId::new("along", count), |b| {
                b.iter(|| {
                    let mut sum = 0.0;
                    for ray in &rays {
                        discs.along(ray, |_, _, d2| sum += 1.0 - d2 * kernel);
                    }
                    black_box(sum)
                })
            });
            group.bench_function(BenchmarkId::new("chords", count), |b| {
                b.iter(|| {
                    let mut sum = 0.0;
                    for ray in &rays {
                        discs.chords(ray, |_, _, d2| sum += (1.0 - d2 * kernel).sqrt());
                    }
                    black_box(sum)
                })
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    targets = build, rays
}
criterion_main!(benches);
