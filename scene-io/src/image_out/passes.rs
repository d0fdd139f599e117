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

/// Images of more passes than can be counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the passes are more than 2⁶⁴ − 1")]
pub struct TooManyPasses;

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

/// Passes of several ranges, if they can be counted.
fn total(ranges: &[PassRange]) -> Option<u64> {
    (ranges.iter()).try_fold(0_u64, |sum, range| sum.checked_add(range.count))
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

    /// Passes between others of their seed that the image does not average.
    pub fn missing_passes(&self) -> Vec<PassRange> {
        let mut ranges = self.pass_ranges();
        ranges.sort_unstable();
        let gap = |pair: &[PassRange]| {
            let (first, next) = (pair[0].end(), pair[1].first);
            (pair[0].seed == pair[1].seed && first < next).then(|| PassRange {
                first,
                count: next - first,
                ..pair[0]
            })
        };
        ranges.windows(2).filter_map(gap).collect()
    }

    /// Whether passes of the same number, of different seeds, are averaged: progressive methods
    /// give them the same radii.
    pub fn repeats_passes(&self) -> bool {
        let ranges = self.pass_ranges();
        let overlap = |a: &PassRange, b: &PassRange| {
            let same_seed = PassRange { seed: a.seed, ..*b };
            a.shared(&same_seed).is_some()
        };
        let mut pairs = (ranges.iter().enumerate())
            .flat_map(|(i, a)| ranges[i + 1..].iter().map(move |b| (a, b)));
        pairs.any(|(a, b)| overlap(a, b))
    }

    /// Says that the image averages the passes of another as well, adjacent ones of a seed as one
    /// range. The rest stays.
    ///
    /// # Errors
    /// [`TooManyPasses`]; nothing is changed then.
    pub fn add_passes(&mut self, other: &Self) -> Result<(), TooManyPasses> {
        let mut ranges = self.pass_ranges();
        ranges.extend(other.pass_ranges());
        // No sum of some of them overflows if that of all does not.
        self.passes = total(&ranges).ok_or(TooManyPasses)?;
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
        self.parts = if ranges.len() > 1 { ranges } else { Vec::new() };
        Ok(())
    }

    /// What is wrong with the passes that a file claims.
    pub(crate) fn check_passes(&self) -> Result<(), String> {
        let ranges = self.pass_ranges();
        if let Some(range) = (ranges.iter()).find(|p| p.first.checked_add(p.count).is_none()) {
            let PassRange { first, count, .. } = range;
            return Err(format!(
                "it claims {count} passes from {first} on, which is more than can be"
            ));
        }
        match total(&ranges) {
            Some(passes) if passes == self.passes => Ok(()),
            _ => Err(format!(
                "its attribute `tyndall.passes` is {}, and `tyndall.parts` do not add up to it",
                self.passes
            )),
        }
    }

    /// The lines of `tyndall.parts`.
    pub(super) fn parts_text(&self) -> String {
        let line = |p: &PassRange| format!("{} {} {}", p.seed, p.first, p.count);
        self.parts.iter().map(line).collect::<Vec<_>>().join("\n")
    }
}
