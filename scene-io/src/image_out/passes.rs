//! Which passes an image averages.

use super::Metadata;
use std::fmt;
use std::str::FromStr;

/// Passes `first` to `first + count − 1` of a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PassRange {
    /// Seed of the random numbers.
    pub seed: u64,
    /// The first pass.
    pub first: u64,
    /// How many.
    pub count: u64,
}

impl PassRange {
    /// The passes that are in both.
    pub fn shared(&self, other: &Self) -> Option<Self> {
        let first = self.first.max(other.first);
        let end = self.end().min(other.end());
        (self.seed == other.seed && first < end).then(|| Self {
            first,
            count: end - first,
            ..*self
        })
    }

    fn end(&self) -> u64 {
        self.first.saturating_add(self.count)
    }
}

impl fmt::Display for PassRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let last = self.end().saturating_sub(1);
        write!(f, "passes {} to {last} of seed {}", self.first, self.seed)
    }
}

/// A line of the attribute `tyndall.parts`: seed, first pass, passes.
impl FromStr for PassRange {
    type Err = String;

    fn from_str(line: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u64>, _> = line.split(' ').map(str::parse).collect();
        match numbers.as_deref() {
            Ok(&[seed, first, count]) => Ok(Self { seed, first, count }),
            _ => Err(format!(
                "{line:?} is not a seed, a first pass and a number of passes"
            )),
        }
    }
}

impl Metadata {
    /// The passes that the image averages: `parts`, or for one render its own.
    pub fn pass_ranges(&self) -> Vec<PassRange> {
        if self.parts.is_empty() {
            vec![PassRange {
                seed: self.seed,
                first: self.first_pass,
                count: self.passes,
            }]
        } else {
            self.parts.clone()
        }
    }

    /// Passes that this image and another both average, if there are any: the two are not
    /// independent then.
    pub fn shared_passes(&self, other: &Self) -> Option<PassRange> {
        let theirs = other.pass_ranges();
        let mut ours = self.pass_ranges().into_iter();
        ours.find_map(|a| theirs.iter().find_map(|b| a.shared(b)))
    }

    /// Says that the image averages these passes, adjacent ones of a seed as one range.
    pub fn set_pass_ranges(&mut self, mut ranges: Vec<PassRange>) {
        ranges.sort_unstable();
        ranges.dedup_by(|next, range| {
            let adjacent = next.seed == range.seed && next.first == range.end();
            if adjacent {
                range.count += next.count;
            }
            adjacent
        });
        if let Some(range) = ranges.first() {
            (self.seed, self.first_pass) = (range.seed, range.first);
        }
        self.passes = ranges.iter().map(|range| range.count).sum();
        self.parts = if ranges.len() > 1 { ranges } else { Vec::new() };
    }

    /// The lines of `tyndall.parts`.
    pub(super) fn parts_text(&self) -> String {
        let line = |p: &PassRange| format!("{} {} {}", p.seed, p.first, p.count);
        self.parts.iter().map(line).collect::<Vec<_>>().join("\n")
    }
}
