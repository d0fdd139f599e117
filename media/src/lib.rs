//! Participating media: homogeneous, exponential, gridded and overlapping; phase functions, free
//! flight and transmittance.
//!
//! | medium | free flight | transmittance | coefficients |
//! |---|---|---|---|
//! | [`Homogeneous`] | closed form | closed form | constant, per channel |
//! | [`Atmosphere`] | closed form | closed form | constant × e^(−height/H), per channel |
//! | [`GridMedium`] | delta tracking | ratio tracking, or closed form | density × constant, with optional albedo and emission, each a [`Field`]: [`DenseGrid`], [`SparseGrid`], [`Procedural`] or [`Mapped`] |
//! | [`Overlap`] | the first of several | product | sum of several |
//!
//! [`AnyMedium`] is any of them. [`Phase`] holds the phase functions; [`BlackBody`] is the light of
//! fire; [`plume`] makes a smoke to try.
//!
//! # Channels
//! A distance is sampled for all channels at once: its density is the mean of the channels'
//! densities σt·Tr weighted by `importance` (see [`tyndall_core::Medium`]), so Σ importance·weight
//! is the same for every outcome of a free flight and no channel can throw bright dots. A channel
//! of zero importance gets weight 0, for nothing in it will be seen.
//!
//! # Precision
//! Coefficients of 0 to 1e6 per scene unit, distances of 1e-6 to 1e6 and infinity, asymmetry up to
//! 0.999 either way, albedo 0 and 1: finite and right to the rounding of `f32`, with one exception
//! named at [`Homogeneous::new`]. Distances along a ray are stepped, and optical depths summed, in
//! `f64`.
#![forbid(unsafe_code)]

mod any;
mod atmosphere;
mod black_body;
mod channels;
mod error;
mod field;
mod grid;
mod grid_medium;
mod homogeneous;
mod lattice;
mod majorant;
mod mapped;
mod overlap;
mod phase;
mod plume;
mod procedural;
mod sparse;
mod tracking;

pub use any::AnyMedium;
pub use atmosphere::Atmosphere;
pub use black_body::BlackBody;
pub use error::MediumError;
pub use field::{Cells, Field, Hint, Range, Region};
pub use grid::{DenseGrid, Filter};
pub use grid_medium::{GridMedium, Tracking};
pub use homogeneous::Homogeneous;
pub use mapped::Mapped;
pub use overlap::Overlap;
pub use phase::{AnyPhase, Blend, HenyeyGreenstein, Mixture, Phase, Rayleigh, Tabulated};
pub use plume::plume;
pub use procedural::Procedural;
pub use sparse::{Piece, Precision, SparseBuilder, SparseGrid, Statistics, Tile, TileSize};

/// The example of the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
