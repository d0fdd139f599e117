//! Walks of light and of sight through surfaces and media.
//!
//! [`Walk`] is the state machine that every method of Tyndall shares: it crosses boundaries
//! between media, passes null surfaces without counting them as bounces, samples free flights and
//! scatterings, and plays Russian roulette. [`Connection`] is what lies
//! between two given points. [`equiangular`] samples points on a segment seen from a pivot; a
//! [`Line`] weights them against free flight. A [`DepthTable`] and [`Flights`] give the transmittance
//! from the start of a ray to many of its points.
//! [`LightPaths`] emits and traces the light paths of a pass, a [`Route`] says what their light has
//! met, and a [`Footprint`] how wide it is; [`DirectLight`] is the choice of who finds that which has met nothing.
//!
//! # Needs of the host
//! [`Geometry`](tyndall_core::Geometry), [`Shading`](tyndall_core::Shading) and
//! [`Media`](tyndall_core::Media); light paths need [`LightEmission`](tyndall_core::LightEmission),
//! sampling lights needs [`LightDirect`](tyndall_core::LightDirect).
#![forbid(unsafe_code)]

mod connection;
mod depth;
mod direct;
pub mod equiangular;
mod flights;
mod footprint;
mod light;
mod line;
mod walk;

pub use connection::Connection;
pub use depth::{DepthTable, OPAQUE};
pub use direct::{ByPhotons, BySampling, DirectLight};
pub use flights::Flights;
pub use footprint::Footprint;
pub use light::{Flight, LightPaths, Route, Visit};
pub use line::{Collided, Line, LinePoint, power_heuristic};
pub use walk::{Event, Scattered, Segment, Site, Vertex, Walk};
