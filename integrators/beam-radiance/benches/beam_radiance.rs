//! The beam radiance estimate in a box of fog with a ball of glass.
//!
//!     RAYON_NUM_THREADS=1 cargo bench -p tyndall-beam-radiance
//!
//! A pass of 500,000 photons in the medium, whose radii reach to the 30th nearest, and rays of a
//! picture of 320 × 180 through them, all on all threads and one by one; then against the number of photons. With
//! `TYNDALL_BENCH_MAX=10000000` in the environment up to 10⁷.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tyndall_beam_radiance::{BeamRadiance, Blur, Pass, Transmittance};
use tyndall_core::{Integrator, PassContext, Rgb, Sampler, Sensor};
use tyndall_driver::PassStreams;
use tyndall_photons::{Emission, PhotonMaps};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::{cornell_box, rng};
use tyndall_walk::ByPhotons;

/// Photons in the fog for every light path.
const PHOTONS_A_PATH: f64 = 5.25;

const WIDTH: u32 = 320;
const PIXELS: u32 = WIDTH * 180;

fn scene(fog: &str) -> Scene<Rgb> {
    let file =
        SceneFile::parse(&cornell_box(fog), Path::new("box"), &[]).expect("the scene is valid");
    file.build().expect("the scene is valid")
}

const EVEN: &str = r#"{ kind = "homogeneous", sigma_a = 0.02, sigma_s = 0.25 }"#;
const FORWARD: &str = r#"{ kind = "homogeneous", sigma_a = 0.02, sigma_s = 0.25, phase = { kind = "henyey_greenstein", g = 0.4 } }"#;
const CHROMATIC: &str = r#"{ kind = "homogeneous", sigma_a = 0.02, sigma_s = [0.2, 0.25, 0.3] }"#;

fn method(photons: f64) -> BeamRadiance {
    let paths = (photons / PHOTONS_A_PATH) as u64;
    BeamRadiance::new().paths(paths).starting_paths(paths)
}

fn pass(host: &Scene<Rgb>, method: &BeamRadiance) -> Pass<Rgb> {
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    method.begin_pass(host, &cx, None).expect("a pass")
}

fn trace(host: &Scene<Rgb>, paths: u64) -> PhotonMaps<Rgb> {
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    let emission = Emission {
        paths,
        ..Emission::default()
    };
    PhotonMaps::trace::<_, ByPhotons, _>(host, &cx, emission).expect("photons")
}

/// The radiance of a sample of pixel `index` of the picture.
fn sample(
    host: &Scene<Rgb>,
    method: &BeamRadiance,
    pass: &Pass<Rgb>,
    index: u32,
    sampler: &mut impl Sampler,
) -> Rgb {
    let ray = host.sensor_ray([index % WIDTH, index / WIDTH], sampler.next());
    method.estimate(host, pass, &mut (), &ray, sampler)
}

/// A sample of every pixel, on all threads.
fn picture(c: &mut Criterion, host: &Scene<Rgb>, method: &BeamRadiance) {
    let pass = pass(host, method);
    let mut group = c.benchmark_group("picture");
    group
        .throughput(Throughput::Elements(PIXELS.into()))
        .sample_size(10);
    group.bench_function("5e5 photons", |b| {
        b.iter(|| {
            let pixels = (0..PIXELS).into_par_iter();
            let pixels = pixels.map(|i| sample(host, method, &pass, i, &mut rng(i.into())));
            black_box(pixels.reduce(Rgb::default, |a, b| a + b))
        });
    });
    group.finish();
}

/// Rays of the picture, row by row.
#[allow(clippy::print_stdout)]
fn gather(c: &mut Criterion, name: &str, host: &Scene<Rgb>, method: &BeamRadiance) {
    let pass = pass(host, method);
    let [volume, surfaces] = pass.photons();
    println!(
        "{name}: {volume} photons in the medium, {surfaces} on surfaces, {} bytes",
        pass.bytes()
    );
    let (mut sampler, mut index) = (rng(1), 0);
    let mut group = c.benchmark_group("rays");
    group.throughput(Throughput::Elements(1));
    group.bench_function(name, |b| {
        b.iter(|| {
            index = (index + 1) % PIXELS;
            black_box(sample(host, method, &pass, index, &mut sampler))
        });
    });
    group.finish();
}

fn bench(c: &mut Criterion) {
    let host = scene(EVEN);
    let mut group = c.benchmark_group("pass");
    group.sample_size(10);
    let most = std::env::var("TYNDALL_BENCH_MAX").map_or(1e6, |most| {
        let most = most.parse();
        most.expect("TYNDALL_BENCH_MAX: a number of photons")
    });
    let counts = [1e4, 1e5, 5e5, 1e6, 1e7].into_iter();
    let counts = counts.filter(|&photons| photons <= most);
    for photons in counts.clone() {
        let paths = (photons / PHOTONS_A_PATH) as u64;
        group.throughput(Throughput::Elements(photons as u64));
        group.bench_function(BenchmarkId::new("traced, in kd-trees", photons), |b| {
            b.iter(|| black_box(trace(&host, paths)));
        });
        group.bench_function(BenchmarkId::new("and in discs", photons), |b| {
            b.iter(|| black_box(pass(&host, &method(photons))));
        });
    }
    group.finish();
    picture(c, &host, &method(5e5));
    for photons in counts {
        gather(c, &format!("{photons:e} photons"), &host, &method(photons));
    }
    // Surfaces left out: what is gathered along rays alone.
    let yardstick = method(5e5).surface_radius(1e-5);
    gather(c, "medium alone", &host, &yardstick);
    gather(c, "forward scattering", &scene(FORWARD), &yardstick);
    gather(c, "chromatic", &scene(CHROMATIC), &yardstick);
    gather(c, "balls", &host, &yardstick.blur(Blur::Ball));
    let smoke = scene(
        r#"{ kind = "grid", plume = { resolution = 64 }, min = [-1, 0, -1], max = [1, 2, 1], scale = 2, albedo = 0.9 }"#,
    );
    gather(c, "smoke, table", &smoke, &yardstick);
    let flights = Transmittance::Tracking { flights: 16 };
    gather(
        c,
        "smoke, 16 flights",
        &smoke,
        &yardstick.transmittance(flights),
    );
}

criterion_group!(benches, bench);
criterion_main!(benches);
