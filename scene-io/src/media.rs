//! Media as a scene file describes them.

use crate::spectrum::{convert, is_grey};
use glam::{DAffine3, DVec3};
use std::sync::Arc;
use tyndall_core::{Aabb, Coefficients, Rgb, Spectrum};
use tyndall_media::{
    AnyMedium, Atmosphere, BlackBody, DenseGrid, Field, GridMedium, Homogeneous, Mapped,
    MediumError, Overlap, Phase, Piece, Region, SparseGrid, Tracking,
};

/// Media that fill the same place, by index and in order; none is vacuum.
pub(crate) type Filling = Vec<usize>;

/// What fills a region. Points are those of the file.
#[derive(Clone, Debug)]
pub(crate) struct MediumDescription {
    /// In 1/scene unit; where the density is 1, if it varies.
    pub(crate) coefficients: Coefficients<Rgb>,
    pub(crate) phase: Phase,
    pub(crate) density: Density,
}

/// How dense a medium is from place to place.
#[derive(Clone, Debug)]
pub(crate) enum Density {
    Constant,
    /// 1 at the height of `origin`, less along `up`.
    Exponential {
        origin: DVec3,
        up: DVec3,
        scale_height: f32,
    },
    Grid(Box<Grid>),
}

/// What varies in space.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) density: Scalars,
    pub(crate) albedo: Option<Colours>,
    pub(crate) glow: Option<Glow>,
    /// How transmittance is found, where there is a choice.
    pub(crate) tracking: Tracking,
}

/// Numbers in space.
#[derive(Clone, Debug)]
pub(crate) enum Scalars {
    Dense(Boxed<f32>),
    Sparse(SparseGrid),
}

/// Colours in space.
#[derive(Clone, Debug)]
pub(crate) struct Colours {
    pub(crate) values: ColourValues,
    /// Of all values.
    pub(crate) factor: f32,
}

#[derive(Clone, Debug)]
pub(crate) enum ColourValues {
    Dense(Boxed<Rgb>),
    Sparse(SparseGrid<Rgb>),
    /// Of equal channels.
    Grey(SparseGrid),
}

/// What glows.
#[derive(Clone, Debug)]
pub(crate) enum Glow {
    Emission(Colours),
    Heat {
        temperature: Scalars,
        /// Kelvins where that is 1.
        factor: f32,
        body: BlackBody,
        /// Radiance where that of `body` is 1.
        luminance: f32,
    },
}

/// A grid in a box of the file.
#[derive(Clone, Debug)]
pub(crate) struct Boxed<T> {
    /// In a box of its own.
    pub(crate) grid: DenseGrid<T>,
    /// Smallest and largest corner.
    pub(crate) corners: [DVec3; 2],
}

impl<T: Spectrum> Boxed<T> {
    fn bounds(&self, origin: DVec3) -> Aabb {
        let [min, max] = self.corners.map(|p| (p - origin).as_vec3());
        Aabb { min, max }
    }

    /// The grid in its place, where `origin` is 0.
    fn place(&self, origin: DVec3) -> Result<DenseGrid<T>, MediumError> {
        self.grid.clone().with_bounds(self.bounds(origin))
    }
}

/// The grid where `origin` is 0.
fn moved<T: Spectrum>(grid: &SparseGrid<T>, origin: DVec3) -> Result<SparseGrid<T>, MediumError> {
    grid.clone()
        .transformed(DAffine3::from_translation(-origin))
}

fn most<T: Spectrum>(grid: &SparseGrid<T>) -> T {
    grid.range(&Region::of(grid.bounds())).max
}

impl Scalars {
    /// Its box where `origin` is 0.
    pub(crate) fn bounds(&self, origin: DVec3) -> Aabb {
        match self {
            Self::Dense(boxed) => boxed.bounds(origin),
            Self::Sparse(grid) => moved(grid, origin).map_or(Aabb::EMPTY, |grid| grid.bounds()),
        }
    }

    /// The largest value.
    pub(crate) fn max(&self) -> f32 {
        match self {
            Self::Dense(boxed) => boxed.grid.max(),
            Self::Sparse(grid) => most(grid),
        }
    }

    fn field(&self, origin: DVec3) -> Result<Arc<dyn Field<f32>>, MediumError> {
        Ok(match self {
            Self::Dense(boxed) => Arc::new(boxed.place(origin)?),
            Self::Sparse(grid) => Arc::new(moved(grid, origin)?),
        })
    }
}

impl Colours {
    fn is_grey(&self) -> bool {
        match &self.values {
            ColourValues::Dense(boxed) => boxed.grid.values().iter().copied().all(is_grey),
            ColourValues::Sparse(grid) => {
                let mut grey = is_grey(grid.background());
                grid.visit(|_, piece| {
                    grey &= match piece {
                        Piece::Tile { tile, .. } => is_grey(tile.value),
                        Piece::Leaf { leaf, .. } => grid.leaf_values(leaf).all(is_grey),
                    };
                });
                grey
            }
            ColourValues::Grey(_) => true,
        }
    }

    /// The largest value of each channel.
    pub(crate) fn max(&self) -> Rgb {
        let max = match &self.values {
            ColourValues::Dense(boxed) => boxed.grid.max(),
            ColourValues::Sparse(grid) => most(grid),
            ColourValues::Grey(grid) => Rgb::splat(most(grid)),
        };
        max * self.factor
    }

    /// In the channels of `S`, where `origin` is 0.
    fn field<S: Spectrum>(&self, origin: DVec3) -> Result<Arc<dyn Field<S>>, MediumError> {
        let factor = self.factor;
        let coloured = move |c: Rgb| convert::<S>(c * factor);
        Ok(match &self.values {
            ColourValues::Dense(boxed) => Arc::new(Mapped::rising(boxed.place(origin)?, coloured)),
            ColourValues::Sparse(grid) => Arc::new(Mapped::rising(moved(grid, origin)?, coloured)),
            ColourValues::Grey(grid) => Arc::new(Mapped::rising(moved(grid, origin)?, move |x| {
                S::splat(x * factor)
            })),
        })
    }
}

impl Grid {
    fn is_grey(&self) -> bool {
        let glow_is_grey = match &self.glow {
            None => true,
            Some(Glow::Emission(colours)) => colours.is_grey(),
            Some(Glow::Heat { .. }) => false,
        };
        glow_is_grey && self.albedo.as_ref().is_none_or(Colours::is_grey)
    }

    /// Albedo and emission added to a medium of its density.
    fn dress<S: Spectrum, D: Field<f32>>(
        &self,
        mut medium: GridMedium<S, D>,
        origin: DVec3,
    ) -> Result<GridMedium<S, D>, MediumError> {
        if let Some(albedo) = &self.albedo {
            medium = medium.with_albedo(albedo.field(origin)?)?;
        }
        match &self.glow {
            None => Ok(medium),
            Some(Glow::Emission(emission)) => medium.with_emission(emission.field(origin)?),
            Some(Glow::Heat {
                temperature,
                factor,
                body,
                luminance,
            }) => {
                let (factor, body, luminance) = (*factor, *body, *luminance);
                let colour = move |t: f32| convert::<S>(body.colour(t * factor) * luminance);
                medium.with_source(Mapped::rising(temperature.field(origin)?, colour))
            }
        }
    }

    fn build<S: Spectrum>(
        &self,
        coefficients: Coefficients<S>,
        phase: Phase,
        origin: DVec3,
    ) -> Result<AnyMedium<S>, MediumError> {
        Ok(match &self.density {
            Scalars::Dense(boxed) => {
                let medium = GridMedium::new(boxed.place(origin)?, coefficients, phase)?;
                let medium = medium.with_tracking(self.tracking);
                AnyMedium::Grid(Arc::new(self.dress(medium, origin)?))
            }
            Scalars::Sparse(grid) => {
                let medium = GridMedium::new(moved(grid, origin)?, coefficients, phase)?;
                AnyMedium::Sparse(Arc::new(self.dress(medium, origin)?))
            }
        })
    }
}

impl MediumDescription {
    pub(crate) fn is_grey(&self) -> bool {
        let Coefficients {
            sigma_a,
            sigma_s,
            emission,
        } = self.coefficients;
        [sigma_a, sigma_s, emission].into_iter().all(is_grey)
            && self.grid().is_none_or(Grid::is_grey)
    }

    /// What varies, if it is a grid.
    pub(crate) fn grid(&self) -> Option<&Grid> {
        match &self.density {
            Density::Grid(grid) => Some(grid),
            _ => None,
        }
    }

    /// The medium itself, where `origin` is 0.
    pub(crate) fn build<S: Spectrum>(&self, origin: DVec3) -> Result<AnyMedium<S>, MediumError> {
        let coefficients = Coefficients {
            sigma_a: convert(self.coefficients.sigma_a),
            sigma_s: convert(self.coefficients.sigma_s),
            emission: convert(self.coefficients.emission),
        };
        let phase = self.phase.clone();
        match &self.density {
            Density::Constant => Homogeneous::new(coefficients, phase).map(AnyMedium::Homogeneous),
            Density::Exponential {
                origin: zero,
                up,
                scale_height,
            } => {
                let [zero, up] = [*zero - origin, *up].map(DVec3::as_vec3);
                Atmosphere::new(zero, up, *scale_height, coefficients, phase)
                    .map(AnyMedium::Atmosphere)
            }
            Density::Grid(grid) => grid.build(coefficients, phase, origin),
        }
    }
}

/// What all `parts` are in the same place.
pub(crate) fn together<S: Spectrum>(parts: Vec<AnyMedium<S>>) -> Result<AnyMedium<S>, MediumError> {
    match <[_; 1]>::try_from(parts) {
        Ok([one]) => Ok(one),
        Err(parts) => Overlap::new(parts).map(AnyMedium::Overlap),
    }
}

/// Whether the radiance of these media together grows without bound along a ray that never leaves
/// them.
pub(crate) fn glow_without_end<'a>(
    media: impl Iterator<Item = &'a MediumDescription> + Clone,
) -> bool {
    let unabsorbed = |counts: fn(&Density) -> bool| {
        let counted = media.clone().filter(|m| counts(&m.density));
        let (emission, sigma_t) = counted.fold(Default::default(), |(e, s): (Rgb, Rgb), m| {
            (e + m.coefficients.emission, s + m.coefficients.sigma_t())
        });
        !emission
            .zip(sigma_t, |e, s| if s > 0.0 { 0.0 } else { e })
            .is_black()
    };
    // An atmosphere is as endless, but not everywhere.
    unabsorbed(|density| matches!(density, Density::Constant))
        || unabsorbed(|density| !matches!(density, Density::Grid(_)))
}
