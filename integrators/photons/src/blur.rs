//! How photons are gathered along rays.

use crate::ensure;
use tyndall_core::PassError;

/// Over what a photon in a medium is smoothed, and with it how rays meet it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Blur {
    /// A disc that faces the ray (point × beam 2D): a ray takes the photon where it passes its
    /// centre. Of the two it has less bias for its noise, and any kernel.
    #[default]
    Disc,
    /// A ball (point × beam 3D), of constant density: a ray takes the photon over its chord.
    Ball,
}

impl Blur {
    /// Over which photons are smoothed.
    pub fn dimensions(self) -> u8 {
        match self {
            Self::Disc => 2,
            Self::Ball => 3,
        }
    }
}

/// How the transmittance from the sensor to the photons of a ray is found in media that are not the
/// same everywhere. In those that are, it is a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transmittance {
    /// A table of optical depth along the ray, by adaptive quadrature: no noise, and a bias that is
    /// bounded.
    Table {
        /// Largest error of transmittance, an absolute one, in (0, 1).
        max_error: f32,
    },
    /// So many free flights along the ray, at least 1, which estimate the transmittance to all its
    /// photons at once: no bias, and noise.
    Tracking {
        /// Flights a ray.
        flights: u32,
    },
}

impl Default for Transmittance {
    /// A table of error 1e-2: no noise. Sixteen flights cost less than half as much a ray in a
    /// plume of 64³ voxels (`cargo bench -p tyndall-beam-radiance -- smoke`), and add theirs to
    /// every ray.
    fn default() -> Self {
        Self::Table { max_error: 1e-2 }
    }
}

impl Transmittance {
    /// What a method tells of it, see [`Integrator::options`](tyndall_core::Integrator::options).
    pub fn options(self) -> [(&'static str, String); 2] {
        let (how, detail) = match self {
            Self::Table { max_error } => ("table", ("max_error", max_error.to_string())),
            Self::Tracking { flights } => ("tracking", ("flights", flights.to_string())),
        };
        [("transmittance", how.to_owned()), detail]
    }

    /// Refuses what makes no sense.
    ///
    /// # Errors
    /// [`PassError::Unsupported`].
    pub fn check(self) -> Result<(), PassError> {
        match self {
            Self::Table { max_error } => ensure(max_error > 0.0 && max_error < 1.0, || {
                format!("`max_error` of the transmittance is {max_error}; give one in (0, 1)")
            }),
            Self::Tracking { flights } => ensure(flights > 0, || {
                "`flights` of the transmittance is 0; give 1 at least".to_owned()
            }),
        }
    }
}
