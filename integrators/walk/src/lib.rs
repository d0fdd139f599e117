//! Walks of light and of sight through surfaces and media.
//!
//! [`Walk`] is the state machine that every method of Tyndall shares: it crosses boundaries
//! between media, passes null surfaces without counting them as bounces, samples free flights and
//! scatterings, and plays Russian roulette. It estimates nothing. [`Connection`] is what lies
//! between two given points. [`equiangular`] samples points on a segment seen from a pivot.
//!
//! # Needs of the host
//! [`Geometry`](tyndall_core::Geometry), [`Shading`](tyndall_core::Shading) and
//! [`Media`](tyndall_core::Media).
#![forbid(unsafe_code)]

mod connection;
pub mod equiangular;
mod walk;

pub use connection::Connection;
pub use walk::{Event, Scattered, Segment, Site, Vertex, Walk};
