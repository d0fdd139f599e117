//! What the command says while it works: on the standard error stream, which keeps the standard
//! output free.

use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Mutex;
use tyndall_core::Spectrum;
use tyndall_driver::Progress;

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// A bar with rate and time left; nothing where there is no terminal.
pub(crate) struct Bar {
    bar: ProgressBar,
    /// Passes done, and the share of the budget that they spent.
    done: Mutex<(u64, f64)>,
}

impl Bar {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(STEPS as u64);
        let style = ProgressStyle::with_template("{bar:30} {percent:>3}% {msg}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style);
        Self {
            bar,
            done: Mutex::new((0, 0.0)),
        }
    }

    /// After a pass.
    pub(crate) fn report<S: Spectrum>(&self, progress: &Progress<'_, S>) {
        let passes = progress.snapshot.film().passes();
        self.bar.set_message(format!(
            "{passes} passes, {:.1} a second, error {:.2} %",
            passes as f64 / progress.snapshot.elapsed().as_secs_f64(),
            100.0 * progress.relative_error,
        ));
        if let Ok(mut done) = self.done.lock() {
            *done = (passes, progress.spent);
        }
        self.show(progress.spent);
    }

    /// Within a pass, of which this share is done: every budget is spent linearly.
    pub(crate) fn within(&self, share: f64) {
        if self.bar.is_hidden() {
            return;
        }
        match self.done.lock().as_deref() {
            Ok((0, _)) => {
                let percent = 100.0 * share;
                self.bar
                    .set_message(format!("{percent:.0} % of the first pass"));
            }
            Ok(&(passes, spent)) => self.show(spent * (1.0 + share / passes as f64)),
            Err(_) => {}
        }
    }

    fn show(&self, spent: f64) {
        self.bar.set_position((spent.min(1.0) * STEPS) as u64);
    }

    /// Says something without tearing the bar.
    pub(crate) fn speaker(&self) -> impl Fn(&str) + Clone + Send + 'static {
        let bar = self.bar.clone();
        move |text| bar.suspend(|| message(text))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
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

/// [`message`] in one line, see [`plain`].
pub(crate) fn line(text: &str) {
    message(&plain(text));
}

/// One line, whatever the names are that a file gave its parts: line breaks become semicolons, and
/// other control characters are escaped.
pub(crate) fn plain(text: &str) -> String {
    let mut line = String::new();
    for c in text.chars() {
        match c {
            '\n' => line += "; ",
            c if c.is_control() => line.extend(c.escape_default()),
            c => line.push(c),
        }
    }
    line
}
