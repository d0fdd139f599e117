//! The radius within which a point gathers.

use glam::Vec3;
use tyndall_core::Spectrum;
use tyndall_density::Shrinkage;
use tyndall_kd_tree::{Nearest, Photons};
use tyndall_photons::{Aim, Neighbours, Search, Share};

/// How far the vertices of one kind gather in a pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub(crate) search: Search,
    pub(crate) shrinkage: Shrinkage,
    pub(crate) share: Share,
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

    /// Squared distances of the nearest of every map.
    fn search<S: Spectrum>(
        &mut self,
        center: Vec3,
        maps: &[&Photons<S>],
        Aim { count, limit, .. }: Aim,
    ) -> &mut [f32] {
        let Self { nearest, found } = self;
        if nearest.k() != count {
            *nearest = Nearest::new(count);
        }
        found.clear();
        for photons in maps {
            photons.nearest(center, limit, nearest);
            found.extend(nearest.found().iter().map(|n| n.distance_squared));
        }
        found
    }
}

impl Reach {
    /// The radius of the pass around `center`, among the photons of all `maps`; `None` if nothing
    /// tells.
    pub(crate) fn around<S: Spectrum>(
        &self,
        center: Vec3,
        maps: &[&Photons<S>],
        room: &mut Room,
    ) -> Option<f32> {
        match self.search {
            Search::Within(radius) => Some(radius),
            Search::Nearest(neighbours) => around(neighbours, center, maps, room),
        }
    }
}

/// As [`Search::visit`] finds it in one map.
fn around<S: Spectrum>(
    neighbours: Neighbours,
    center: Vec3,
    maps: &[&Photons<S>],
    room: &mut Room,
) -> Option<f32> {
    let aim = neighbours.aim(maps.iter().map(|photons| photons.len()).sum());
    let found = room.search(center, maps, aim);
    let last = found.len().min(aim.count).checked_sub(1)?;
    let reach = if last + 1 == aim.count || aim.limit == f32::INFINITY {
        let farthest = *found.select_nth_unstable_by(last, f32::total_cmp).1;
        farthest.sqrt().next_down()
    } else {
        aim.limit
    };
    Some(aim.part * reach)
}
