//! Integrators on scenes, and the law that the crates keep.

mod dependency_law;
mod furnace;
mod scale;
mod threads;
