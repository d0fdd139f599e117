//! Which photons an estimate takes.

use glam::Vec3;
use tyndall_core::Spectrum;
use tyndall_density::Dimension;
use tyndall_kd_tree::{Nearest, Photons};

/// Photons looked for at least, if there are as many, so that the radius they give is no matter of
/// chance.
const FEWEST: usize = 16;

/// Photons looked for at most, where the radius is all that is wanted.
const MOST: f64 = 64.0;

/// The photons around a point that an estimate takes, and with them the radius of its kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// All within this distance.
    Within(f32),
    /// As far as some are near.
    Nearest(Neighbours),
}

/// The radius that holds so many photons on average.
///
/// It is the distance of the `photons`-th nearest, which is left out: with it a constant kernel
/// would overestimate by 1/(`photons` − 1). Of fewer than 16 the distance would be much a matter of
/// chance, and of less than one there is none: then the 16th nearest is looked for (or the last, of
/// maps that hold fewer), and the radius is cut down by the root of their ratio. A density taken
/// within is unbiased where photons are spread evenly, though the photons themselves tell it:
/// inside the distance of the k-th, itself left out, the others lie evenly, and so they do inside
/// any fixed part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbours {
    /// How many, more than 0.
    pub photons: f64,
    /// Over how many dimensions photons are spread: two on surfaces, three in media.
    pub dimension: Dimension,
    /// The radius is not larger; may be infinite. Where it ends the search, none is left out. Where
    /// nothing does, and there are not as many photons, the farthest is.
    pub max_radius: f32,
}

/// What is looked for to learn a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// The so many-th nearest, at least the 2nd.
    pub count: usize,
    /// But no farther away than this.
    pub limit: f32,
    /// Of its distance, or of the limit if there are fewer within it, what is taken for the radius.
    pub part: f32,
}

impl Neighbours {
    /// What to look for among so many photons.
    ///
    /// ```
    /// use tyndall_density::Dimension;
    /// use tyndall_photons::Neighbours;
    /// let mut neighbours = Neighbours {
    ///     photons: 50.0,
    ///     dimension: Dimension::Two,
    ///     max_radius: 1.0,
    /// };
    /// let aim = neighbours.aim(10_000);
    /// assert_eq!((aim.count, aim.limit, aim.part), (50, 1.0, 1.0));
    /// neighbours.photons = 4.0;
    /// let aim = neighbours.aim(10_000);
    /// assert_eq!((aim.count, aim.limit, aim.part), (16, 2.0, 0.5));
    /// ```
    pub fn aim(self, among: usize) -> Aim {
        self.with(self.photons.max(among.min(FEWEST) as f64).ceil().max(2.0))
    }

    /// What to look for among so many photons for the radius alone: as [`Neighbours::aim`], but of
    /// no more than 64, whose distance tells it to a few per cent, so that the work for all photons
    /// of a map stays linear in them.
    ///
    /// ```
    /// use tyndall_density::Dimension;
    /// use tyndall_photons::Neighbours;
    /// let neighbours = Neighbours {
    ///     photons: 512.0,
    ///     dimension: Dimension::Three,
    ///     max_radius: 1.0,
    /// };
    /// let pilot = neighbours.pilot(10_000);
    /// assert_eq!((pilot.count, pilot.limit, pilot.part), (64, 0.5, 2.0));
    /// ```
    pub fn pilot(self, among: usize) -> Aim {
        self.with((self.aim(among).count as f64).min(MOST))
    }

    /// The radius by so many photons.
    fn with(self, count: f64) -> Aim {
        let dimension = f64::from(self.dimension.number());
        let part = (self.photons / count).powf(dimension.recip()) as f32;
        Aim {
            count: count as usize,
            limit: self.max_radius / part,
            part,
        }
    }
}

impl Search {
    /// Calls `visit` with every photon taken (its slot), its squared distance and the radius.
    /// `room` is reused from one search to the next.
    pub fn visit<S: Spectrum>(
        self,
        photons: &Photons<S>,
        center: Vec3,
        room: &mut Nearest,
        mut visit: impl FnMut(usize, f32, f32),
    ) {
        let Aim { count, limit, part } = match self {
            Self::Nearest(neighbours) => neighbours.aim(photons.len()),
            Self::Within(radius) => {
                return photons.within(center, radius, |slot, distance_squared| {
                    visit(slot, distance_squared, radius);
                });
            }
        };
        if room.k() != count {
            *room = Nearest::new(count);
        }
        photons.nearest(center, limit, room);
        // The farthest is last. It is left out by its place, for its distance squared may round to
        // either side of its radius squared.
        let (reach, taken) = match room.found() {
            [nearer @ .., farthest] if nearer.len() + 1 == count || limit == f32::INFINITY => {
                (farthest.distance_squared.sqrt(), nearer)
            }
            all => (limit, all),
        };
        let radius = part * reach;
        for neighbour in taken {
            if part == 1.0 || neighbour.distance_squared < radius * radius {
                visit(neighbour.slot as usize, neighbour.distance_squared, radius);
            }
        }
    }
}
