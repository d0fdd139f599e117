//! The traits and the words of Tyndall.
//!
//! A *host* is a renderer that owns geometry, materials, lights and media. It implements the
//! capability traits of [`host`]; an *integrator* names in its bounds just those that it uses.
//! Nothing here is a scene, a material, a shape, a film, a thread pool or a file format.
//!
//! | word | meaning |
//! |---|---|
//! | [`Spectrum`] | one channel (`f32`) or three ([`Rgb`]); a grey scene carries one |
//! | [`Ray`], [`Anchor`], [`SensorRay`] | where light travels, and between what |
//! | [`Medium`], [`PhaseFunction`] | what scatters, absorbs and emits between surfaces |
//! | [`EmissionSample`], [`DirectSample`] | light leaving a source, light arriving at a point |
//! | [`Integrator`], [`AnyIntegrator`] | the estimator, and its object-safe twin for a driver |
//! | [`Figure`] | what a reader of the image must know of how it was rendered |
//! | [`Sampler`], [`Streams`], [`Domain`] | random numbers, and the names of their streams |
//!
//! # Conventions
//! - `wo` and `wi` are unit vectors and both point away from the vertex.
//! - Distances in scene units; coefficients in 1/scene unit; radiance in W·sr⁻¹·m⁻², power in W,
//!   per channel.
//! - Measures are suffixes: `pdf_w` (solid angle), `pdf_a` (area), `pdf_t` (distance), `pmf`.
//! - `u` is a point of the half-open unit cube: every coordinate is in \[0, 1).

mod aabb;
mod any;
mod figure;
mod frame;
pub mod host;
mod integrator;
mod light;
mod medium;
mod ray;
mod sampler;
mod spectrum;
mod surface;
pub mod warp;

pub use aabb::Aabb;
pub use any::{AnyIntegrator, AnyPass, AnyPixels, Tile};
pub use figure::{Figure, FigureValue, NoFigure};
pub use frame::Frame;
pub use host::{
    Geometry, HostTypes, LightDirect, LightEmission, LightPdf, Media, Sensor, SensorImportance,
    Shading, ShadingPdf,
};
pub use integrator::{Integrator, PassContext, PassError, Splat, StateError};
pub use light::{DirectSample, EmissionPdf, EmissionSample, LightKind};
pub use medium::{
    Coefficients, Collision, FreeFlight, Majorant, Medium, MediumId, PhaseFunction, PhaseSample,
    Vacuum,
};
pub use ray::{Anchor, Ray, SensorConnection, SensorRay};
pub use sampler::{Domain, Sampler, Streams};
pub use spectrum::{Rgb, Spectrum};
pub use surface::{BsdfSample, PathFrom, Surface, SurfaceKind};
