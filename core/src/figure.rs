//! What a pass tells about itself.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

/// A figure of a pass, for who looks at the picture: how far it can be trusted, what it took.
///
/// As text, `light paths: 200000 in all`, `error of transmittance: 0.004 at most` or
/// `radius in media: 0.2 to 0.5`; [`FromStr`] reads it back to the bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it is, in words on one line, with its unit if it has one.
    pub name: Cow<'static, str>,
    /// How much.
    pub value: FigureValue,
}

/// The value of a [`Figure`], and with it how those of several passes become one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FigureValue {
    /// A count; counts are added up.
    Total(u64),
    /// An error, or another thing of which the largest matters.
    Largest(f32),
    /// From the smallest to the largest.
    Range([f32; 2]),
}

impl Figure {
    /// A count.
    pub fn total(name: impl Into<Cow<'static, str>>, count: u64) -> Self {
        Self::new(name, FigureValue::Total(count))
    }

    /// Of which the largest matters.
    pub fn largest(name: impl Into<Cow<'static, str>>, value: f32) -> Self {
        Self::new(name, FigureValue::Largest(value))
    }

    /// Which other passes have smaller or larger.
    pub fn range(name: impl Into<Cow<'static, str>>, value: f32) -> Self {
        Self::new(name, FigureValue::Range([value; 2]))
    }

    /// Whether there is nothing to tell.
    pub fn is_zero(&self) -> bool {
        match self.value {
            FigureValue::Total(count) => count == 0,
            FigureValue::Largest(value) => value == 0.0,
            FigureValue::Range(range) => range == [0.0; 2],
        }
    }

    fn new(name: impl Into<Cow<'static, str>>, value: FigureValue) -> Self {
        let name = name.into();
        Self { name, value }
    }

    /// Adds the figures of another pass, or of other passes, to those of earlier ones. Values of
    /// different kinds stay apart, whatever their names.
    pub fn gather(all: &mut Vec<Self>, more: impl IntoIterator<Item = Self>) {
        for figure in more {
            let mut named = all.iter_mut().filter(|known| known.name == figure.name);
            let joined = named.find_map(|known| {
                known.value = known.value.join(figure.value)?;
                Some(())
            });
            if joined.is_none() {
                all.push(figure);
            }
        }
    }
}

impl FigureValue {
    /// Both in one, if they are of one kind.
    fn join(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Total(a), Self::Total(b)) => Some(Self::Total(a.saturating_add(b))),
            (Self::Largest(a), Self::Largest(b)) => Some(Self::Largest(a.max(b))),
            (Self::Range([a, b]), Self::Range([c, d])) => Some(Self::Range([a.min(c), b.max(d)])),
            _ => None,
        }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.name)?;
        match self.value {
            FigureValue::Total(count) => write!(f, "{count} in all"),
            FigureValue::Largest(value) => write!(f, "{value:?} at most"),
            FigureValue::Range([least, most]) => write!(f, "{least:?} to {most:?}"),
        }
    }
}

/// A text that is no [`Figure`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoFigure(String);

impl fmt::Display for NoFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:?} is no figure such as `light paths: 200000 in all`",
            self.0
        )
    }
}

impl std::error::Error for NoFigure {}

impl FromStr for Figure {
    type Err = NoFigure;

    fn from_str(text: &str) -> Result<Self, NoFigure> {
        let parsed = || {
            let (name, value) = text.rsplit_once(": ")?;
            let value = if let Some(count) = value.strip_suffix(" in all") {
                FigureValue::Total(count.parse().ok()?)
            } else if let Some(largest) = value.strip_suffix(" at most") {
                FigureValue::Largest(largest.parse().ok()?)
            } else {
                let (least, most) = value.split_once(" to ")?;
                FigureValue::Range([least.parse().ok()?, most.parse().ok()?])
            };
            Some(Self::new(name.to_owned(), value))
        };
        parsed().ok_or_else(|| NoFigure(text.to_owned()))
    }
}
