//! Light paths as points, for all methods that gather photons.
//!
//! [`PhotonMaps::trace`] makes the photons of a pass ([`Traced::trace`], if a method keeps something else
//! of media); a [`Gather`] estimates what a surface or a
//! medium scatters of them at a point, [`AlongRay`] what a medium scatters of [`PhotonDiscs`] along a
//! whole ray, and a [`March`] takes points along it; [`radiance`] is the walk of sight from the sensor to where they are
//! gathered. Photon mapping in its kinds differs in what it does along segments in media: a
//! [`Sight`]. This crate estimates nothing by itself.
//!
//! # Radii
//! Users choose a [`Reach`], and a [`Progress`] if radii depend on the light paths; a pass makes a
//! [`Search`] of them. The radius that is expected around a point does then not depend on the paths
//! of a pass: to 1 % where photons are spread evenly as far as the 16 nearest are, and to a few per
//! cent down to 10 photons in a map.
//!
//! # Who finds which light
//! | light, before it reaches a surface that scatters into many directions | found by |
//! |---|---|
//! | unscattered | photons or light samples: [`DirectLight`](tyndall_walk::DirectLight) |
//! | through specular surfaces alone | photons of [`SurfacePhotons::caustic`] |
//! | scattered | photons of [`SurfacePhotons::diffuse`]; from sharp directions of a nearly specular surface, and in final gathering, walks |
//!
//! The sensor sees lights, and media that emit, straight and through specular surfaces. No photon
//! starts in a medium: its light does not light its surroundings.
//!
//! # Needs of the host
//! [`Geometry`](tyndall_core::Geometry), [`Shading`](tyndall_core::Shading),
//! [`Media`](tyndall_core::Media) and [`LightEmission`](tyndall_core::LightEmission); to sample
//! direct light [`LightDirect`](tyndall_core::LightDirect).
//!
//! # Cost
//! Linear in light paths. A photon of three channels takes 29.5 bytes; 80
//! to 124 while those found are sorted and maps are built, which [`Emission::max_bytes`] bounds.
//!
//! # References
//! - Henrik Wann Jensen (1996), "Global Illumination Using Photon Maps": the maps, final gathering.
//! - Henrik Wann Jensen, Per Christensen (1998), "Efficient Simulation of Light Transport in Scenes
//!   with Participating Media Using Photon Maps". Deviations: the medium's map stores light on all
//!   routes, and what it carries is multiplied by the albedo where it collided.
#![forbid(unsafe_code)]

mod along;
mod blur;
mod discs;
mod emission;
mod gather;
mod largest;
mod maps;
mod march;
mod reach;
mod search;
mod sight;
mod traced;

pub use along::AlongRay;
pub use blur::{Blur, Transmittance};
pub use discs::PhotonDiscs;
pub use emission::Emission;
pub use gather::{Gather, Gathered};
pub use largest::Largest;
pub use maps::{PhotonMaps, SurfacePhotons, VolumeLists, collided};
pub use march::March;
pub use reach::{Progress, Reach, Share, Start, ensure, unsupported};
pub use search::{Aim, Neighbours, Search};
pub use sight::{Incident, Sight, radiance};
pub use traced::{Keep, Traced};
