//! Radii that shrink with the light paths traced.

use std::fmt;

/// The number of dimensions over which an estimator smooths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// Beams with beams.
    One,
    /// Photons on surfaces, photons with beams (the beam radiance estimate).
    Two,
    /// Photons with points of a medium, or with beams in 3D.
    Three,
}

impl Dimension {
    /// The number.
    #[inline]
    pub const fn number(self) -> u8 {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}

/// How fast radii shrink: the share α of the photons found that is kept, in so many dimensions.
///
/// With α the variance of n passes falls as n^−α and the bias as n^−2(1−α)/d. Small α shrinks fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrinkage {
    dimension: Dimension,
    alpha: f64,
}

impl Shrinkage {
    /// Of the given α in (0, 1]; 1 keeps the radius, and its bias.
    ///
    /// # Errors
    /// [`ScheduleError::Alpha`] if it is not in that range.
    pub fn new(dimension: Dimension, alpha: f64) -> Result<Self, ScheduleError> {
        if alpha > 0.0 && alpha <= 1.0 {
            Ok(Self { dimension, alpha })
        } else {
            Err(ScheduleError::Alpha { alpha })
        }
    }

    /// α = 4/(4 + d), for which the squared error falls fastest: as n^−4/(4+d) (Kaplanyan &
    /// Dachsbacher 2013, "Adaptive Progressive Photon Mapping").
    ///
    /// ```
    /// use tyndall_density::{Dimension, Shrinkage};
    /// assert_eq!(Shrinkage::optimal(Dimension::One).alpha(), 0.8);
    /// ```
    pub fn optimal(dimension: Dimension) -> Self {
        Self {
            dimension,
            alpha: 4.0 / (4.0 + f64::from(dimension.number())),
        }
    }

    /// The share of photons kept.
    #[inline]
    pub fn alpha(self) -> f64 {
        self.alpha
    }

    /// The number of dimensions.
    #[inline]
    pub fn dimension(self) -> Dimension {
        self.dimension
    }
}

/// The memoryless radii of Knaus & Zwicker (2011), "Progressive Photon Mapping: A Probabilistic
/// Approach", indexed by light paths.
///
/// Their rᵢ₊₁ᵈ/rᵢᵈ = (i + α)/(i + 1) is a product that tends to a power of the pass. Taken here is
/// the power itself, of the paths n traced before:
///
/// ```text
/// r(n)ᵈ = r₀ᵈ (1 + n/n₀)^(α−1)
/// ```
///
/// where n₀ are the paths for which the starting radius r₀ is meant. With passes of n₀ paths it is
/// Γ(1 + α) times their product in the limit (0.93, 0.90, 0.89 for the optimal α of one, two and
/// three dimensions): a matter of r₀.
///
/// A pass traces the paths of a range and uses *one* radius, the root of the mean of r(n)² over
/// them. The bias of a smoothed density is ∝ r² to leading order, whatever the dimension, so that
/// the expected image after n paths does not depend on how they were cut into passes (of equal
/// paths, or weighted by them).
///
/// ```
/// use tyndall_density::{Dimension, Schedule, Shrinkage};
/// let schedule = Schedule::new(Shrinkage::optimal(Dimension::Two), 100_000)?;
/// // After 26 times the starting paths the squared radius is a third of what it was: 27^(−1/3).
/// let scale = schedule.scale(2_600_000, 1);
/// assert!((scale.powi(2) - 1.0 / 3.0).abs() < 1e-6);
/// # Ok::<(), tyndall_density::ScheduleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// The power of 1 + n/n₀ in r², in (−2, 0].
    power: f64,
    starting_paths: f64,
}

impl Schedule {
    /// The schedule whose starting radius is meant for `starting_paths` light paths.
    ///
    /// # Errors
    /// [`ScheduleError::NoPaths`] if they are 0.
    pub fn new(shrinkage: Shrinkage, starting_paths: u64) -> Result<Self, ScheduleError> {
        if starting_paths == 0 {
            return Err(ScheduleError::NoPaths);
        }
        Ok(Self {
            power: 2.0 * (shrinkage.alpha - 1.0) / f64::from(shrinkage.dimension.number()),
            starting_paths: starting_paths as f64,
        })
    }

    /// The radius of a pass that traces `paths` light paths after `first_path` others, over the
    /// starting radius: in (0, 1], the same for a radius fixed for all photons and for one of each.
    ///
    /// With p = 2(α−1)/d, x = 1 + first/n₀ and y = paths/(n₀ + first), the mean of (n/n₀ + 1)ᵖ is
    /// xᵖ ((1+y)^(p+1) − 1)/((p+1) y), computed without cancellation for any `paths` and
    /// any p. A pass without paths has the radius at its start.
    pub fn scale(&self, first_path: u64, paths: u64) -> f32 {
        let start = self.starting_paths + first_path as f64;
        let stretch = paths as f64 / start;
        // ln(1+y)/y · (e^z − 1)/z with z = (p+1) ln(1+y), both 1 where their argument is 0.
        let log = stretch.ln_1p();
        let exponent = (self.power + 1.0) * log;
        let mean = ratio(log, stretch) * ratio(exponent.exp_m1(), exponent);
        ((start / self.starting_paths).powf(self.power) * mean).sqrt() as f32
    }
}

/// a/b where both vanish together, in the limit 1.
fn ratio(a: f64, b: f64) -> f64 {
    if b == 0.0 { 1.0 } else { a / b }
}

/// Why radii cannot shrink so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ScheduleError {
    /// α is out of range.
    Alpha {
        /// Its value.
        alpha: f64,
    },
    /// The starting radius is meant for no paths.
    NoPaths,
}

impl fmt::Display for ScheduleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alpha { alpha } => write!(
                f,
                "`alpha` is {alpha}; make it more than 0 and at most 1 (which keeps the radius)"
            ),
            Self::NoPaths => {
                f.write_str("the starting radius is meant for 0 light paths; name at least 1")
            }
        }
    }
}

impl std::error::Error for ScheduleError {}
