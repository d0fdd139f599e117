//! Random rays against a million triangles, and against a hundred meshes with and without
//! instancing; one thread. With the feature `embree`, the wrapper and
//! the bare call of `embree3` run side by side.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;
use tyndall_core::Ray;
use tyndall_surface::{Backend, Mesh, Shape, Surfaces};

/// Of the grid that covers the torus: 708² · 2 triangles are a million.
const SIDE: u32 = 708;
const RAYS: usize = 20_000;
const MILLION: &str = "a million triangles";

fn random_cube(random: &mut Xoshiro256PlusPlus) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| random.next_u32() as f32 / 2_f32.powi(31) - 1.0))
}

/// A bumpy torus of 2·side² triangles, which rays cross up to four times.
fn torus(side: u32) -> Mesh {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let turn = |i: u32| std::f32::consts::TAU * i as f32 / side as f32;
    let mut mesh = Mesh::default();
    for i in 0..side {
        for j in 0..side {
            let (sin, cos) = turn(i).sin_cos();
            let tube = 0.35 * Vec3::new(turn(j).cos(), 0.0, turn(j).sin());
            let p = Vec3::X * 0.65 + tube + 5e-4 * random_cube(&mut random);
            mesh.positions
                .push(Vec3::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos, p.z));
            let at = |i: u32, j: u32| (i % side) * side + j % side;
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
fn measure(
    criterion: &mut Criterion,
    group: &str,
    name: &str,
    mut query: impl FnMut(&Ray) -> bool,
) {
    let rays = rays();
    let mut group = criterion.benchmark_group(group);
    group.throughput(Throughput::Elements(RAYS as u64));
    group.sample_size(20);
    group.measurement_time(Duration::from_secs(3));
    group.bench_function(name, |bencher| {
        bencher.iter(|| rays.iter().filter(|ray| query(black_box(ray))).count());
    });
}

fn wrapped(criterion: &mut Criterion, backend: Backend) {
    both(
        criterion,
        MILLION,
        "",
        vec![Shape::Mesh(torus(SIDE))],
        backend,
    );
}

/// A hundred tori of 10,000 triangles, as instances of one and as meshes of their own.
fn forest(criterion: &mut Criterion, backend: Backend) {
    let mesh = Arc::new(torus(71));
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut instances = Vec::new();
    let mut meshes = Vec::new();
    for _ in 0..100 {
        let axis = random_cube(&mut random).as_dvec3().normalize();
        let turn = DQuat::from_axis_angle(axis, f64::from(random_cube(&mut random).x));
        let scale = DVec3::splat(0.3) + 0.1 * random_cube(&mut random).as_dvec3();
        let place = random_cube(&mut random).as_dvec3();
        let to_world = DAffine3::from_scale_rotation_translation(scale, turn, place);
        let mut copy = Mesh::clone(&mesh);
        for p in &mut copy.positions {
            *p = to_world.transform_point3(p.as_dvec3()).as_vec3();
        }
        meshes.push(Shape::Mesh(copy));
        instances.push(Shape::Instance {
            mesh: mesh.clone(),
            to_world,
        });
    }
    const GROUP: &str = "a hundred meshes";
    both(criterion, GROUP, "instanced, ", instances, backend);
    both(criterion, GROUP, "copied, ", meshes, backend);
}

fn both(criterion: &mut Criterion, group: &str, how: &str, shapes: Vec<Shape>, backend: Backend) {
    let surfaces = Surfaces::build(shapes, backend).expect("the tori are valid meshes");
    let name = |query| format!("{backend:?}, {how}{query}");
    measure(criterion, group, &name("nearest"), |ray| {
        black_box(surfaces.intersect(ray)).is_some()
    });
    measure(criterion, group, &name("any"), |ray| surfaces.occluded(ray));
}

#[cfg(feature = "embree")]
fn bare(criterion: &mut Criterion) {
    use embree3::{
        BufferUsage, Device, Format, GeometryKind, IntersectContext, RayHit, SceneFlags,
    };
    let mesh = torus(SIDE);
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
    measure(criterion, MILLION, "bare embree3, nearest", |ray| {
        let mut hit = RayHit::from_ray(segment(ray));
        scene.intersect(&mut IntersectContext::incoherent(), &mut hit);
        black_box(hit).hit.is_valid()
    });
    measure(criterion, MILLION, "bare embree3, any", |ray| {
        scene.occluded(&mut IntersectContext::incoherent(), &mut segment(ray))
    });
}

fn benches(criterion: &mut Criterion) {
    wrapped(criterion, Backend::Embedded);
    forest(criterion, Backend::Embedded);
    #[cfg(feature = "embree")]
    {
        bare(criterion);
        wrapped(criterion, Backend::Embree);
        forest(criterion, Backend::Embree);
    }
}

criterion_group!(intersect, benches);
criterion_main!(intersect);
