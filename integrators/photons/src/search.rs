//! Which photons an estimate takes.

use glam::Vec3;
use tyndall_core::Spectrum;
use tyndall_kd_tree::{Nearest, Photons};

/// The photons around a point that an estimate takes, and with them the radius of its kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// All within this distance.
    Within(f32),
    /// As far as the `count`-th nearest, which is left out: with it a constant kernel would
    /// overestimate by 1/(count − 1). Fewer photons than that leave out the farthest of them, or
    /// none if `max_radius` says where they end.
    Nearest {
        /// Photons to look for, at least 2.
        count: usize,
        /// No photon farther away is taken; may be infinite.
        max_radius: f32,
        /// Of the distance that is found, what is taken for the radius; at most 1. Progressive
        /// methods shrink it.
        shrink: f32,
    },
}

impl Search {
    /// Room for what a search finds; reuse it.
    pub fn room(self) -> Nearest {
        Nearest::new(match self {
            Self::Within(_) => 0,
            Self::Nearest { count, .. } => count,
        })
    }

    /// Calls `visit` with every photon taken (its slot), its squared distance and the radius.
    pub fn visit<S: Spectrum>(
        self,
        photons: &Photons<S>,
        center: Vec3,
        room: &mut Nearest,
        mut visit: impl FnMut(usize, f32, f32),
    ) {
        match self {
            Self::Within(radius) => photons.within(center, radius, |slot, distance_squared| {
                visit(slot, distance_squared, radius);
            }),
            Self::Nearest {
                count,
                max_radius,
                shrink,
            } => {
                photons.nearest(center, max_radius, room);
                // The farthest is last. It is left out by its place, for its distance squared may
                // round to either side of its radius squared.
                let (radius, taken) = match room.found() {
                    [nearer @ .., farthest]
                        if nearer.len() + 1 == count || max_radius == f32::INFINITY =>
                    {
                        (farthest.distance_squared.sqrt(), nearer)
                    }
                    all => (max_radius, all),
                };
                let radius = shrink * radius;
                for neighbour in taken {
                    if shrink == 1.0 || neighbour.distance_squared < radius * radius {
                        visit(neighbour.slot as usize, neighbour.distance_squared, radius);
                    }
                }
            }
        }
    }
}
