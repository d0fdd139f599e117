//! Rays to test grids with, and small grids.

use glam::Vec3;
use tyndall_core::{Aabb, Ray, Sampler, warp};
use tyndall_media::DenseGrid;

/// A box that is neither a cube nor around the origin.
pub(crate) const BOUNDS: Aabb = Aabb {
    min: Vec3::new(-1.0, 2.0, 0.0),
    max: Vec3::new(2.0, 3.5, 2.5),
};

/// A grid of random densities in [0, 1), one voxel in three empty.
pub(crate) fn noise(resolution: [usize; 3], sampler: &mut impl Sampler) -> DenseGrid {
    let values = (0..resolution.iter().product())
        .map(|_| (1.5 * sampler.next_1d() - 0.5).max(0.0))
        .collect();
    DenseGrid::new(resolution, BOUNDS, values).unwrap()
}

/// A random point in the box.
pub(crate) fn point(sampler: &mut impl Sampler) -> Vec3 {
    BOUNDS.min + BOUNDS.size() * Vec3::from(sampler.next())
}

/// A ray that meets the box: from inside or outside, in any direction, ending anywhere or never.
pub(crate) fn ray(sampler: &mut impl Sampler) -> Ray {
    let direction = warp::uniform_sphere(sampler.next());
    let back = if sampler.next_1d() < 0.5 { 0.0 } else { 5.0 };
    let ray = Ray::new(point(sampler) - back * direction, direction);
    if sampler.next_1d() < 0.5 {
        return ray;
    }
    ray.up_to(back + 2.0 * sampler.next_1d())
}

/// Rays along axes, in faces, edges and voxel planes, through corners, touching and missing.
pub(crate) fn awkward_rays(resolution: [usize; 3]) -> Vec<Ray> {
    let n = Vec3::from(resolution.map(|n| n as f32));
    let along = [0.0, 1.0, 3.5, 8.0, 8.5].map(|x| x / n.max_element());
    let steps = along.into_iter().chain([0.5, 1.0]);
    let mut rays = Vec::new();
    for (u, v) in steps
        .clone()
        .flat_map(|u| steps.clone().map(move |v| (u, v)))
    {
        for axis in 0..3 {
            let mut p = Vec3::ZERO;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            let mut direction = Vec3::ZERO;
            direction[axis] = 1.0;
            let p = BOUNDS.min + BOUNDS.size() * p;
            rays.push(Ray::new(p - 3.0 * direction, direction));
            rays.push(Ray::new(p + 30.0 * direction, -direction));
            rays.push(Ray::new(p, direction).up_to(1.0));
            // A direction in the plane of two axes, the third exactly zero, of either sign.
            direction[(axis + 1) % 3] = -1.0;
            direction[(axis + 2) % 3] = -0.0;
            let direction = direction.normalize();
            rays.push(Ray::new(p - 2.0 * direction, direction));
        }
    }
    let diagonal = BOUNDS.size().normalize();
    rays.push(Ray::new(BOUNDS.min - diagonal, diagonal));
    rays.push(Ray::new(BOUNDS.max + diagonal, -diagonal));
    rays.push(Ray::new(BOUNDS.min, diagonal).up_to(0.0));
    rays.push(Ray::new(BOUNDS.max, diagonal));
    let grazing = Vec3::new(1.0, 1e-7, -1e-38).normalize();
    rays.push(Ray::new(BOUNDS.min - 10.0 * grazing, grazing));
    rays
}
