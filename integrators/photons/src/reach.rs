//! How far photons are gathered: what users choose, and what comes of it in a pass.

use crate::{Emission, Neighbours, Search};
use tyndall_core::{Aabb, PassError};
use tyndall_density::{Dimension, RADII, Schedule, Shrinkage};

/// How far photons are gathered at the start: the options `nearest`, `radius` and `max_radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// One of the first two.
    pub start: Start,
    /// No radius of the nearest is larger, in scene units; may be infinite. A cap keeps light from
    /// bleeding far into darkness, and searches there short. If none is given it is a tenth of the
    /// diagonal of the host's bounds, the same in every pass and on every machine; infinite if they
    /// are infinite or empty. It does not limit a radius that is given.
    pub max_radius: Option<f32>,
}

/// A starting radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// Holds so many photons of the paths for which it is meant; at least 2.
    Nearest(usize),
    /// Is the same everywhere, in scene units.
    Radius(f32),
}

/// How radii depend on the light paths: the options `starting_paths` and `alpha`.
///
/// A radius that holds k photons of n₀ paths holds k·n/n₀ of a pass of n: what is to be expected
/// does not depend on how paths are cut into passes. It shrinks by a [`Schedule`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The paths for which starting radii are meant, at least 1.
    pub starting_paths: u64,
    /// The share of photons kept as radii shrink, in (0, 1]; the one for which the error falls
    /// fastest if none is given.
    pub alpha: Option<f64>,
}

impl Default for Progress {
    /// As many paths as a pass has by default.
    fn default() -> Self {
        Self {
            starting_paths: Emission::default().paths,
            alpha: None,
        }
    }
}

/// What a pass has of the paths and of the radius at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Its paths over those for which radii are meant.
    pub paths: f64,
    /// Its radius over the starting radius.
    pub radius: f32,
}

impl Share {
    /// Of methods whose radii are meant for the paths of a pass and do not shrink.
    pub const WHOLE: Self = Self {
        paths: 1.0,
        radius: 1.0,
    };
}

impl Progress {
    /// How fast radii shrink that smooth over so many dimensions.
    ///
    /// # Errors
    /// [`PassError::Unsupported`] for `alpha`.
    pub fn shrinkage(&self, dimension: Dimension) -> Result<Shrinkage, PassError> {
        match self.alpha {
            None => Ok(Shrinkage::optimal(dimension)),
            Some(alpha) => Shrinkage::new(dimension, alpha).map_err(unsupported),
        }
    }

    /// What a method tells of these options, see
    /// [`Integrator::options`](tyndall_core::Integrator::options); `best` is the `alpha` taken if
    /// none is given.
    pub fn options(&self, best: impl ToString) -> [(&'static str, String); 2] {
        let alpha = self
            .alpha
            .map_or_else(|| best.to_string(), |alpha| alpha.to_string());
        [
            ("starting_paths", self.starting_paths.to_string()),
            ("alpha", alpha),
        ]
    }

    /// The share of pass `pass`.
    ///
    /// # Errors
    /// [`PassError::Unsupported`] for either option.
    pub fn share(
        &self,
        dimension: Dimension,
        emission: Emission,
        pass: u64,
    ) -> Result<Share, PassError> {
        ensure(self.starting_paths > 0, || {
            "`starting_paths` is 0; name at least 1 light path".to_owned()
        })?;
        let schedule = Schedule::new(self.shrinkage(dimension)?, self.starting_paths);
        let schedule = schedule.map_err(unsupported)?;
        Ok(Share {
            paths: emission.paths as f64 / self.starting_paths as f64,
            radius: schedule.scale(emission.first_path(pass), emission.paths),
        })
    }
}

impl Reach {
    /// The radius that holds so many photons.
    pub fn nearest(photons: usize) -> Self {
        Self {
            start: Start::Nearest(photons),
            max_radius: None,
        }
    }

    /// What a method tells of these options, under its names of them.
    pub fn options(
        &self,
        [radius, nearest, max_radius]: [&'static str; 3],
    ) -> Vec<(&'static str, String)> {
        let tenth = || "a tenth of the scene".to_owned();
        match self.start {
            Start::Radius(start) => vec![(radius, start.to_string())],
            Start::Nearest(photons) => vec![
                (nearest, photons.to_string()),
                (
                    max_radius,
                    self.max_radius.map_or_else(tenth, |max| max.to_string()),
                ),
            ],
        }
    }

    /// What is searched for in a pass, among photons spread over so many dimensions, in a scene of
    /// these [`bounds`](tyndall_core::Geometry::bounds). `prefix` begins the names of the options.
    ///
    /// # Errors
    /// [`PassError::Unsupported`], in a sentence that names the option.
    pub fn in_pass(
        &self,
        prefix: &str,
        dimension: Dimension,
        share: Share,
        bounds: Aabb,
    ) -> Result<Search, PassError> {
        let max_radius = self.max_radius.unwrap_or_else(|| tenth(bounds));
        ensure(max_radius > 0.0, || {
            format!("`{prefix}max_radius` is {max_radius}; name a length more than 0, or infinity")
        })?;
        match self.start {
            Start::Radius(start) => {
                let (radius, [least, most]) = (start * share.radius, [RADII.start(), RADII.end()]);
                ensure(RADII.contains(&radius), || {
                    format!(
                        "`{prefix}radius` is {start}, and {radius} in this pass; name one that \
                         stays within {least:e} to {most:e} scene units"
                    )
                })?;
                Ok(Search::Within(radius))
            }
            Start::Nearest(photons) => {
                ensure(photons >= 2, || {
                    format!(
                        "`{prefix}nearest` is {photons}; name at least 2 photons, the last of \
                         which only says how far the kernel reaches"
                    )
                })?;
                let shrunk = f64::from(share.radius).powi(dimension.number().into());
                Ok(Search::Nearest(Neighbours {
                    photons: photons as f64 * share.paths * shrunk,
                    dimension,
                    max_radius: max_radius * share.radius,
                }))
            }
        }
    }
}

/// A tenth of the diagonal, or infinity if that is none.
fn tenth(bounds: Aabb) -> f32 {
    let radius = 0.1 * (bounds.max - bounds.min).length();
    let bounded = bounds.max.cmpge(bounds.min).all() && radius > 0.0 && radius.is_finite();
    if bounded { radius } else { f32::INFINITY }
}

/// Refuses a pass in a sentence unless `holds`.
///
/// # Errors
/// [`PassError::Unsupported`].
pub fn ensure(holds: bool, sentence: impl FnOnce() -> String) -> Result<(), PassError> {
    if holds {
        Ok(())
    } else {
        Err(PassError::Unsupported(sentence()))
    }
}

/// Refuses a pass for what another crate says.
pub fn unsupported(why: impl ToString) -> PassError {
    PassError::Unsupported(why.to_string())
}
