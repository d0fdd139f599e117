//! Boundaries between the medium and vacuum.

use glam::{DVec3, Vec3};
use tyndall_core::{Aabb, Ray};

/// What separates the medium from the vacuum outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// Nothing: the medium is everywhere.
    Nowhere,
    /// The planes z = 0 and z = `thickness`, infinite in x and y.
    Slab {
        /// In scene units; infinite for a half space.
        thickness: f32,
        /// Half the width of the box that `bounds` reports, since a box is not infinite.
        extent: f32,
    },
    /// A sphere around the origin.
    Sphere {
        /// In scene units.
        radius: f32,
        /// What it is made of.
        interface: Interface,
    },
}

/// The nature of a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interface {
    /// Of equal index: light passes straight through.
    Matched,
    /// Smooth dielectric with this index of refraction inside, 1 outside.
    Dielectric(f32),
}

/// A point on the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryHit {
    /// Exactly on a plane of the slab; to rounding on the sphere.
    pub position: Vec3,
    /// Unit normal, outward.
    pub normal: Vec3,
}

/// How far rays start from a sphere, in radii: far above the rounding of `f32`, far below what a
/// closed form resolves.
const OFFSET: f32 = 1e-5;

impl Boundary {
    pub(super) fn interface(&self) -> Interface {
        match self {
            Self::Sphere { interface, .. } => *interface,
            Self::Nowhere | Self::Slab { .. } => Interface::Matched,
        }
    }

    pub(super) fn contains(&self, p: Vec3) -> bool {
        match *self {
            Self::Nowhere => true,
            Self::Slab { thickness, .. } => p.z > 0.0 && p.z < thickness,
            Self::Sphere { radius, .. } => p.length() < radius,
        }
    }

    pub(super) fn bounds(&self) -> Aabb {
        match *self {
            Self::Nowhere => Aabb::EMPTY,
            Self::Slab { thickness, extent } => Aabb {
                min: Vec3::new(-extent, -extent, 0.0),
                max: Vec3::new(extent, extent, thickness.min(extent)),
            },
            Self::Sphere { radius, .. } => Aabb {
                min: Vec3::splat(-radius),
                max: Vec3::splat(radius),
            },
        }
    }

    pub(super) fn intersect(&self, ray: &Ray) -> Option<(f32, BoundaryHit)> {
        match *self {
            Self::Nowhere => None,
            Self::Slab { thickness, .. } => {
                let lower = plane(ray, 0.0, -Vec3::Z);
                let upper = plane(ray, thickness, Vec3::Z);
                [lower, upper]
                    .into_iter()
                    .flatten()
                    .min_by(|a, b| a.0.total_cmp(&b.0))
            }
            Self::Sphere { radius, .. } => sphere(ray, radius),
        }
    }

    /// Where a ray starts that leaves `hit` along `direction`. A plane needs no offset: the hit is
    /// exactly on it, and its distance from there is exactly 0, which is no hit.
    pub(super) fn offset(&self, hit: &BoundaryHit, direction: Vec3) -> Vec3 {
        match *self {
            Self::Nowhere | Self::Slab { .. } => hit.position,
            Self::Sphere { radius, .. } => {
                let side = OFFSET.copysign(direction.dot(hit.normal));
                hit.normal * (radius * (1.0 + side))
            }
        }
    }
}

fn plane(ray: &Ray, z: f32, normal: Vec3) -> Option<(f32, BoundaryHit)> {
    let t = (z - ray.origin.z) / ray.direction.z;
    if !(t > 0.0 && t <= ray.t_max && t.is_finite()) {
        return None;
    }
    let position = ray.at(t).with_z(z);
    Some((t, BoundaryHit { position, normal }))
}

/// In `f64`, so that the eye may be far away.
fn sphere(ray: &Ray, radius: f32) -> Option<(f32, BoundaryHit)> {
    let origin: DVec3 = ray.origin.as_dvec3();
    let direction = ray.direction.as_dvec3().normalize();
    let middle = -origin.dot(direction);
    let radius = f64::from(radius);
    let nearest = (origin + middle * direction).length_squared();
    let half = (radius * radius - nearest).sqrt(); // NaN for a miss, which no comparison admits
    let t = [middle - half, middle + half]
        .into_iter()
        .find(|t| *t > 0.0 && *t <= f64::from(ray.t_max))?;
    let normal = (origin + t * direction).normalize();
    let hit = BoundaryHit {
        position: (normal * radius).as_vec3(),
        normal: normal.as_vec3(),
    };
    Some((t as f32, hit))
}
