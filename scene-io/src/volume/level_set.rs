//! Level sets as densities.

use super::rebuild::rebuild;
use super::{ConversionError, GridClass, VolumeGrid, Voxels};
use tyndall_media::{SparseGrid, Tile};

impl VolumeGrid {
    /// A level set as fog: the density max(0, min(1, −d/w)) of the distance d, which is 1 inside,
    /// falls linearly to 0 over the inner half of the band around the surface, whose width w is the
    /// background, and is 0 outside. Active is what is above 0. Tiles stay tiles, and other grids
    /// what they are.
    ///
    /// Source: `sdfToFogVolume` of OpenVDB, with the background as cutoff.
    ///
    /// # Errors
    /// [`ConversionError::Band`] if the background is not positive and finite;
    /// [`ConversionError::Distance`] if a voxel is NaN.
    pub fn into_fog(self) -> Result<Self, ConversionError> {
        match (self.class, &self.voxels) {
            (GridClass::LevelSet, Voxels::Scalar(grid)) => Ok(Self {
                voxels: Voxels::Scalar(fog(grid)?),
                class: GridClass::FogVolume,
                ..self
            }),
            _ => Ok(self),
        }
    }
}

fn fog(grid: &SparseGrid) -> Result<SparseGrid, ConversionError> {
    let width = grid.background();
    if !(width > 0.0 && width.is_finite()) {
        return Err(ConversionError::Band { background: width });
    }
    let fog = rebuild(grid, grid.precision(), |distance: Tile<f32>| {
        // Less from 0, not negated: on the surface it is 0, not −0.
        let value = (0.0 - distance.value / width).clamp(0.0, 1.0);
        let active = value > 0.0;
        (!value.is_nan()).then_some(Tile { value, active })
    });
    fog.map_err(|(voxel, _)| ConversionError::Distance {
        voxel: voxel.to_array(),
    })
}
