//! What can be chosen, and what cannot.

use tyndall_core::PassError;
use tyndall_density::{Dimension, RADII, Shrinkage};

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
    pub(crate) fn dimensions(self) -> u8 {
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
    /// A table of error 1e-2: no noise. Sixteen flights cost less than half as much a ray in a plume
    /// of 64³ voxels (`cargo bench -p tyndall-beam-radiance -- smoke`), and add theirs to every ray.
    fn default() -> Self {
        Self::Table { max_error: 1e-2 }
    }
}

/// How radii of photons are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Radii {
    /// The same for all photons.
    pub(crate) fixed: Option<f32>,
    /// As far as the so many-th nearest, else.
    pub(crate) nearest: usize,
    /// But not farther.
    pub(crate) max: f32,
}

impl Radii {
    pub(crate) fn nearest(nearest: usize) -> Self {
        Self {
            fixed: None,
            nearest,
            max: f32::INFINITY,
        }
    }

    /// The number of neighbours for a pass of `paths`, of which `starting` would look for
    /// [`Radii::nearest`]: the radius does not depend on the paths of a pass.
    pub(crate) fn count(&self, paths: u64, starting: u64) -> usize {
        let count = self.nearest as f64 * (paths as f64 / starting as f64);
        (count.round() as usize).max(2)
    }

    /// What was chosen, under these names of a fixed radius, of a number of photons, and of its bound.
    pub(crate) fn options(
        self,
        [radius, nearest, max]: [&'static str; 3],
    ) -> Vec<(&'static str, String)> {
        match self.fixed {
            Some(fixed) => vec![(radius, fixed.to_string())],
            None => vec![
                (nearest, self.nearest.to_string()),
                (max, self.max.to_string()),
            ],
        }
    }

    /// `what` is the place that the options name.
    pub(crate) fn check(&self, what: &str) -> Result<(), PassError> {
        if let Some(radius) = self.fixed {
            return ensure(RADII.contains(&radius), || {
                format!(
                    "`{what}radius` is {radius}; give a length from {:e} to {:e}",
                    RADII.start(),
                    RADII.end()
                )
            });
        }
        ensure(self.nearest >= 2, || {
            format!(
                "`{what}nearest` is {}; look for 2 photons at least",
                self.nearest
            )
        })?;
        ensure(self.max > 0.0, || {
            format!(
                "`{what}max_radius` is {}; give a length, or infinity for no limit",
                self.max
            )
        })
    }
}

impl Transmittance {
    pub(crate) fn options(self) -> [(&'static str, String); 2] {
        let (how, detail) = match self {
            Self::Table { max_error } => ("table", ("max_error", max_error.to_string())),
            Self::Tracking { flights } => ("tracking", ("flights", flights.to_string())),
        };
        [("transmittance", how.to_owned()), detail]
    }

    pub(crate) fn check(self) -> Result<(), PassError> {
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

/// The schedule of this many dimensions: the best, unless an `alpha` is given.
pub(crate) fn shrinkage(dimension: Dimension, alpha: Option<f64>) -> Result<Shrinkage, PassError> {
    match alpha {
        None => Ok(Shrinkage::optimal(dimension)),
        Some(alpha) => Shrinkage::new(dimension, alpha).map_err(unsupported),
    }
}

pub(crate) fn unsupported(why: impl ToString) -> PassError {
    PassError::Unsupported(why.to_string())
}

pub(crate) fn ensure(holds: bool, sentence: impl FnOnce() -> String) -> Result<(), PassError> {
    if holds {
        Ok(())
    } else {
        Err(PassError::Unsupported(sentence()))
    }
}
