//! Passes, film, budget and progress: the loop around an integrator, on all cores.
//!
//! Optional: a host with a tile loop of its own calls
//! [`AnyIntegrator`](tyndall_core::AnyIntegrator) or [`Integrator`](tyndall_core::Integrator)
//! itself.
//!
//! ```text
//! let film = Render::new(&host, &Path::new()).seed(7).run(Budget::Passes(64), |_| {})?;
//! ```
//!
//! The film is the same to the bit on any number of threads: every pixel of every pass has a random
//! stream of its own, and every sum is taken in a fixed order, in `f64`.
#![forbid(unsafe_code)]

mod budget;
mod film;
mod render;
mod snapshot;
mod streams;

pub use budget::Budget;
pub use film::{DifferentResolution, Film};
pub use render::{Progress, Render, RenderError};
pub use snapshot::Snapshot;
pub use streams::{Generator, PassStreams};
