//! A render between two passes, as something to keep.

use crate::Film;
use serde::{Deserialize, Serialize};
use std::time::Duration;
use tyndall_core::{Figure, Spectrum, StateError};

/// A render as it stands between two passes: all that it takes to continue it to the bits of an
/// uninterrupted one, here or (serialised) in another process, with
/// [`Render::resume`](crate::Render::resume).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "S: Spectrum")]
pub struct Snapshot<S> {
    pub(crate) film: Film<S>,
    pub(crate) next_pass: u64,
    pub(crate) elapsed: Duration,
    #[serde(with = "texts")]
    pub(crate) figures: Vec<Figure>,
    /// `None` for a method that does not save its state.
    pub(crate) memory: Option<Memory>,
}

/// What a method remembers of earlier passes, as bytes; all empty for one that needs nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Memory {
    /// What rides in `previous`.
    pub(crate) pass: Vec<u8>,
    /// The pixels of every tile.
    pub(crate) tiles: Vec<Vec<u8>>,
}

impl<S: Spectrum> Snapshot<S> {
    /// The passes so far.
    pub fn film(&self) -> &Film<S> {
        &self.film
    }

    /// The passes so far.
    pub fn into_film(self) -> Film<S> {
        self.film
    }

    /// Time spent on them, in all processes.
    pub fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// What the method tells of the passes so far, see
    /// [`Integrator::figures`](tyndall_core::Integrator::figures).
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }

    /// Whether the render can be continued from here.
    ///
    /// # Errors
    /// [`StateError::Unsaved`] if the method does not save its state.
    pub fn resumable(&self) -> Result<(), StateError> {
        self.memory.as_ref().map(drop).ok_or(StateError::Unsaved)
    }
}

/// Figures as the texts that they are read back from.
mod texts {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use tyndall_core::Figure;

    pub(super) fn serialize<S: Serializer>(figures: &[Figure], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(figures.iter().map(ToString::to_string))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Figure>, D::Error> {
        let texts = Vec::<String>::deserialize(from)?;
        let figures: Result<_, _> = texts.iter().map(|text| text.parse()).collect();
        figures.map_err(D::Error::custom)
    }
}
