//! Photons in a balanced kd-tree: the k nearest, and all within a radius.
//!
//! [`Photons::build`] stores a list of [`Photon`]s as a structure of arrays in the order of the
//! leaves of the tree, so that photons close in space are close in memory. [`Photons::nearest`]
//! and [`Photons::within`] look them up, [`Photons::nearest_radii`] measures how dense they lie.
//!
//! **Needs:** a [`Spectrum`](tyndall_core::Spectrum); positions, directions and flux as an
//! integrator has them. Photons that must not be found together, as those of two media, go into two
//! trees: that costs neither memory a photon nor a test a candidate. Building and `nearest_radii`
//! run on the current thread pool of `rayon` and give the same bits on any number of threads.
//!
//! **Memory:** 16 bytes a photon, 4 more a channel, and 1.5 or less of nodes: at most 29.5 in three
//! channels, and 400 bytes a tree. Direction is kept to 6.5e-5 rad, all else exactly.
//!
//! **Cost:** building grows as n log n; as the first divisions are serial, threads make a tree of a
//! million at most 8 times faster. A query visits the leaves that its ball meets (for the nearest,
//! the ball that holds them): log n to get there, and what it finds; or more where photons lie on a
//! sphere around its centre. Where photons coincide, queries of the nearest stop when they have
//! enough of them. No query allocates, but for the room of [`Nearest`].
//!
//! **Promised:** positions within ±1e18; distances above 1e-18 to six digits, whatever the scale
//! of the scene. Differences of `f32` coordinates are exact enough far from the origin, too: what
//! is lost there was lost when the photon was stored. Squares of smaller distances underflow:
//! below 1e-23 they are 0. They overflow above 1.8e19: photons that far from a centre, which must
//! then lie outside the bounds of positions, are not found.
//!
//! **References:** Bentley 1975, "Multidimensional binary search trees used for associative
//! searching"; Arya & Mount 1993, "Algorithms for fast vector quantization" (distances of boxes);
//! Jensen 2001, "Realistic image synthesis using photon mapping" (the balanced photon map); Meyer
//! et al. 2010, "On floating-point normal vectors" (directions).
#![forbid(unsafe_code)]

mod build;
mod nearest;
mod octahedral;
mod photon;
mod photons;
mod radii;
mod tree;
mod validate;

pub use nearest::{Nearest, Neighbour};
pub use photon::{BuildError, Photon};
pub use photons::Photons;
pub use validate::BrokenTree;
