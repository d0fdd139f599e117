//! When to stop.

use crate::{Film, RenderError};
use std::time::Duration;
use tyndall_core::Spectrum;

/// When a render is done. A pass that has begun is finished, and there is at least one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// After this many passes.
    Passes(u64),
    /// After this much time.
    Time(Duration),
    /// When [`Film::relative_error`] falls to this value, judged from
    /// [`Budget::FEWEST_FOR_ERROR`] passes on.
    RelativeError(f64),
}

impl Budget {
    /// With fewer passes an estimate of the error is itself too uncertain to stop on.
    pub const FEWEST_FOR_ERROR: u64 = 16;

    /// Whether there is anything to spend.
    pub(crate) fn check(self) -> Result<(), RenderError> {
        let empty = match self {
            Self::Passes(passes) => passes == 0,
            Self::Time(time) => time.is_zero(),
            Self::RelativeError(error) => error.is_nan() || error <= 0.0,
        };
        match empty {
            true => Err(RenderError::EmptyBudget),
            false => Ok(()),
        }
    }

    /// How much of the budget is spent, from 0 to 1 and beyond. The error falls with the square
    /// root of the passes, which makes its square linear in them.
    pub(crate) fn spent<S: Spectrum>(&self, film: &Film<S>, elapsed: Duration) -> f64 {
        match self {
            Self::Passes(passes) => film.passes() as f64 / *passes as f64,
            Self::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64(),
            Self::RelativeError(target) => {
                let spent = (target / film.relative_error()).powi(2);
                if film.passes() < Self::FEWEST_FOR_ERROR {
                    spent.min(film.passes() as f64 / Self::FEWEST_FOR_ERROR as f64)
                } else {
                    spent
                }
            }
        }
    }
}
