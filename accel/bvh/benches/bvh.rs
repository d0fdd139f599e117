//! Discs of 30 nearest neighbours in a unit cube: builds by quality, and rays through them against
//! the number of discs. Beams of which a ray meets about 50, be they a thousand or a million: builds,
//! and rays against brute force. `TYNDALL_BENCH_MAX=10000000` goes up to ten million; figures of one core
//! need `RAYON_NUM_THREADS=1`.
#![allow(missing_docs)] // of what criterion_group makes

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use std::hint::black_box;
use std::time::Duration;
use tyndall_bvh::{BeamShape, Beams, Discs, LANES, Quality, f32x8};
use tyndall_core::warp::uniform_sphere;
use tyndall_core::{Ray, Sampler};
use tyndall_testkit::rng;

const RAYS: u64 = 2000;

/// Counts of discs, or of beams.
fn counts() -> impl Iterator<Item = usize> {
    up_to_max([10_000, 100_000, 500_000, 1_000_000, 10_000_000])
}

fn up_to_max<const N: usize>(counts: [usize; N]) -> impl Iterator<Item = usize> {
    let max = std::env::var("TYNDALL_BENCH_MAX").ok();
    let max = max.and_then(|max| max.parse().ok()).unwrap_or(1_000_000);
    counts.into_iter().filter(move |&count| count <= max)
}

/// Uniform centres, and the radius of a sphere that holds 30 of them.
fn discs(count: usize) -> (Vec<Vec3>, Vec<f32>) {
    let mut random = rng(1);
    let centers = (0..count).map(|_| Vec3::from_array(random.next()));
    let volume = 30.0 / count as f32;
    let radius = (volume * 0.75 / std::f32::consts::PI).cbrt();
    (centers.collect(), vec![radius; count])
}

/// Rays of neighbouring pixels, as an integrator sends them.
fn camera() -> Vec<Ray> {
    let eye = Vec3::new(0.5, 0.45, -1.2);
    let pixel = |i: u64| {
        Vec3::new(
            0.1 + 0.02 * (i % 40) as f32,
            0.1 + 0.016 * (i / 40) as f32,
            0.0,
        )
    };
    let ray = |i| Ray::new(eye, (pixel(i) - eye).normalize());
    (0..RAYS).map(ray).collect()
}

/// Rays between random points of the cube: the worst for caches.
fn scattered() -> Vec<Ray> {
    let mut random = rng(2);
    let ray = |_| {
        let [from, to] = [(); 2].map(|()| Vec3::from_array(random.next()));
        let direction = (to - from).normalize();
        Ray::new(from - 2.0 * direction, direction)
    };
    (0..RAYS).map(ray).collect()
}

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    for count in counts() {
        let (centers, radii) = discs(count);
        group.throughput(Throughput::Elements(count as u64));
        for quality in [Quality::Fast, Quality::High] {
            let id = BenchmarkId::new(format!("{quality:?}"), count);
            group.bench_function(id, |b| {
                b.iter(|| Discs::build(&centers, &radii, quality).expect("good discs"))
            });
        }
    }
}

/// Sums a kernel over the discs of all rays; the throughput is that of discs met.
fn rays(criterion: &mut Criterion) {
    for (name, rays) in [("camera", camera()), ("scattered", scattered())] {
        let mut group = criterion.benchmark_group(name);
        for count in counts() {
            let (centers, radii) = discs(count);
            let discs = Discs::build(&centers, &radii, Quality::Fast).expect("good discs");
            let kernel = 1.0 / radii[0].powi(2);
            let mut met = 0;
            for ray in &rays {
                discs.along(ray, |_, _, _| met += 1);
            }
            group.throughput(Throughput::Elements(met));
            group.bench_function(BenchmarkId::new("along", count), |b| {
                b.iter(|| {
                    let mut sum = 0.0;
                    for ray in &rays {
                        discs.along(ray, |_, _, d2| sum += 1.0 - d2 * kernel);
                    }
                    black_box(sum)
                })
            });
            group.bench_function(BenchmarkId::new("chords", count), |b| {
                b.iter(|| {
                    let mut sum = 0.0;
                    for ray in &rays {
                        discs.chords(ray, |_, _, d2| sum += (1.0 - d2 * kernel).sqrt());
                    }
                    black_box(sum)
                })
            });
        }
    }
}

/// Short beams of random directions in the unit cube.
fn random_beams(count: usize) -> Vec<BeamShape> {
    let mut random = rng(3);
    let beam = |_| BeamShape {
        origin: Vec3::from_array(random.next()),
        direction: uniform_sphere(random.next()),
        length: 0.3,
        radii: [100.0 / count as f32; 2],
        limits: BeamShape::UNLIMITED,
    };
    (0..count).map(beam).collect()
}

/// Long beams from a lamp in a corner of the unit cube, askew in it.
fn headlight(count: usize) -> Vec<BeamShape> {
    let mut random = rng(4);
    let axis = Vec3::new(0.48, 0.6, 0.64);
    let (x, y) = axis.any_orthonormal_pair();
    let beam = |_| {
        let [a, b, c, d] = random.next().map(|u: f32| u - 0.5);
        BeamShape {
            origin: 0.05 * (a * x + b * y),
            direction: (axis + 0.3 * (c * x + d * y)).normalize(),
            length: 1.5,
            radii: [15.0 / count as f32; 2],
            limits: BeamShape::UNLIMITED,
        }
    };
    (0..count).map(beam).collect()
}

/// What a beam gives to a ray that it crosses at a place for which `holds`: 1/(2 r sin θ).
fn crossing(ray: &Ray, beam: &BeamShape, holds: impl Fn(f64) -> bool) -> f64 {
    let (d, e) = (ray.direction.as_dvec3(), beam.direction.as_dvec3());
    let w = beam.origin.as_dvec3() - ray.origin.as_dvec3();
    let (c, sin2) = (d.dot(e), d.cross(e).length_squared());
    let [t, v] = [d.dot(w) - c * e.dot(w), c * d.dot(w) - e.dot(w)].map(|x| x / sin2);
    let r = beam.radius(v);
    if t < 0.0 || !holds(v) || (w + v * e - t * d).length_squared() > r * r {
        return 0.0;
    }
    0.5 / (r * sin2.sqrt())
}

/// Brute force: all beams, eight at a time.
struct Brute<'a> {
    beams: &'a [BeamShape],
    /// Origin and direction.
    blocks: Vec<[f32x8; 6]>,
}

impl<'a> Brute<'a> {
    fn new(beams: &'a [BeamShape]) -> Self {
        let value = |beam: &BeamShape, i: usize| [beam.origin, beam.direction][i / 3][i % 3];
        let lanes = |block: &[BeamShape], i| {
            f32x8::new(std::array::from_fn(|lane| {
                block.get(lane).map_or(f32::NAN, |beam| value(beam, i))
            }))
        };
        let block = |block| std::array::from_fn(|i| lanes(block, i));
        Self {
            beams,
            blocks: beams.chunks(LANES).map(block).collect(),
        }
    }

    fn sum(&self, ray: &Ray) -> f64 {
        let [ox, oy, oz] = ray.origin.to_array().map(f32x8::splat);
        let [dx, dy, dz] = ray.direction.to_array().map(f32x8::splat);
        let [radius, length] = [self.beams[0].radii[0], self.beams[0].length].map(f32x8::splat);
        let mut sum = 0.0;
        for (block, [x, y, z, ex, ey, ez]) in self.blocks.iter().enumerate() {
            let [x, y, z] = [*x - ox, *y - oy, *z - oz];
            let (from, c) = (x * dx + y * dy + z * dz, *ex * dx + *ey * dy + *ez * dz);
            let along = x * *ex + y * *ey + z * *ez;
            let [nx, ny, nz] = [
                dy * *ez - dz * *ey,
                dz * *ex - dx * *ez,
                dx * *ey - dy * *ex,
            ];
            let sin2 = nx * nx + ny * ny + nz * nz;
            let (distance, v) = (x * nx + y * ny + z * nz, (c * from - along) / sin2);
            let met = (distance * distance).simd_le(radius * radius * sin2)
                & v.simd_ge(f32x8::ZERO)
                & v.simd_le(length);
            let mut met = met.to_bitmask();
            while met != 0 {
                let beam = &self.beams[block * LANES + met.trailing_zeros() as usize];
                sum += crossing(ray, beam, |v| (0.0..f64::from(beam.length)).contains(&v));
                met &= met - 1;
            }
        }
        sum
    }
}

/// The throughput is that of beams when built, and of rays.
fn beams(criterion: &mut Criterion) {
    for (name, beams) in [
        ("beams", random_beams as fn(usize) -> Vec<BeamShape>),
        ("headlight", headlight),
    ] {
        let mut group = criterion.benchmark_group(name);
        for count in up_to_max([1000, 10_000, 100_000, 1_000_000]) {
            let shapes = beams(count);
            group.throughput(Throughput::Elements(count as u64));
            group.bench_function(BenchmarkId::new("build", count), |b| {
                b.iter(|| Beams::build(&shapes).expect("good beams"))
            });
            let beams = Beams::build(&shapes).expect("good beams");
            let mut through = |name, rays: &[Ray], sum: &dyn Fn(&Ray) -> f64| {
                group.throughput(Throughput::Elements(rays.len() as u64));
                group.bench_function(BenchmarkId::new(name, count), |b| {
                    b.iter(|| rays.iter().map(sum).sum::<f64>())
                });
            };
            let near = |ray: &Ray| {
                let mut sum = 0.0;
                beams.near(ray, |piece| {
                    sum += crossing(ray, beams.beam(piece.beam), |v| piece.holds(v));
                });
                sum
            };
            through("camera", &camera(), &near);
            through("scattered", &scattered(), &near);
            let brute = Brute::new(&shapes);
            let some: Vec<_> = camera().into_iter().step_by(100).collect();
            through("brute force", &some, &|ray| brute.sum(ray));
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    targets = build, rays, beams
}
criterion_main!(benches);
