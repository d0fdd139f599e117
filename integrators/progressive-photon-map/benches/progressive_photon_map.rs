//! A pass, on one core: tracing and sorting its photons, and a picture of 32 × 32 pixels.
//!
//!     cargo bench -p tyndall-progressive-photon-map

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use tyndall_core::{
    Coefficients, Domain, Integrator, PassContext, Rgb, Sampler, Sensor, Spectrum, Streams,
};
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_progressive_photon_map::{Pixel, ProgressivePhotonMap, Radii};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};

const PIXELS: u32 = 32;

/// A ball of fog with a lamp in it.
fn ball() -> AnalyticHost<Homogeneous<Rgb>> {
    let fog = Coefficients {
        sigma_a: Rgb::splat(0.1),
        sigma_s: Rgb::new(0.9, 1.5, 2.5),
        emission: Rgb::default(),
    };
    let phase = Phase::henyey_greenstein(0.5).expect("a valid mean cosine");
    let fog = Homogeneous::new(fog, phase).expect("valid coefficients");
    let light = Light::Point {
        position: Vec3::new(0.2, 0.5, 0.0),
        power: Rgb::splat(10.0),
    };
    let view = View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -2.0),
        forward: Vec3::Z,
        half_width: 0.5,
        pixels: PIXELS,
    };
    AnalyticHost::sphere(fog, 1.0, Interface::Matched, light, view)
}

fn bench(c: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a pool of one thread");
    let (host, cancelled) = (ball(), AtomicBool::new(false));
    for paths in [1_000, 10_000, 100_000] {
        let streams = PassStreams::new(1, 7);
        let cx = PassContext::new(7, &streams, &cancelled);
        let method = ProgressivePhotonMap::new().paths(paths);
        let mut group = c.benchmark_group("photons of a pass");
        group
            .sample_size(10)
            .throughput(Throughput::Elements(paths));
        group.bench_function(BenchmarkId::from_parameter(paths), |b| {
            b.iter(|| pool.install(|| method.begin_pass(&host, &cx, None).expect("a pass")));
        });
        group.finish();
        let mut group = c.benchmark_group("pixels of a pass");
        let samples = u64::from(PIXELS * PIXELS);
        group
            .sample_size(10)
            .throughput(Throughput::Elements(samples));
        for radii in [Radii::Memoryless, Radii::Statistics] {
            let method = method.radii(radii);
            let pass = method.begin_pass(&host, &cx, None).expect("a pass");
            // Pixels that have started, and stay so: their radii are those of a second pass.
            let mut pixels = vec![Pixel::default(); samples as usize];
            let estimate = |i: u32, pixel: &mut Pixel| {
                let mut sampler = streams.sampler(Domain::SENSOR, i.into());
                let ray = host.sensor_ray([i % PIXELS, i / PIXELS], sampler.next());
                method.estimate(&host, &pass, pixel, &ray, &mut sampler)
            };
            for (i, pixel) in (0..).zip(&mut pixels) {
                estimate(i, pixel);
            }
            let name = BenchmarkId::new(format!("{radii:?}"), paths);
            group.bench_function(name, |b| {
                b.iter(|| {
                    for (i, pixel) in (0..).zip(&pixels) {
                        black_box(estimate(i, &mut pixel.clone()));
                    }
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
