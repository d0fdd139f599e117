//! What is stored, and what cannot be.

use glam::Vec3;
use thiserror::Error;
use tyndall_core::Spectrum;

/// Beyond it, squares of distances leave the range of `f32`.
const FARTHEST: f32 = 1e18;
/// How far the length of a direction may be from 1.
const UNIT_TOLERANCE: f32 = 1e-3;

/// One photon, unpacked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon<S> {
    /// Where it was stored, within ±1e18.
    pub position: Vec3,
    /// Direction of travel, unit.
    pub direction: Vec3,
    /// Power, W; what has been multiplied in is the integrator's choice.
    pub flux: S,
}

impl<S: Spectrum> Photon<S> {
    /// Whether it can be stored: a position within bounds, a direction of length 1 ± 0.001, and a
    /// flux that is finite.
    pub fn is_storable(&self) -> bool {
        self.check(0).is_ok()
    }

    /// Whether photon `index` of a list can be stored.
    pub(crate) fn check(&self, index: usize) -> Result<(), BuildError> {
        if !self.position.abs().cmple(Vec3::splat(FARTHEST)).all() {
            return Err(BuildError::Position { photon: index });
        }
        let length = self.direction.length();
        if !(1.0 - UNIT_TOLERANCE..=1.0 + UNIT_TOLERANCE).contains(&length) {
            return Err(BuildError::Direction {
                photon: index,
                length,
            });
        }
        if !self.flux.is_finite() {
            return Err(BuildError::Flux { photon: index });
        }
        Ok(())
    }
}

/// Why photons could not be stored. `photon` is the first faulty index of the list.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A position is NaN, infinite or too far from the origin.
    #[error(
        "photon {photon}: the position is not finite or beyond 1e18; store photons within bounds"
    )]
    Position {
        /// The photon.
        photon: usize,
    },
    /// A direction of travel is not a unit vector.
    #[error("photon {photon}: the direction has length {length}; normalise it")]
    Direction {
        /// The photon.
        photon: usize,
        /// Its length.
        length: f32,
    },
    /// A channel of the flux is NaN or infinite.
    #[error("photon {photon}: the flux is not finite; find the weight that overflowed")]
    Flux {
        /// The photon.
        photon: usize,
    },
    /// Slots are numbered in 32 bits.
    #[error("{photons} photons do not fit: at most 4294967295; emit fewer light paths a pass")]
    TooManyPhotons {
        /// Their number.
        photons: usize,
    },
}
