//! Smoothing kernels, radius schedules and the formulas of density estimation: what photons as
//! points, photons as beams and their union share.
//!
//! Radiance is estimated from photons: particles of flux Φ, in W and already divided by the light
//! paths *emitted*, that lie where they met a surface or collided in a medium, and carry what
//! arrives there. Each is smoothed by a [`Kernel`] of radius r over as many dimensions as the
//! estimator must. With Φₛ = (σs/σt) Φ the flux that scatters, w the direction in which the photon
//! travels, and the ray of sight meeting or passing it at t, at distance d:
//!
//! | estimator | radiance along the ray, for each photon | here |
//! |---|---|---|
//! | surface | f(wo, −w) \|w·nₛ\|/\|w·n\| Φ K₂(d, r) | [`SurfacePoint::radiance`] × [`Kernel::weight_2d`] |
//! | point × point 3D | Tr(t) p(wo, −w) Φₛ K₃(d, r) Δt, over marched points | [`in_scattered`] × [`Kernel::weight_3d`] |
//! | point × beam 2D | Tr(t) p(wo, −w) Φₛ K₂(d, r) | [`in_scattered`] × [`Kernel::weight_2d`] |
//! | point × beam 3D | p(wo, −w) Φₛ · 3/(4πr³) · ∫ Tr over the chord | [`in_scattered`] × [`Kernel::Constant`] in 3D × ∫ Tr over a [`Chord`] |
//!
//! [`Estimate`] names them, and those of photon beams, which take from [`Lines`] where a ray passes
//! a beam.
//!
//! The last is in closed form for a homogeneous medium and the constant kernel,
//! e^(−σt a) (1 − e^(−σt s))/σt for a chord of length s from a on; elsewhere the integrator
//! integrates its transmittance.
//!
//! ```
//! use glam::Vec3;
//! use tyndall_density::{Chord, Kernel, in_scattered};
//! use tyndall_media::Phase;
//! // A photon of a watt one unit ahead and 0.05 beside the ray, in fog of σt = 0.5.
//! let (t, distance_squared, radius, sigma_t) = (1.0_f32, 0.0025, 0.1, 0.5_f32);
//! let scattered = in_scattered(&Phase::Isotropic, -Vec3::X, Vec3::Y, 1.0_f32);
//! let in_2d = scattered * (-sigma_t * t).exp() * Kernel::Constant.weight_2d(distance_squared, radius);
//! let chord = Chord::new(t, distance_squared, radius, 10.0).unwrap();
//! let through = (-sigma_t * chord.start).exp() * -(-sigma_t * chord.length).exp_m1() / sigma_t;
//! let in_3d = scattered * through * Kernel::Constant.weight_3d(0.0, radius);
//! assert!((in_2d - 1.5363).abs() < 1e-4);
//! assert!((in_3d - 1.9961).abs() < 1e-3);
//! ```
//!
//! Radii shrink by a [`Schedule`], which knows nothing but the paths traced, or by the
//! [`Statistics`] of the photons that a place has found; how fast, says [`Shrinkage`].
//!
//! # Needs of the host
//! [`SurfacePoint`] needs [`Geometry`](tyndall_core::Geometry) and
//! [`Shading`](tyndall_core::Shading), [`in_scattered`] a
//! [`PhaseFunction`](tyndall_core::PhaseFunction), the others nothing.
//!
//! # Promised ranges
//! Radii in [`RADII`], 1e-12 to 1e12 scene units; outside them weights are 0, so that a radius of 0
//! or infinity gives 0 and never NaN. Extinction from 0 to infinity. Up to 2⁶⁴ light paths. Weights
//! are as large as 1e36: their product with a flux stays in `f32` if that is scaled to the scene as
//! power is (Φ ∝ r²).
//!
//! # Bias and variance
//! The expected error of a kernel is ∝ r² (for all here are symmetric) until a boundary or an edge
//! comes within r; the variance is ∝ 1/rᵈ. Kernels that reach outside their medium or over the edge
//! of their surface lose energy.
//!
//! # Cost
//! A weight is a division and a few products; `Cone` adds a root, `Gaussian` an exponential. A loop
//! over photons of one radius has the division taken out of it by the compiler.
//!
//! # References
//! - Henrik Wann Jensen (1996), "Global Illumination Using Photon Maps".
//! - Henrik Wann Jensen, Per Christensen (1998), "Efficient Simulation of Light Transport in Scenes
//!   with Participating Media using Photon Maps".
//! - Wojciech Jarosz, Matthias Zwicker, Henrik Wann Jensen (2008), "The Beam Radiance Estimate for
//!   Volumetric Photon Mapping".
//! - Toshiya Hachisuka, Shinji Ogaki, Henrik Wann Jensen (2008), "Progressive Photon Mapping".
//! - Toshiya Hachisuka, Henrik Wann Jensen (2009), "Stochastic Progressive Photon Mapping".
//! - Claude Knaus, Matthias Zwicker (2011), "Progressive Photon Mapping: A Probabilistic Approach".
//! - Anton Kaplanyan, Carsten Dachsbacher (2013), "Adaptive Progressive Photon Mapping".
//! - Jaroslav Křivánek et al. (2014), "Unifying Points, Beams, and Paths in Volumetric Light
//!   Transport Simulation": the names of the estimators.
#![forbid(unsafe_code)]

mod estimate;
mod exponential;
mod kernel;
mod lines;
mod medium;
mod schedule;
mod statistics;
mod surface;

pub use estimate::Estimate;
pub use exponential::exp_negative;
pub use kernel::{Kernel, RADII};
pub use lines::Lines;
pub use medium::{Chord, in_scattered};
pub use schedule::{Dimension, Schedule, ScheduleError, Shrinkage};
pub use statistics::Statistics;
pub use surface::SurfacePoint;
