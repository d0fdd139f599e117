//! Photon beams in a box of fog with a ball of glass.
//!
//!     RAYON_NUM_THREADS=1 cargo bench -p tyndall-photon-beams
//!
//! A pass of 9,000 light paths (about 50,000 beams), and rays of a picture of 320 × 180 through
//! them, tile by tile as a renderer asks; then against the number of beams, and their radius.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tyndall_core::{Integrator, PassContext, Rgb, Sampler, Sensor, Tile};
use tyndall_driver::PassStreams;
use tyndall_photon_beams::{Estimate, Pass, PhotonBeams};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::{cornell_box, rng};

/// A picture of 320 × 180, in 20 × 15 tiles.
const TILE: [u32; 2] = [16, 12];
const TILES: [u32; 2] = [20, 15];
/// In a box of side 2.
const RADIUS: f32 = 0.01;

fn scene(fog: &str) -> Scene<Rgb> {
    let file =
        SceneFile::parse(&cornell_box(fog), Path::new("box"), &[]).expect("the scene is valid");
    file.build().expect("the scene is valid")
}

const EVEN: &str = r#"{ kind = "homogeneous", sigma_a = 0.02, sigma_s = 0.25 }"#;

fn method(paths: u64) -> PhotonBeams {
    PhotonBeams::new()
        .paths(paths)
        .beam_radius(RADIUS)
        .alpha(1.0)
}

fn pass(host: &Scene<Rgb>, method: &PhotonBeams) -> Pass<Rgb> {
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    method.begin_pass(host, &cx, None).expect("a pass")
}

/// Pixels of the picture. Tiles that follow each other are far apart: any few are like all.
fn pixels() -> Vec<[u32; 2]> {
    let tiles = (0..TILES[0] * TILES[1]).map(|i| i * 71 % (TILES[0] * TILES[1]));
    let corners = tiles.map(|tile| [tile % TILES[0] * TILE[0], tile / TILES[0] * TILE[1]]);
    corners
        .flat_map(|min| Tile { min, size: TILE }.pixels())
        .collect()
}

#[allow(clippy::print_stdout)]
fn gather(c: &mut Criterion, name: &str, host: &Scene<Rgb>, method: &PhotonBeams) {
    let pass = pass(host, method);
    let beams = pass.beams();
    let [_, surfaces] = pass.photons();
    let bytes = pass.bytes();
    println!("{name}: {beams} beams, {surfaces} photons on surfaces, {bytes} bytes");
    let (mut sampler, pixels) = (rng(1), pixels());
    let mut pixels = pixels.iter().cycle();
    let mut group = c.benchmark_group("rays");
    group.throughput(Throughput::Elements(1));
    group.bench_function(name, |b| {
        b.iter(|| {
            let pixel = pixels.next().expect("without end");
            let ray = host.sensor_ray(*pixel, sampler.next());
            black_box(method.estimate(host, &pass, &mut (), &ray, &mut sampler))
        });
    });
    group.finish();
}

fn bench(c: &mut Criterion) {
    let host = scene(EVEN);
    let mut group = c.benchmark_group("pass");
    group.sample_size(10);
    for paths in [200, 2_000, 9_000, 20_000, 200_000] {
        group.throughput(Throughput::Elements(paths));
        group.bench_function(BenchmarkId::from_parameter(format!("{paths} paths")), |b| {
            b.iter(|| black_box(pass(&host, &method(paths))));
        });
    }
    group.finish();
    for paths in [200, 2_000, 9_000, 20_000, 200_000] {
        // Of media alone: surfaces are those of the other crates.
        let method = method(paths).surface_radius(1e-5);
        gather(c, &format!("{paths} paths"), &host, &method);
    }
    for radius in [RADIUS / 16.0, RADIUS / 4.0, RADIUS * 4.0] {
        let method = method(9_000).surface_radius(1e-5).beam_radius(radius);
        gather(c, &format!("radius {radius}"), &host, &method);
    }
    for estimate in Estimate::ALL {
        let method = method(9_000).surface_radius(1e-5).radius(RADIUS);
        gather(c, &estimate.to_string(), &host, &method.estimator(estimate));
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
