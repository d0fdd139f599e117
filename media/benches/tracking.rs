//! Free flights and transmittances: homogeneous, and through a plume of smoke of 64³ voxels, dense
//! and sparse; and lookups in the two grids.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use std::hint::black_box;
use tyndall_core::{Aabb, Coefficients, Medium, Ray, Rgb, Sampler, Spectrum, warp};
use tyndall_media::{
    DenseGrid, Field, GridMedium, Hint, Homogeneous, Phase, Precision, SparseGrid, Tracking, plume,
};
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

/// At points along the rays in order, as a flight looks them up.
fn bench_lookup(c: &mut Criterion, name: &str, density: &impl Field<f32>) {
    let steps = |ray: Ray| (0..8).map(move |i| ray.at((0.5 + i as f32) / 8.0));
    let points: Vec<Vec3> = (rays().into_iter().flat_map(steps))
        .filter(|&p| density.bounds().contains(p))
        .collect();
    let mut next = points.iter().cycle();
    let mut hint = Hint::default();
    c.bench_function(&format!("lookup, {name}"), |b| {
        b.iter(|| {
            let p = next.next().unwrap_or(&points[0]);
            black_box(density.lookup(*p, &mut hint))
        });
    });
}

fn dense() -> DenseGrid {
    plume([64; 3], BOUNDS, 1).expect("the box is valid")
}

fn smoke<S: Spectrum, D: Field<f32>>(density: D, sigma_t: S) -> GridMedium<S, D> {
    GridMedium::new(density, coefficients(sigma_t), Phase::Isotropic)
        .expect("the coefficients are valid")
}

fn tracking(c: &mut Criterion) {
    let chromatic = Rgb::new(2.0, 5.0, 10.0);
    bench(c, "homogeneous grey", &homogeneous(5.0_f32));
    bench(c, "homogeneous rgb", &homogeneous(chromatic));
    bench(c, "smoke grey", &smoke(dense(), 10.0_f32));
    bench(c, "smoke rgb", &smoke(dense(), chromatic));
    let regular = smoke(dense(), 10.0_f32).with_tracking(Tracking::Regular);
    bench_transmittance(c, "smoke grey, regular", &regular);
    bench_lookup(c, "dense", &dense());
    for precision in [Precision::Single, Precision::Half] {
        let sparse = SparseGrid::from_dense(&dense(), precision).expect("the voxels are large");
        bench_lookup(c, &format!("sparse {precision:?}"), &sparse);
        bench(
            c,
            &format!("sparse {precision:?} smoke rgb"),
            &smoke(sparse, chromatic),
        );
    }
}

criterion_group!(benches, tracking);
criterion_main!(benches);
