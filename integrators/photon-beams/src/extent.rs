//! How far beams go.

use std::fmt;

/// How far a beam goes, of light or of sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Extent {
    /// To the next surface, attenuated by the transmittance on the way: the less noise.
    Long,
    /// No farther than light flies until it collides, and as bright all along: a free flight is an
    /// estimate of the transmittance, to all distances at once.
    Short,
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Long => "long",
            Self::Short => "short",
        })
    }
}
