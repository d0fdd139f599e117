//! What passes and pixels hold.

use crate::reach::Reach;
use tyndall_core::StateError;
use tyndall_density::Statistics;
use tyndall_photons::{PhotonMaps, Search};

/// The photons of a pass, and how far to gather them.
#[derive(Clone, Debug)]
pub struct Pass<S> {
    pub(crate) maps: PhotonMaps<S>,
    pub(crate) surfaces: Reach,
    pub(crate) media: Reach,
}

/// What a pixel remembers of the photons that its walks of sight have found, 32 bytes: nothing
/// where radii are memoryless.
///
/// Its vertices are new in every pass; those on surfaces share one radius and count, those in media
/// another (Hachisuka & Jensen 2009, "shared statistics"). The flux that the paper stores as well
/// is not here: the mean over passes of what each estimates, with its radius before the update,
/// *is* the paper's estimate (see [`Statistics`]), and the film takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Of its vertices on surfaces. Radius 0: none has found a photon yet.
    pub surfaces: Statistics,
    /// Of its vertices in media.
    pub media: Statistics,
}

impl Default for Pixel {
    fn default() -> Self {
        Self {
            surfaces: Statistics::new(0.0),
            media: Statistics::new(0.0),
        }
    }
}

impl Pixel {
    pub(crate) fn save(&self, bytes: &mut Vec<u8>) {
        for Statistics { radius, count } in [self.surfaces, self.media] {
            bytes.extend(radius.to_le_bytes());
            bytes.extend(count.to_le_bytes());
        }
    }

    pub(crate) fn restore(bytes: &mut &[u8]) -> Result<Self, StateError> {
        let mut statistics = || {
            let [radius, count] = [number(bytes)?, number(bytes)?];
            Ok(Statistics { radius, count })
        };
        Ok(Self {
            surfaces: statistics()?,
            media: statistics()?,
        })
    }
}

/// Takes a number off the front: finite, and not negative.
fn number(bytes: &mut &[u8]) -> Result<f64, StateError> {
    let (first, rest) = bytes.split_first_chunk().ok_or(StateError::Corrupt)?;
    *bytes = rest;
    let number = f64::from_le_bytes(*first);
    let sound = (0.0..f64::INFINITY).contains(&number);
    sound.then_some(number).ok_or(StateError::Corrupt)
}

/// The vertices of one kind of a pixel, in a pass.
pub(crate) struct Place<'p> {
    reach: Reach,
    /// Where radii shrink by statistics.
    statistics: Option<&'p mut Statistics>,
    /// Photons found in the pass.
    found: u64,
}

impl<'p> Place<'p> {
    pub(crate) fn new(reach: Reach, statistics: Option<&'p mut Statistics>) -> Self {
        Self {
            reach,
            statistics,
            found: 0,
        }
    }

    /// The radius for a vertex; `measure` is what the photons around it tell.
    pub(crate) fn radius(&mut self, measure: impl FnOnce(&Reach) -> Option<f32>) -> Option<f32> {
        match &mut self.statistics {
            None => measure(&self.reach),
            Some(statistics) if statistics.radius > 0.0 => Some(statistics.radius as f32),
            Some(statistics) => {
                let radius = measure(&self.reach).filter(|radius| *radius > 0.0)?;
                statistics.radius = f64::from(radius);
                Some(radius)
            }
        }
    }

    pub(crate) fn found(&mut self, photons: u32) {
        self.found += u64::from(photons);
    }

    /// Ends the pass. The first photons tell with how many kept the place begins: those that the
    /// starting paths would have found.
    pub(crate) fn remember(self) {
        let Some(statistics) = self.statistics else {
            return;
        };
        let found = self.found as f64;
        if statistics.count == 0.0 && found > 0.0 {
            let of_pass = match self.reach.search {
                Search::Nearest(neighbours) => neighbours.photons,
                Search::Within(_) => found,
            };
            statistics.count = of_pass / self.reach.share.paths;
        }
        statistics.update(found, self.reach.shrinkage);
    }
}
