//! Free flights and transmittances: homogeneous, and through a plume of smoke of 64³ voxels.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use std::hint::black_box;
use tyndall_core::{Aabb, Coefficients, Medium, Ray, Rgb, Sampler, Spectrum, warp};
use tyndall_media::{GridMedium, Homogeneous, Phase, Tracking, plume};
use tyndall_testkit::rng;

const BOUNDS: Aabb = Aabb {
    min: Vec3::splat(-0.5),
    max: Vec3::splat(0.5),
};

fn coefficients<S: Spectrum>(sigma_t: S) -> Coefficients<S> {
    Coefficients {
        sigma_a: sigma_t * 0.1,
        sigma_s: sigma_t * 0.9,
        emission: S::default(),
    }
}

/// Rays of length 1 through the middle of the box, in every direction.
fn rays() -> Vec<Ray> {
    let mut sampler = rng(1);
    (0..1024)
        .map(|_| {
            let direction = warp::uniform_sphere(sampler.next());
            let middle = Vec3::from(sampler.next().map(|u: f32| 0.5 * (u - 0.5)));
            Ray::new(middle - 0.5 * direction, direction).up_to(1.0)
        })
        .collect()
}

fn bench<M: Medium>(c: &mut Criterion, name: &str, medium: &M) {
    let (rays, mut sampler) = (rays(), rng(2));
    let importance = M::Spectrum::splat(1.0);
    let mut next = rays.iter().cycle();
    c.bench_function(&format!("free flight, {name}"), |b| {
        b.iter(|| {
            let ray = next.next().unwrap_or(&rays[0]);
            black_box(medium.sample_free_flight(ray, importance, &mut sampler))
        });
    });
    bench_transmittance(c, name, medium);
}

fn bench_transmittance(c: &mut Criterion, name: &str, medium: &impl Medium) {
    let (rays, mut sampler) = (rays(), rng(3));
    let mut next = rays.iter().cycle();
    c.bench_function(&format!("transmittance, {name}"), |b| {
        b.iter(|| {
            let ray = next.next().unwrap_or(&rays[0]);
            black_box(medium.transmittance(ray, &mut sampler))
        });
    });
}

fn homogeneous<S: Spectrum>(sigma_t: S) -> Homogeneous<S> {
    Homogeneous::new(coefficients(sigma_t), Phase::Isotropic).expect("the coefficients are valid")
}

fn smoke<S: Spectrum>(sigma_t: S) -> GridMedium<S> {
    let density = plume([64; 3], BOUNDS, 1).expect("the box is valid");
    GridMedium::new(density, coefficients(sigma_t), Phase::Isotropic)
        .expect("the coefficients are valid")
}

fn tracking(c: &mut Criterion) {
    let chromatic = Rgb::new(2.0, 5.0, 10.0);
    bench(c, "homogeneous grey", &homogeneous(5.0_f32));
    bench(c, "homogeneous rgb", &homogeneous(chromatic));
    bench(c, "smoke grey", &smoke(10.0_f32));
    bench(c, "smoke rgb", &smoke(chromatic));
    let regular = smoke(10.0_f32).with_tracking(Tracking::Regular);
    bench_transmittance(c, "smoke grey, regular", &regular);
}

criterion_group!(benches, tracking);
criterion_main!(benches);
