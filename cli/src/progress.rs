//! What the command says while it works: on the standard error stream, which keeps the standard
//! output free.

use indicatif::{ProgressBar, ProgressStyle};
use tyndall_driver::Progress;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// A bar with rate and time left; nothing where there is no terminal.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(STEPS);
        let style = ProgressStyle::with_template("{bar:30} {percent:>3}% {msg}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style);
        Self(bar)
    }

    /// After a pass.
    pub(crate) fn report(&self, progress: &Progress) {
        self.0.set_message(format!(
            "{} passes, {:.1} a second, error {:.2} %",
            progress.passes,
            progress.passes as f64 / progress.elapsed.as_secs_f64(),
            100.0 * progress.relative_error,
        ));
        self.0
            .set_position((progress.spent.min(1.0) * STEPS as f64) as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A line for the person at the terminal.
#[expect(
    clippy::print_stderr,
    reason = "the command speaks here and nowhere else"
)]
pub(crate) fn message(text: &str) {
    eprintln!("{text}");
}
