//! A render between two passes, as something to keep.

use crate::Film;
use serde::{Deserialize, Serialize};
use std::time::Duration;
use tyndall_core::{Spectrum, StateError};

/// A render as it stands between two passes: all that it takes to continue it to the bits of an
/// uninterrupted one, here or (serialised) in another process, with
/// [`Render::resume`](crate::Render::resume).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "S: Spectrum")]
pub struct Snapshot<S> {
    pub(crate) film: Film<S>,
    pub(crate) next_pass: u64,
    pub(crate) elapsed: Duration,
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

    /// Whether the render can be continued from here.
    ///
    /// # Errors
    /// [`StateError::Unsaved`] if the method does not save its state.
    pub fn resumable(&self) -> Result<(), StateError> {
        self.memory.as_ref().map(drop).ok_or(StateError::Unsaved)
    }
}
