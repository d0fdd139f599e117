//! Samples of the path tracer, one core: a ball of fog under a sky and under a point light.
//!
//!     cargo bench -p tyndall-path

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use std::hint::black_box;
use tyndall_core::{Coefficients, Integrator, Rgb, Sensor, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::Path;
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::rng;

fn ball<S: Spectrum>(light: Light<S>) -> AnalyticHost<Homogeneous<S>> {
    let fog = Coefficients {
        sigma_a: S::splat(0.1),
        sigma_s: S::from_channels(|i| 0.9 + i as f32),
        emission: S::default(),
    };
    let phase = Phase::henyey_greenstein(0.5).expect("a valid mean cosine");
    let fog = Homogeneous::new(fog, phase).expect("valid coefficients");
    let view = View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -2.0),
        forward: Vec3::Z,
        half_width: 0.3,
        pixels: 16,
    };
    AnalyticHost::sphere(fog, 1.0, Interface::Matched, light, view)
}

fn sky<S: Spectrum>() -> Light<S> {
    Light::Background {
        radiance: S::splat(1.0),
        reach: 1.01,
    }
}

fn point<S: Spectrum>() -> Light<S> {
    Light::Point {
        position: Vec3::new(0.5, 1.5, 0.0),
        power: S::splat(10.0),
    }
}

fn samples<H: Sensor>(c: &mut Criterion, name: &str, host: &H)
where
    Path: Integrator<H, Pass = (), Pixel = ()>,
{
    let mut group = c.benchmark_group("path");
    let mut sampler = rng(1);
    let mut i = 0;
    group.throughput(Throughput::Elements(1));
    group.bench_function(name, |b| {
        b.iter(|| {
            use tyndall_core::Sampler;
            i = (i + 1) % 256;
            let ray = host.sensor_ray([i % 16, i / 16], sampler.next());
            black_box(Path::new().estimate(host, &(), &mut (), &ray, &mut sampler))
        });
    });
    group.finish();
}

fn bench(c: &mut Criterion) {
    samples(c, "sky, grey", &ball::<f32>(sky()));
    samples(c, "sky, rgb", &ball::<Rgb>(sky()));
    samples(c, "point light, grey", &ball::<f32>(point()));
    samples(c, "point light, rgb", &ball::<Rgb>(point()));
}

criterion_group!(benches, bench);
criterion_main!(benches);
