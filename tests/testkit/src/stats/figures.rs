//! Many figures, all tested together.

use super::{Estimate, check_means};

/// Named figures and what they should be, all tested together.
///
/// ```
/// use tyndall_testkit::stats::{Figures, Moments};
/// let found: Moments = [0.9, 1.0, 1.1, 1.05, 0.95].into_iter().collect();
/// let mut figures = Figures::default();
/// figures.add("length", found.estimate(), 1.0, 0.05);
/// figures.check(1e-4);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Figures(Vec<(String, Estimate, f64)>);

impl Figures {
    /// A figure of a relative standard error no larger than `precision`.
    ///
    /// # Panics
    /// If it has a larger one: it would test nothing.
    #[track_caller]
    pub fn add(
        &mut self,
        name: impl Into<String>,
        estimate: Estimate,
        expected: f64,
        precision: f64,
    ) {
        let name = name.into();
        let found = estimate.relative_standard_error();
        assert!(found <= precision, "{name}: {found:.4} is too noisy");
        self.0.push((name, estimate, expected));
    }

    /// Two independent estimates of one thing.
    ///
    /// # Panics
    /// If either has a relative standard error larger than `precision`.
    #[track_caller]
    pub fn same(&mut self, name: impl Into<String>, a: Estimate, b: Estimate, precision: f64) {
        let name = name.into();
        for found in [a, b].map(|e| e.relative_standard_error()) {
            assert!(found <= precision, "{name}: {found:.4} is too noisy");
        }
        let difference = a.difference(&b);
        self.0
            .push((format!("{name}: {a:?} − {b:?}"), difference, 0.0));
    }

    /// A difference that should be 0, of a standard error no larger than `precision` times `of`,
    /// the value of what differs.
    ///
    /// # Panics
    /// If it has a larger one.
    #[track_caller]
    pub fn none(&mut self, name: impl Into<String>, difference: Estimate, of: f64, precision: f64) {
        let name = name.into();
        let found = difference.standard_error / of.abs();
        assert!(found <= precision, "{name}: {found:.4} is too noisy");
        self.0
            .push((format!("{name}, of {of:.4e}"), difference, 0.0));
    }

    /// Tests them, at this false-alarm rate for all together.
    ///
    /// # Panics
    /// If one is wrong, or there is none.
    #[track_caller]
    pub fn check(self, false_alarm: f64) {
        let cases: Vec<_> = self
            .0
            .iter()
            .map(|(name, estimate, expected)| (name.as_str(), *estimate, *expected))
            .collect();
        check_means(&cases, false_alarm).unwrap_or_else(|why| panic!("{why}"));
    }
}
