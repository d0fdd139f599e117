//! Media as a scene file describes them.

use crate::spectrum::{convert, is_grey};
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::{AnyMedium, DenseGrid, GridMedium, Homogeneous, MediumError, Phase, Tracking};

/// What fills a region.
#[derive(Clone, Debug)]
pub(crate) struct MediumDescription {
    /// In 1/scene unit; for a grid, where the density is 1.
    pub(crate) coefficients: Coefficients<Rgb>,
    pub(crate) phase: Phase,
    /// `None` if homogeneous.
    pub(crate) grid: Option<Grid>,
}

/// What varies in space.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) density: DenseGrid,
    pub(crate) albedo: Option<DenseGrid<Rgb>>,
    pub(crate) emission: Option<DenseGrid<Rgb>>,
    /// How transmittance is found.
    pub(crate) tracking: Tracking,
}

impl MediumDescription {
    pub(crate) fn is_grey(&self) -> bool {
        let Coefficients {
            sigma_a,
            sigma_s,
            emission,
        } = self.coefficients;
        let grid_is_grey = |grid: &Option<DenseGrid<Rgb>>| {
            let mut grey = true;
            if let Some(grid) = grid {
                // The mapped grid is of no interest, and no voxel of it can be wrong.
                let _ = grid.map(|c| {
                    grey &= is_grey(c);
                    c
                });
            }
            grey
        };
        [sigma_a, sigma_s, emission].into_iter().all(is_grey)
            && (self.grid.iter()).all(|g| grid_is_grey(&g.albedo) && grid_is_grey(&g.emission))
    }

    /// Whether its radiance grows without bound along a ray that never leaves it.
    pub(crate) fn glows_without_end(&self) -> bool {
        let c = &self.coefficients;
        let unabsorbed =
            (c.emission).zip(c.sigma_t(), |e, sigma| if sigma > 0.0 { 0.0 } else { e });
        self.grid.is_none() && !unabsorbed.is_black()
    }

    /// The medium itself.
    pub(crate) fn build<S: Spectrum>(&self) -> Result<AnyMedium<S>, MediumError> {
        let coefficients = Coefficients {
            sigma_a: convert(self.coefficients.sigma_a),
            sigma_s: convert(self.coefficients.sigma_s),
            emission: convert(self.coefficients.emission),
        };
        let phase = self.phase.clone();
        let Some(grid) = &self.grid else {
            return Homogeneous::new(coefficients, phase).map(AnyMedium::Homogeneous);
        };
        let mut medium = GridMedium::new(grid.density.clone(), coefficients, phase)?
            .with_tracking(grid.tracking);
        if let Some(albedo) = &grid.albedo {
            medium = medium.with_albedo(albedo.map(convert)?)?;
        }
        if let Some(emission) = &grid.emission {
            medium = medium.with_emission(emission.map(convert)?)?;
        }
        Ok(AnyMedium::Grid(Box::new(medium)))
    }
}
