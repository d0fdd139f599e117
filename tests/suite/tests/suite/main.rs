//! Integrators on scenes, and the law that the crates keep.

mod battery;
mod dependency_law;
mod furnace;
mod modes;
mod scale;
mod threads;
