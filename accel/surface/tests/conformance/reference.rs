//! Brute force in `f64`, with formulas that the crate does not use.

use glam::{DAffine3, DVec3};
use tyndall_core::Ray;
use tyndall_surface::{Mesh, Shape};

/// Where a ray meets what: distance, shape, primitive.
pub(crate) type Met = (f64, u32, u32);

/// The nearest hit of the ray, displaced by `shift`, in (0, `t_max`].
pub(crate) fn nearest(shapes: &[Shape], ray: &Ray, shift: DVec3) -> Option<Met> {
    let origin = ray.origin.as_dvec3() + shift;
    let direction = ray.direction.as_dvec3();
    let mut best: Option<Met> = None;
    for (i, shape) in (0..).zip(shapes) {
        for primitive in 0..shape.primitive_count() {
            for t in distances(shape, primitive, origin, direction) {
                let limit = best.map_or(ray.t_max.into(), |(t, ..)| t);
                if t > 0.0 && t <= limit {
                    best = Some((t, i, primitive as u32));
                }
            }
        }
    }
    best
}

fn distances(shape: &Shape, primitive: usize, o: DVec3, d: DVec3) -> [f64; 2] {
    match *shape {
        Shape::Mesh(ref mesh) => triangle(mesh, &DAffine3::IDENTITY, primitive, o, d),
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => triangle(mesh, to_world, primitive, o, d),
        Shape::Quad {
            corner,
            edge_u,
            edge_v,
        } => {
            let [corner, u, v] = [corner, edge_u, edge_v].map(|x| x.as_dvec3());
            let normal = u.cross(v);
            let t = plane(corner, normal, o, d);
            let met = o + t * d - corner;
            let area = normal.length_squared();
            let a = met.cross(v).dot(normal) / area;
            let b = u.cross(met).dot(normal) / area;
            let unit = 0.0..=1.0;
            keep(t, unit.contains(&a) && unit.contains(&b))
        }
        Shape::Sphere { center, radius } => {
            let f = o - center.as_dvec3();
            let (a, b) = (d.dot(d), f.dot(d));
            let moment = f.cross(d).length_squared(); // of Plücker: no cancellation
            let root = (a * f64::from(radius).powi(2) - moment).sqrt();
            [(-b - root) / a, (-b + root) / a]
        }
        Shape::Disk {
            center,
            normal,
            radius,
        } => {
            let center = center.as_dvec3();
            let t = plane(center, normal.as_dvec3(), o, d);
            keep(t, (o + t * d).distance(center) <= radius.into())
        }
    }
}

fn triangle(mesh: &Mesh, to_world: &DAffine3, triangle: usize, o: DVec3, d: DVec3) -> [f64; 2] {
    let p = mesh.triangles[triangle]
        .map(|i| to_world.transform_point3(mesh.positions[i as usize].as_dvec3()));
    let normal = (p[1] - p[0]).cross(p[2] - p[0]);
    let t = plane(p[0], normal, o, d);
    let met = o + t * d;
    let inside = (0..3).all(|i| {
        let (a, b) = (p[i], p[(i + 1) % 3]);
        (b - a).cross(met - a).dot(normal) >= 0.0
    });
    keep(t, inside)
}

fn plane(p: DVec3, normal: DVec3, o: DVec3, d: DVec3) -> f64 {
    (p - o).dot(normal) / d.dot(normal)
}

fn keep(t: f64, met: bool) -> [f64; 2] {
    [if met { t } else { f64::NAN }, f64::NAN]
}
