//! Grids in 16 bits.

use super::rebuild::rebuild;
use super::{ConversionError, VolumeGrid, Voxels};
use half::f16;
use tyndall_core::Spectrum;
use tyndall_media::{Precision, SparseGrid, Tile};

impl VolumeGrid {
    /// The same grid with every value rounded to the nearest half: 11 bits of mantissa, multiples of
    /// 6e-8 below 6e-5. What is written of it to an OpenVDB file is halves.
    ///
    /// # Errors
    /// [`ConversionError::Half`] if a value that is finite would not be.
    pub fn into_half(self) -> Result<Self, ConversionError> {
        let voxels = match self.voxels {
            Voxels::Scalar(grid) => Voxels::Scalar(halved(&grid)?),
            Voxels::Vector(grid) => Voxels::Vector(halved(&grid)?),
            Voxels::Unread => return Ok(self),
        };
        Ok(Self::new(self.name, self.class, voxels))
    }
}

fn halved<T: Spectrum>(grid: &SparseGrid<T>) -> Result<SparseGrid<T>, ConversionError> {
    let round = |x: f32| f16::from_f32(x).to_f32();
    let overflows = |x: f32| x.is_finite() && !round(x).is_finite();
    let too_large = |value: T| {
        let channels = (0..T::CHANNELS).map(move |c| value.channel(c));
        channels.into_iter().find(|&x| overflows(x))
    };
    let half = rebuild(grid, Precision::Half, |tile| {
        let value = tile.value.map(round);
        too_large(tile.value)
            .is_none()
            .then_some(Tile { value, ..tile })
    });
    half.map_err(|(voxel, value)| ConversionError::Half {
        voxel: voxel.to_array(),
        value: too_large(value).unwrap_or_default(),
    })
}
