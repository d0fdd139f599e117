//! When a checkpoint is written.

use crate::checkpoint::Checkpoint;
use std::time::{Duration, Instant};
use tyndall_core::Spectrum;
use tyndall_driver::Snapshot;

/// Writes a checkpoint now and then. One that cannot be written is told, and does not stop the
/// render: the one before it stays.
pub(crate) struct Keeper<'a> {
    checkpoint: &'a Checkpoint,
    interval: Duration,
    last: Instant,
}

impl<'a> Keeper<'a> {
    pub(crate) fn new(checkpoint: &'a Checkpoint, interval: Duration) -> Self {
        Self {
            checkpoint,
            interval,
            last: Instant::now(),
        }
    }

    /// After a pass: writes if it is time to. `say` tells the user what fails.
    pub(crate) fn after_pass<S: Spectrum>(&mut self, snapshot: &Snapshot<S>, say: impl Fn(&str)) {
        if self.last.elapsed() >= self.interval && snapshot.resumable().is_ok() {
            self.keep(snapshot, say);
            self.last = Instant::now();
        }
    }

    /// Writes.
    pub(crate) fn keep<S: Spectrum>(&self, snapshot: &Snapshot<S>, say: impl Fn(&str)) -> bool {
        let path = self.checkpoint.path().display();
        if let Err(why) = snapshot.resumable() {
            say(&format!("note: there is no checkpoint: {why}"));
            return false;
        }
        let written = self.checkpoint.write(snapshot);
        if let Err(why) = &written {
            say(&format!("note: {path}: cannot be written: {why}"));
        }
        written.is_ok()
    }

    /// The render is done: removes what was kept.
    pub(crate) fn finish(&self, say: impl Fn(&str)) {
        if let Err(why) = self.checkpoint.remove() {
            let path = self.checkpoint.path().display();
            say(&format!("note: {path}: cannot be removed: {why}"));
        }
    }
}
