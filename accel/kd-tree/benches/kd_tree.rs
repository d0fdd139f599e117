//! One thread: building, the 50 nearest, all within a radius, and the radii to the 30th nearest
//! of every photon, each beside the crate `kiddo`; photons fill a cube or lie on a folded sheet,
//! as those of a caustic do. From 10⁴ to 10⁶ photons, and 10⁷ if the variable `KD_TREE_LARGE` is
//! set (3 GB).

use criterion::measurement::WallTime;
use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main,
};
use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::ThreadPoolBuilder;
use std::env;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Duration;
use tyndall_core::{MediumId, Rgb, Sampler};
use tyndall_kd_tree::{Nearest, Photon, Photons};
use tyndall_testkit::rng;

const QUERIES: usize = 10_000;
const NEAREST: usize = 50;
const PILOT: usize = 30;

type Group<'c> = BenchmarkGroup<'c, WallTime>;

/// Positions of one scene, and where they are looked up.
struct Scene {
    name: String,
    points: Vec<[f32; 3]>,
    queries: Vec<[f32; 3]>,
    /// Of a ball that holds about 50 photons of a filled cube.
    radius: f32,
}

fn in_cube(u: [f32; 3]) -> [f32; 3] {
    u
}

/// A sheet folded over itself, 0.001 thick, with most photons near the folds.
fn on_sheet([u, v, w]: [f32; 3]) -> [f32; 3] {
    let fold = (std::f32::consts::PI * u).cos();
    [fold, v, (3.0 * fold).sin() * (2.0 * v).cos() + 1e-3 * w]
}

impl Scene {
    fn new(name: &str, len: usize, place: fn([f32; 3]) -> [f32; 3]) -> Self {
        let mut random = rng(1);
        let mut points =
            |len: usize| -> Vec<_> { (0..len).map(|_| place(random.next())).collect() };
        Self {
            name: format!("{name}/{len}"),
            points: points(len),
            queries: points(QUERIES),
            radius: (NEAREST as f32 / len as f32 * 0.239).cbrt(),
        }
    }

    fn photons(&self) -> Vec<Photon<Rgb>> {
        let photon = |&p| Photon {
            position: Vec3::from_array(p),
            direction: Vec3::Z,
            flux: Rgb::new(1.0, 2.0, 3.0),
            medium: MediumId(1),
        };
        self.points.iter().map(photon).collect()
    }
}

fn scenes() -> Vec<Scene> {
    let large = env::var_os("KD_TREE_LARGE").map(|_| 10_000_000);
    [10_000, 100_000, 1_000_000]
        .into_iter()
        .chain(large)
        .flat_map(|len| {
            [
                Scene::new("cube", len, in_cube),
                Scene::new("sheet", len, on_sheet),
            ]
        })
        .collect()
}

fn build(group: &mut Group, scene: &Scene) {
    group.throughput(Throughput::Elements(scene.points.len() as u64));
    let photons = scene.photons();
    group.bench_function(format!("{}/ours", scene.name), |bench| {
        let build = |photons| Photons::build(photons).unwrap();
        bench.iter_batched(|| photons.clone(), build, BatchSize::PerIteration);
    });
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter_with_large_drop(|| kiddo_tree(scene));
    });
}

fn kiddo_tree(scene: &Scene) -> ImmutableKdTree<f32, 3> {
    ImmutableKdTree::new_from_slice(&scene.points).unwrap()
}

fn nearest(group: &mut Group, scene: &Scene) {
    group.throughput(Throughput::Elements(QUERIES as u64));
    let photons = Photons::build(scene.photons()).unwrap();
    let mut nearest = Nearest::new(NEAREST);
    group.bench_function(format!("{}/ours", scene.name), |bench| {
        bench.iter(|| {
            for &query in &scene.queries {
                photons.nearest(query.into(), f32::INFINITY, |_| true, &mut nearest);
                black_box(nearest.found());
            }
        });
    });
    let tree = kiddo_tree(scene);
    let count = NonZeroUsize::new(NEAREST).unwrap();
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter(|| {
            for query in &scene.queries {
                let query = tree.query(query);
                let nearest = query.nearest_n::<SquaredEuclidean<f32>>(count);
                black_box(nearest.unsorted().execute());
            }
        });
    });
}

fn within(group: &mut Group, scene: &Scene) {
    group.throughput(Throughput::Elements(QUERIES as u64));
    let photons = Photons::build(scene.photons()).unwrap();
    group.bench_function(format!("{}/ours", scene.name), |bench| {
        bench.iter(|| {
            let mut sum = 0.0;
            for &query in &scene.queries {
                photons.within(query.into(), scene.radius, |_, d| sum += d);
            }
            sum
        });
    });
    let tree = kiddo_tree(scene);
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter(|| {
            let mut sum = 0.0;
            for query in &scene.queries {
                let within = tree.query(query);
                let within = within.within::<SquaredEuclidean<f32>>(scene.radius * scene.radius);
                sum += within
                    .unsorted()
                    .execute()
                    .iter()
                    .map(|n| n.distance)
                    .sum::<f32>();
            }
            sum
        });
    });
}

fn radii(group: &mut Group, scene: &Scene) {
    group.throughput(Throughput::Elements(scene.points.len() as u64));
    let photons = Photons::build(scene.photons()).unwrap();
    group.bench_function(format!("{}/ours", scene.name), |bench| {
        bench.iter(|| photons.nearest_radii(PILOT, f32::INFINITY));
    });
    let tree = kiddo_tree(scene);
    // A photon finds itself, too.
    let count = NonZeroUsize::new(PILOT + 1).unwrap();
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter(|| -> Vec<f32> {
            let radius = |point| {
                let query = tree.query(point);
                let nearest = query.nearest_n::<SquaredEuclidean<f32>>(count);
                nearest.execute().last().unwrap().distance.sqrt()
            };
            scene.points.iter().map(radius).collect()
        });
    });
}

fn all(criterion: &mut Criterion) {
    let one = ThreadPoolBuilder::new().num_threads(1);
    one.build_global().unwrap();
    let scenes = scenes();
    let benches = [
        ("build", build as fn(&mut Group, &Scene)),
        ("nearest", nearest),
        ("within", within),
        ("nearest_radii", radii),
    ];
    for (name, bench) in benches {
        let mut group = criterion.benchmark_group(name);
        group
            .sample_size(10)
            .measurement_time(Duration::from_secs(1));
        group.warm_up_time(Duration::from_millis(300));
        for scene in &scenes {
            bench(&mut group, scene);
        }
        group.finish();
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
