//! The radius within which a point gathers.

use glam::Vec3;
use tyndall_core::Spectrum;
use tyndall_density::Shrinkage;
use tyndall_kd_tree::{Nearest, Photons};

/// Photons looked for at least, so that the radius they give is no matter of chance; it is then cut
/// down to what fewer would have.
const FEWEST: f64 = 16.0;

/// The starting radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Start {
    /// Holds so many photons of the starting paths.
    Nearest(usize),
    /// Is given.
    Radius(f32),
}

/// How far the vertices of one kind gather in a pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub(crate) start: Start,
    pub(crate) shrinkage: Shrinkage,
    /// Light paths of the pass over those for which the starting radius is meant.
    pub(crate) share: f64,
    /// Radius of the pass over the starting radius.
    pub(crate) scale: f32,
    max_radius: f32,
}

/// Room for searches.
#[derive(Debug)]
pub(crate) struct Room {
    nearest: Nearest,
    /// Squared distances found, of all maps.
    found: Vec<f32>,
}

impl Room {
    pub(crate) fn new() -> Self {
        Self {
            nearest: Nearest::new(0),
            found: Vec::new(),
        }
    }
}

impl Reach {
    pub(crate) fn new(
        start: Start,
        shrinkage: Shrinkage,
        share: f64,
        scale: f32,
        max_radius: f32,
    ) -> Self {
        Self {
            start,
            shrinkage,
            share,
            scale,
            max_radius,
        }
    }

    /// The radius of the pass around `center`, among the photons of all `maps`; `None` if nothing
    /// tells.
    ///
    /// A density taken within it is unbiased where photons are spread evenly, though the photons
    /// themselves tell it: inside the distance of the k-th nearest, itself left out, the others lie
    /// evenly, and so they do inside any fixed part of it.
    pub(crate) fn around<S: Spectrum>(
        &self,
        center: Vec3,
        maps: &[&Photons<S>],
        room: &mut Room,
    ) -> Option<f32> {
        let photons = match self.start {
            Start::Radius(radius) => return Some(radius * self.scale),
            Start::Nearest(photons) => photons as f64,
        };
        let dimension = f64::from(self.shrinkage.dimension().number());
        let wanted = photons * self.share * f64::from(self.scale).powf(dimension);
        let count = wanted.max(FEWEST).ceil() as usize;
        let found = self.search(center, maps, count, room);
        let farthest = if found.len() >= count {
            *found.select_nth_unstable_by(count - 1, f32::total_cmp).1
        } else {
            found.iter().copied().fold(0.0, f32::max)
        };
        let found = found.len().min(count);
        let reach = if found == count || self.max_radius == f32::INFINITY {
            farthest.sqrt().next_down()
        } else {
            self.max_radius
        };
        let part = (wanted / found as f64).min(1.0).powf(dimension.recip());
        (found > 0).then_some(reach * part as f32)
    }

    /// Squared distances of the `count` nearest of every map.
    fn search<'r, S: Spectrum>(
        &self,
        center: Vec3,
        maps: &[&Photons<S>],
        count: usize,
        Room { nearest, found }: &'r mut Room,
    ) -> &'r mut [f32] {
        if nearest.k() != count {
            *nearest = Nearest::new(count);
        }
        found.clear();
        for photons in maps {
            photons.nearest(center, self.max_radius, nearest);
            found.extend(nearest.found().iter().map(|n| n.distance_squared));
        }
        found
    }
}
