//! Random rays against a million triangles, one thread. With the feature `embree`, the wrapper and
//! the bare call of `embree3` run side by side.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::hint::black_box;
use std::time::Duration;
use tyndall_core::Ray;
use tyndall_surface::{Backend, Mesh, Shape, Surfaces};

/// Of the grid that covers the torus: 708² · 2 triangles are a million.
const SIDE: u32 = 708;
const RAYS: usize = 20_000;

fn random_cube(random: &mut Xoshiro256PlusPlus) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| random.next_u32() as f32 / 2_f32.powi(31) - 1.0))
}

/// A bumpy torus, which rays cross up to four times.
fn torus() -> Mesh {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let turn = |i: u32| std::f32::consts::TAU * i as f32 / SIDE as f32;
    let mut mesh = Mesh::default();
    for i in 0..SIDE {
        for j in 0..SIDE {
            let (sin, cos) = turn(i).sin_cos();
            let tube = 0.35 * Vec3::new(turn(j).cos(), 0.0, turn(j).sin());
            let p = Vec3::X * 0.65 + tube + 5e-4 * random_cube(&mut random);
            mesh.positions
                .push(Vec3::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos, p.z));
            let at = |i: u32, j: u32| (i % SIDE) * SIDE + j % SIDE;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

fn rays() -> Vec<Ray> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    let mut point = || random_cube(&mut random);
    (0..RAYS)
        .map(|_| {
            let origin = point();
            Ray::new(origin, (point() - origin).normalize())
        })
        .collect()
}

/// Times `query` over all rays.
fn measure(criterion: &mut Criterion, name: &str, mut query: impl FnMut(&Ray) -> bool) {
    let rays = rays();
    let mut group = criterion.benchmark_group("a million triangles");
    group.throughput(Throughput::Elements(RAYS as u64));
    group.sample_size(20);
    group.measurement_time(Duration::from_secs(3));
    group.bench_function(name, |bencher| {
        bencher.iter(|| rays.iter().filter(|ray| query(black_box(ray))).count());
    });
}

fn wrapped(criterion: &mut Criterion, backend: Backend) {
    let shapes = vec![Shape::Mesh(torus())];
    let surfaces = Surfaces::build(shapes, backend).expect("the torus is a valid mesh");
    let name = |query| format!("{backend:?}, {query}");
    measure(criterion, &name("nearest"), |ray| {
        black_box(surfaces.intersect(ray)).is_some()
    });
    measure(criterion, &name("any"), |ray| surfaces.occluded(ray));
}

#[cfg(feature = "embree")]
fn bare(criterion: &mut Criterion) {
    use embree3::{
        BufferUsage, Device, Format, GeometryKind, IntersectContext, RayHit, SceneFlags,
    };
    let mesh = torus();
    let device = Device::new().expect("Embree starts");
    let mut scene = device.create_scene().expect("Embree makes a scene");
    scene.set_flags(SceneFlags::ROBUST);
    let mut geometry = device
        .create_geometry(GeometryKind::TRIANGLE)
        .expect("Embree makes a geometry");
    geometry
        .set_new_buffer::<[f32; 3]>(
            BufferUsage::VERTEX,
            0,
            Format::FLOAT3,
            12,
            mesh.positions.len(),
        )
        .expect("Embree takes vertices")
        .copy_from_slice(
            &mesh
                .positions
                .iter()
                .map(|p| p.to_array())
                .collect::<Vec<_>>(),
        );
    geometry
        .set_new_buffer::<[u32; 3]>(
            BufferUsage::INDEX,
            0,
            Format::UINT3,
            12,
            mesh.triangles.len(),
        )
        .expect("Embree takes indices")
        .copy_from_slice(&mesh.triangles);
    scene.attach_geometry(&geometry.commit());
    scene.commit();
    let segment = |ray: &Ray| {
        let [origin, direction] = [ray.origin, ray.direction].map(|v| v.to_array());
        embree3::Ray::segment(origin, direction, 0.0, ray.t_max)
    };
    measure(criterion, "bare embree3, nearest", |ray| {
        let mut hit = RayHit::from_ray(segment(ray));
        scene.intersect(&mut IntersectContext::incoherent(), &mut hit);
        black_box(hit).hit.is_valid()
    });
    measure(criterion, "bare embree3, any", |ray| {
        scene.occluded(&mut IntersectContext::incoherent(), &mut segment(ray))
    });
}

fn benches(criterion: &mut Criterion) {
    wrapped(criterion, Backend::Embedded);
    #[cfg(feature = "embree")]
    {
        bare(criterion);
        wrapped(criterion, Backend::Embree);
    }
}

criterion_group!(intersect, benches);
criterion_main!(intersect);
