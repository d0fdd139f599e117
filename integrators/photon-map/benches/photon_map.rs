//! The Cornell box in fog, one core: light paths traced, maps built, rays gathered.
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
    for paths in [10_000, 100_000, 1_000_000] {
        let map = PhotonMap::new().paths(paths);
        if paths < 1_000_000 {
            group.throughput(Throughput::Elements(paths));
            group.bench_function(BenchmarkId::new("paths traced into maps", paths), |b| {
                b.iter(|| pass(&scene, &map));
            });
        }
        let maps = pass(&scene, &map);
        let photons = maps.volume.len();
        let volume: Vec<_> = (0..photons).map(|slot| maps.volume.get(slot)).collect();
        group.throughput(Throughput::Elements(photons as u64));
        group.bench_function(BenchmarkId::new("photons built", photons), |b| {
            b.iter(|| Photons::build(black_box(volume.clone())));
        });
        let mut sampler = rng(1);
        group.throughput(Throughput::Elements(1));
        group.bench_function(BenchmarkId::new("rays gathered", photons), |b| {
            b.iter(|| {
                let [x, y] = sampler.next();
                let px = [(x * width as f32) as u32, (y * height as f32) as u32];
                let ray = scene.sensor_ray(px, sampler.next());
                black_box(map.estimate(&scene, &maps, &mut (), &ray, &mut sampler))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
