//! One thread: building, the 50 nearest at random and at neighbouring points, all within a radius,
//! and the radii to the 30th nearest of every photon, each beside the crate `kiddo`, which is asked
//! for the same at the same points in the same order; photons fill a cube or lie on a folded sheet,
//! as those of a caustic do. From 10⁴ to 10⁶ photons, or up to the number in `TYNDALL_BENCH_MAX`
//! (10⁷ take 3 GB). Criterion measures wall time: the machine must be idle.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::ThreadPoolBuilder;
use std::env;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Duration;
use tyndall_core::{Rgb, Sampler};
use tyndall_kd_tree::{Nearest, Photon, Photons};
use tyndall_testkit::rng;

const QUERIES: usize = 10_000;
const NEAREST: usize = 50;
const PILOT: usize = 30;
/// Queries that follow each other closely.
const MARCH: usize = 100;

type Group<'c> = BenchmarkGroup<'c, WallTime>;

/// Positions of one scene, and where they are looked up.
struct Scene {
    name: String,
    points: Vec<[f32; 3]>,
    queries: Vec<[f32; 3]>,
    /// Points a hundredth of `radius` apart, as those of a march or of a pixel are.
    neighbours: Vec<[f32; 3]>,
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
        let radius = (NEAREST as f32 / len as f32 * 0.239).cbrt();
        let [points, queries, starts] = [len, QUERIES, QUERIES / MARCH].map(&mut points);
        let march = |start| (0..MARCH).map(move |i| start + 0.01 * radius * Vec3::X * i as f32);
        let neighbours = starts.into_iter().map(Vec3::from_array).flat_map(march);
        Self {
            name: format!("{name}/{len}"),
            neighbours: neighbours.map(|p| p.to_array()).collect(),
            points,
            queries,
            radius,
        }
    }

    fn photons(&self) -> Vec<Photon<Rgb>> {
        let photon = |&p| Photon {
            position: Vec3::from_array(p),
            direction: Vec3::Z,
            flux: Rgb::new(1.0, 2.0, 3.0),
        };
        self.points.iter().map(photon).collect()
    }
}

fn scenes() -> Vec<Scene> {
    let most = env::var("TYNDALL_BENCH_MAX").map_or(1_000_000, |most| {
        most.parse()
            .expect("TYNDALL_BENCH_MAX: a number of photons")
    });
    [10_000, 100_000, 1_000_000, 10_000_000]
        .into_iter()
        .filter(|&len| len <= most)
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
        bench.iter_with_large_drop(|| Photons::build(&photons).unwrap());
    });
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter_with_large_drop(|| kiddo_tree(scene));
    });
}

fn kiddo_tree(scene: &Scene) -> ImmutableKdTree<f32, 3> {
    ImmutableKdTree::new_from_slice(&scene.points).unwrap()
}

fn nearest(group: &mut Group, scene: &Scene) {
    nearest_of(group, scene, &scene.queries);
}

fn neighbouring(group: &mut Group, scene: &Scene) {
    nearest_of(group, scene, &scene.neighbours);
}

fn nearest_of(group: &mut Group, scene: &Scene, queries: &[[f32; 3]]) {
    group.throughput(Throughput::Elements(queries.len() as u64));
    let photons = Photons::build(&scene.photons()).unwrap();
    let mut nearest = Nearest::new(NEAREST);
    group.bench_function(format!("{}/ours", scene.name), |bench| {
        bench.iter(|| {
            for &query in queries {
                photons.nearest(query.into(), f32::INFINITY, &mut nearest);
                black_box(nearest.found());
            }
        });
    });
    let tree = kiddo_tree(scene);
    let count = NonZeroUsize::new(NEAREST).unwrap();
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter(|| {
            for query in queries {
                let query = tree.query(query);
                let nearest = query.nearest_n::<SquaredEuclidean<f32>>(count);
                black_box(nearest.unsorted().execute());
            }
        });
    });
}

fn within(group: &mut Group, scene: &Scene) {
    group.throughput(Throughput::Elements(QUERIES as u64));
    let photons = Photons::build(&scene.photons()).unwrap();
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
    let photons = Photons::build(&scene.photons()).unwrap();
    group.bench_function(format!("{}/ours", scene.name), |bench| {
        bench.iter(|| photons.nearest_radii(PILOT, f32::INFINITY));
    });
    let tree = kiddo_tree(scene);
    let in_order: Vec<_> = (0..photons.len())
        .map(|slot| photons.position(slot).to_array())
        .collect();
    // A photon finds itself, too.
    let count = NonZeroUsize::new(PILOT + 1).unwrap();
    group.bench_function(format!("{}/kiddo", scene.name), |bench| {
        bench.iter(|| -> Vec<f32> {
            let radius = |point| {
                let query = tree.query(point);
                let nearest = query.nearest_n::<SquaredEuclidean<f32>>(count);
                let found = nearest.unsorted().execute();
                found.iter().map(|n| n.distance).fold(0.0, f32::max).sqrt()
            };
            in_order.iter().map(radius).collect()
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
        ("nearest_neighbouring", neighbouring),
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
