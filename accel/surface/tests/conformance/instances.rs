//! An instance is what a copy of its mesh in its place would be.

use crate::built;
use crate::random::Random;
use crate::scenes::{bumpy_ball, linear};
use glam::{DAffine3, Vec2, Vec3};
use std::sync::Arc;
use tyndall_core::Anchor;
use tyndall_surface::{Mesh, Shape, ShapeHit, Surfaces};

/// Size of the instance over that of its mesh, and how far from the origin it is.
const PLACES: &[(f32, f32)] = &[
    (1.0, 0.0),
    (1.0, 1e3),
    (1e-6, 0.0),
    (1e-6, 1e-3),
    (1e6, 0.0),
    (1e6, 1e6),
];

fn placement(random: &mut Random, kind: usize, (size, distance): (f32, f32)) -> DAffine3 {
    DAffine3::from_mat3_translation(
        linear(random, kind) * f64::from(size),
        f64::from(distance) * random.direction().as_dvec3(),
    )
}

/// The mesh in the place of an instance. Reflected triangles are wound the other way.
fn baked(mesh: &Mesh, to_world: &DAffine3) -> Mesh {
    let linear = to_world.matrix3;
    let of_normals = linear.inverse().transpose();
    let mut copy = mesh.clone();
    for p in &mut copy.positions {
        *p = to_world.transform_point3(p.as_dvec3()).as_vec3();
    }
    for n in &mut copy.normals {
        *n = (of_normals * n.as_dvec3()).as_vec3();
    }
    if linear.determinant() < 0.0 {
        for corners in &mut copy.triangles {
            corners.swap(1, 2);
        }
    }
    copy
}

/// The same point of the copy.
fn on_copy(copy: &Surfaces, hit: &ShapeHit, to_world: &DAffine3) -> ShapeHit {
    let mirrored = to_world.matrix3.determinant() < 0.0;
    let uv = if mirrored {
        Vec2::new(hit.uv.y, hit.uv.x)
    } else {
        hit.uv
    };
    copy.hit(hit.shape, hit.primitive, uv)
}

/// A ball with normals and texture coordinates.
fn ball() -> Mesh {
    let mut mesh = bumpy_ball(Vec3::new(0.3, 0.2, 0.1), 1.0);
    let mut random = Random::new(20);
    mesh.normals = mesh
        .positions
        .iter()
        .map(|p| p.normalize() + 0.1 * random.cube())
        .collect();
    mesh.uvs = mesh
        .positions
        .iter()
        .map(|_| Vec2::from(random.square()))
        .collect();
    mesh
}

/// For every place and 16 placements there: `check(name, instance, copy, random)`, the two being
/// the only shapes of their scenes.
fn for_each_placement(
    mesh: &Mesh,
    check: impl Fn(&str, &Surfaces, &Surfaces, &DAffine3, &mut Random),
) {
    let mesh = Arc::new(mesh.clone());
    let mut random = Random::new(21);
    for &place in PLACES {
        for kind in 0..16 {
            let to_world = placement(&mut random, kind, place);
            let copy = [Shape::Mesh(baked(&mesh, &to_world))];
            let mesh = mesh.clone();
            let instance = [Shape::Instance { mesh, to_world }];
            for ((backend, instance), (_, copy)) in built(&instance).zip(built(&copy)) {
                let name = format!("{backend:?}, kind {kind} at {place:?}");
                check(&name, &instance, &copy, &to_world, &mut random);
            }
        }
    }
}

/// What rounding may move a point of the scene by.
fn rounding(surfaces: &Surfaces) -> f32 {
    let bounds = surfaces.bounds();
    1e-5 * (bounds.center().length() + bounds.size().length())
}

#[test]
fn an_instance_is_met_where_its_copy_is() {
    for_each_placement(&ball(), |name, instance, copy, _, random| {
        let bounds = copy.bounds();
        let slack = rounding(copy);
        let (mut met, mut apart) = (0, 0);
        for i in 0..2_000 {
            let mut ray = random.ray(bounds.center(), 0.8 * bounds.size().max_element());
            if i % 4 == 0 {
                ray = ray.up_to(bounds.size().max_element() * random.number());
            }
            let found = [instance, copy].map(|s| s.intersect(&ray));
            for (surfaces, found) in [instance, copy].into_iter().zip(found) {
                assert_eq!(surfaces.occluded(&ray), found.is_some(), "{name}: {ray:?}");
            }
            match found {
                [None, None] => {}
                [Some((s, a)), Some((t, b))] if (s - t).abs() <= slack => {
                    met += 1;
                    let at = instance.surface(&a).position;
                    assert!(at.distance(ray.at(s)) <= slack, "{name}: {ray:?}");
                    assert!(
                        at.distance(copy.surface(&b).position) <= 2.0 * slack,
                        "{name}"
                    );
                }
                _ => apart += 1,
            }
        }
        assert!(met > 30, "{name}: {met} rays met the ball");
        // Rounding tells hit from miss, or one bump from the next, for few rays.
        assert!(apart <= 10, "{name}: {apart} rays met something else");
    });
}

#[test]
fn an_instance_looks_like_its_copy() {
    for_each_placement(&ball(), |name, instance, copy, to_world, random| {
        let slack = rounding(copy);
        assert_eq!(instance.primitive_count(0), copy.primitive_count(0));
        for _ in 0..500 {
            let primitive = random.index(copy.primitive_count(0)) as u32;
            let hit = instance.sample(0, primitive, random.square());
            let twin = on_copy(copy, &hit, to_world);
            let apart = instance.uv(&hit).distance(copy.uv(&twin));
            assert!(apart <= 1e-6, "{name}: {apart}");
            let [a, b] = [instance.surface(&hit), copy.surface(&twin)];
            assert!(
                a.position.distance(b.position) <= slack,
                "{name}: {a:?}, {b:?}"
            );
            // Rounding the vertices of the copy turns its triangles.
            let turn = turn_of_copy(copy, primitive);
            let apart = a.geometric_normal.distance(b.geometric_normal);
            assert!(apart <= turn, "{name}: {apart}, {a:?}, {b:?}");
            // The side of one that is almost in the surface depends on that.
            let grazing = a.shading_normal.dot(a.geometric_normal).abs() <= 2.0 * turn;
            let opposite = grazing && a.shading_normal.dot(b.shading_normal) < 0.0;
            let side = if opposite { -1.0 } else { 1.0 };
            let apart = a.shading_normal.distance(side * b.shading_normal);
            assert!(apart <= 1e-4, "{name}: {apart}, {a:?}, {b:?}");
            let [a, b] = [instance.area(0, primitive), copy.area(0, primitive)];
            assert!((a - b).abs() <= turn * b, "{name}: {a}, {b}");
            assert_tangents_agree(instance, copy, &hit, &twin, turn, name);
        }
    });
}

/// How far the rounding of positions may turn a triangle: half a unit in the last place at both
/// ends of the height, and some for the formulas.
fn turn_of_copy(copy: &Surfaces, triangle: u32) -> f32 {
    let mesh = copy.shape(0).mesh().expect("the copy is a mesh");
    let p = mesh.triangles[triangle as usize].map(|i| mesh.positions[i as usize]);
    let longest = (0..3)
        .map(|i| p[i].distance(p[(i + 1) % 3]))
        .fold(0.0, f32::max);
    let height = 2.0 * copy.area(0, triangle) / longest;
    1e-5 + 4.0 * f32::EPSILON * p[0].length() / height
}

fn assert_tangents_agree(
    instance: &Surfaces,
    copy: &Surfaces,
    hit: &ShapeHit,
    twin: &ShapeHit,
    turn: f32,
    name: &str,
) {
    let [a, b] = [instance.tangents(hit), copy.tangents(twin)];
    let (a, b) = (a.expect("it has uvs"), b.expect("it has uvs"));
    let size = a[0].length() + a[1].length();
    for (a, b) in a.into_iter().zip(b) {
        assert!(a.distance(b) <= 4.0 * turn * size, "{name}: {a}, {b}");
    }
}

/// The outside of a closed mesh stays outside, mirrored or not.
#[test]
fn normals_of_a_closed_instance_point_outwards() {
    let smooth = bumpy_ball(Vec3::ZERO, 1.0);
    for_each_placement(&smooth, |name, instance, _, to_world, random| {
        let center = to_world.translation.as_vec3();
        for _ in 0..200 {
            let towards = random.direction();
            let from = instance.spawn(&Anchor::Point(center), towards);
            let (_, hit) = instance.intersect(&from).expect("the ball is closed");
            let normal = instance.surface(&hit).geometric_normal;
            assert!(
                normal.dot(towards) > 0.0,
                "{name}: {normal} against {towards}"
            );
        }
    });
}
