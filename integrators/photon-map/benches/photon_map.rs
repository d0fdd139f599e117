//! The Cornell box in fog: light paths traced, maps built, rays gathered from 10⁴ to 10⁶ photons of
//! the volume. Once more without the variable for all cores.
//!
//!     RAYON_NUM_THREADS=1 cargo bench -p tyndall-photon-map

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tyndall_core::{Integrator, PassContext, Rgb, Sampler, Sensor};
use tyndall_driver::PassStreams;
use tyndall_kd_tree::Photons;
use tyndall_photon_map::PhotonMap;
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::rng;

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell_fog.toml");

fn pass(scene: &Scene<Rgb>, map: &PhotonMap) -> <PhotonMap as Integrator<Scene<Rgb>>>::Pass {
    let (streams, cancelled) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &cancelled);
    map.begin_pass(scene, &cx, None).expect("photons")
}

fn bench(c: &mut Criterion) {
    let file = SceneFile::load(Path::new(SCENE), &[]).expect("the scene of the repository");
    let scene: Scene<Rgb> = file.build().expect("a scene");
    let [width, height] = scene.resolution();
    let mut group = c.benchmark_group("cornell fog");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(3));
    for paths in [2_000, 20_000, 200_000] {
        let map = PhotonMap::new().paths(paths);
        if paths < 200_000 {
            group.throughput(Throughput::Elements(paths));
            group.bench_function(BenchmarkId::new("paths traced into maps", paths), |b| {
                b.iter(|| pass(&scene, &map));
            });
        }
        let pass = pass(&scene, &map);
        let [(_, fog)] = &pass.maps.volume[..] else {
            panic!("the scene has one medium");
        };
        let photons = fog.len();
        let volume: Vec<_> = (0..photons).map(|slot| fog.get(slot)).collect();
        group.throughput(Throughput::Elements(photons as u64));
        group.bench_function(BenchmarkId::new("photons built", photons), |b| {
            b.iter(|| Photons::build(black_box(&volume)));
        });
        let mut sampler = rng(1);
        group.throughput(Throughput::Elements(1));
        group.bench_function(BenchmarkId::new("rays gathered", photons), |b| {
            b.iter(|| {
                let [x, y] = sampler.next();
                let px = [(x * width as f32) as u32, (y * height as f32) as u32];
                let ray = scene.sensor_ray(px, sampler.next());
                black_box(map.estimate(&scene, &pass, &mut (), &ray, &mut sampler))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
