//! A bounding volume hierarchy for any bounded primitive met by rays, and photon discs on it.
//!
//! [`Bvh`] holds boxes only: it is built from the [`Aabb`](tyndall_core::Aabb) of every primitive,
//! gives back an order, and shows a ray the ranges of slots of that order that it may meet. A kind
//! of primitive is a block of [`LANES`] of them side by side, and its test. [`Discs`] is the first.
#![forbid(unsafe_code)]

mod builder;
mod bvh;
mod discs;
mod error;
mod meet;
mod node;

pub use builder::Quality;
pub use bvh::Bvh;
pub use discs::Discs;
pub use error::{BuildError, Invalid};

/// Primitives of a block, blocks of a leaf, and children of a node.
pub const LANES: usize = 8;
/// Slots of a leaf: eight blocks of eight.
pub const LEAF: usize = LANES * LANES;
/// Largest coordinate and radius: squares of differences stay finite.
const LIMIT: f32 = 1e18;
