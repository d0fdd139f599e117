//! Weights a second, one core: 4,096 photons within the radius, of one radius or each of its own.
//!
//!     cargo bench -p tyndall-density

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use tyndall_density::Kernel;

const PHOTONS: usize = 4096;

fn kernels(c: &mut Criterion) {
    let radii: Vec<f32> = (0..PHOTONS)
        .map(|i| 0.5 + i as f32 / PHOTONS as f32)
        .collect();
    // Steps of the golden ratio: distances evenly spread, in no order.
    let distances_squared: Vec<f32> = (0..PHOTONS)
        .map(|i| 0.25 * (i as f32 * 0.618_034).fract())
        .collect();
    let mut group = c.benchmark_group("weight_2d");
    group.throughput(Throughput::Elements(PHOTONS as u64));
    for kernel in [
        Kernel::Constant,
        Kernel::Epanechnikov,
        Kernel::Biweight,
        Kernel::Cone,
        Kernel::Gaussian,
    ] {
        group.bench_function(format!("{kernel:?}/one radius"), |b| {
            b.iter(|| {
                let (kernel, radius) = black_box((kernel, 0.5_f32));
                let weights = distances_squared
                    .iter()
                    .map(|d| kernel.weight_2d(*d, radius));
                weights.sum::<f32>()
            });
        });
        group.bench_function(format!("{kernel:?}/a radius each"), |b| {
            b.iter(|| {
                let kernel = black_box(kernel);
                let photons = distances_squared.iter().zip(&radii);
                photons
                    .map(|(d, radius)| kernel.weight_2d(*d, *radius))
                    .sum::<f32>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
