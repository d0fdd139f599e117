//! Surfaces for ray tracing: triangle meshes and their instances, spheres, quads and discs over
//! Embree or an embedded BVH.
//!
//! [`Surfaces`] is the geometry of a scene: it finds the nearest hit of a ray, tells whether a ray
//! is blocked, and starts rays where they cannot meet the surface that they leave. It knows neither
//! materials nor lights; a host maps the index of a shape to those.
//!
//! ```
//! use glam::Vec3;
//! use tyndall_core::{Anchor, Ray};
//! use tyndall_surface::{Backend, Shape, Surfaces};
//!
//! let ball = Shape::Sphere { center: Vec3::ZERO, radius: 2.0 };
//! let surfaces = Surfaces::build(vec![ball], Backend::default())?;
//! let ray = Ray::new(Vec3::new(0.0, 0.0, -5.0), Vec3::Z);
//! let (t, hit) = surfaces.intersect(&ray).expect("the ray aims at the ball");
//! assert_eq!(t, 3.0);
//! assert_eq!(surfaces.surface(&hit).geometric_normal, -Vec3::Z);
//! assert!(surfaces.intersect(&surfaces.spawn(&Anchor::Surface(hit), -Vec3::Z)).is_none());
//! # Ok::<(), tyndall_surface::SurfaceError>(())
//! ```
//!
//! # Backends
//! [`Backend::Embedded`] needs no system library. The feature `embree` adds `Backend::Embree`, about
//! twice as fast, over a system's libembree3 3.13. Both find the nearest primitive in `f32`. Its
//! distance and parameters are computed again in `f64` by code that they share, except where
//! Embree's own are good to 2e-6.
//!
//! # Instances
//! [`Shape::Instance`] places a mesh by any invertible affine transformation. Instances that hold the
//! same `Arc` share one structure over the mesh: each adds one leaf to a tree above. Rays are taken
//! into the coordinates of the mesh without normalising them, so that distances stay those of the
//! scene, and the hit is computed again in the scene.
//!
//! # Precision
//! - Coordinates up to 1e18 in magnitude; larger ones are refused.
//! - Distances are good to 1e-5, mostly to 1e-6. Which of two primitives within some 2⁻²⁴ of the
//!   distance is met first is open.
//! - Rays cover (0, `t_max`]: a surface through the origin is not met.
//! - The embedded backend is watertight. Embree lets no ray through an edge of a mesh, but 6 of
//!   1,000 rays that are aimed exactly at a vertex, and 1 of 30,000 at an edge of an instance.
//! - A ray leaving a surface starts off it by about 1e-6 of the larger of the primitive's size and
//!   its distance from the coordinate origin ([`Surfaces::spawn`] has the bound). Details smaller
//!   than that are lost, so a scene far from the origin should be recentred.
//! - Within an instance the embedded backend is as watertight as within a mesh; two instances that
//!   touch are not sewn together. Embree takes rays into an instance in `f32`, so that hits of an
//!   instance far from the coordinate origin move by some 2⁻²⁰ of that distance.
//! - An instance whose axes are sheared almost into one plane (the product of their lengths over 16
//!   times their volume), or shorter than 1e-12 or longer than 1e12, is copied.
//! - A triangle without area is legal and never met. A ray within the plane of a triangle misses
//!   it, or meets a point of it if rounding says so.
#![forbid(unsafe_code)]

mod bounds;
mod embedded;
#[cfg(feature = "embree")]
mod embree;
mod error;
mod instance;
mod leave;
mod meet;
mod node;
mod octahedral;
mod sample;
mod shape;
mod surfaces;
mod tangents;
mod validate;
mod watertight;

pub use error::SurfaceError;
pub use instance::is_flat;
pub use shape::{Mesh, Shape};
pub use surfaces::{Backend, ShapeHit, Surfaces};
