//! Photons in a balanced kd-tree: the k nearest, and all within a radius.
#![forbid(unsafe_code)]

mod build;
mod nearest;
mod octahedral;
mod photon;
mod photons;
mod radii;
mod tree;

pub use nearest::{Nearest, Neighbour};
pub use photon::{BuildError, Photon};
pub use photons::Photons;
