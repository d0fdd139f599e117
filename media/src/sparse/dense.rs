//! Sparse grids of dense ones, and back.

use super::leaves::VOXELS;
use super::tree::{LEAF, blocks, leaf_slot};
use super::{Precision, SparseBuilder, SparseGrid};
use crate::field::Hint;
use crate::{DenseGrid, MediumError};
use glam::{DAffine3, DMat3, DVec3, IVec3};
use tyndall_core::{Aabb, Spectrum};

impl<T: Spectrum> SparseGrid<T> {
    /// The voxels of a dense grid in their places, those that are not zero active. Around them it
    /// is zero, where a dense grid ends at its box.
    ///
    /// # Errors
    /// [`MediumError::Transform`] if the voxels of the dense grid are too small to be told apart.
    pub fn from_dense(grid: &DenseGrid<T>, precision: Precision) -> Result<Self, MediumError> {
        let background = T::default();
        let mut sparse = SparseBuilder::new(background).with_precision(precision);
        let count = IVec3::from(grid.resolution().map(|n| n as i32));
        for origin in blocks(IVec3::ZERO, count - 1, LEAF) {
            let (mut values, mut active) = ([background; VOXELS], [0; 8]);
            let last = (origin + (LEAF - 1)).min(count - 1);
            for voxel in blocks(origin, last, 1) {
                let value = grid.voxel(voxel.to_array());
                if value != background {
                    let slot = leaf_slot(voxel);
                    values[slot] = value;
                    active[slot / 64] |= 1 << (slot % 64);
                }
            }
            if active != [0; 8] {
                sparse.leaf(origin, &values, active)?;
            }
        }
        let Aabb { min, .. } = grid.bounds();
        let voxel = grid.bounds().size().as_dvec3() / count.as_dvec3();
        let center = min.as_dvec3() + 0.5 * voxel;
        let to_world = DAffine3::from_mat3_translation(DMat3::from_diagonal(voxel), center);
        Ok(sparse.build(to_world)?.with_filter(grid.filter()))
    }

    /// All that is not background, with one voxel of it around, as a dense grid of the same filter.
    ///
    /// # Errors
    /// [`MediumError::NotAligned`] if the voxels are turned, sheared or mirrored;
    /// [`MediumError::NotDense`] if all are background or more than [`MediumError::MOST_VALUES`];
    /// others as [`DenseGrid::new`].
    pub fn to_dense(&self) -> Result<DenseGrid<T>, MediumError> {
        let DAffine3 {
            matrix3,
            translation,
        } = self.to_world;
        let voxel = matrix3.diagonal();
        if matrix3 != DMat3::from_diagonal(voxel) || voxel.cmple(DVec3::ZERO).any() {
            return Err(MediumError::NotAligned);
        }
        let none = MediumError::NotDense { resolution: [0; 3] };
        let [first, last] = self.content.ok_or(none)?;
        let [first, last] = [first.as_i64vec3() - 1, last.as_i64vec3() + 1];
        let resolution = (last - first + 1).to_array().map(|n| n as usize);
        let count = resolution
            .iter()
            .try_fold(1_usize, |n, &m| n.checked_mul(m));
        let count = count.filter(|&n| n <= MediumError::MOST_VALUES);
        let count = count.ok_or(MediumError::NotDense { resolution })?;
        let mut values = Vec::with_capacity(count);
        let mut hint = Hint::default();
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let ijk = [x, y, z].map(|i| i as i32);
                    values.push(self.near(IVec3::from(ijk), &mut hint));
                }
            }
        }
        let corner = |ijk: DVec3| (translation + voxel * ijk).as_vec3();
        let bounds = Aabb {
            min: corner(first.as_dvec3() - 0.5),
            max: corner(last.as_dvec3() + 0.5),
        };
        Ok(DenseGrid::new(resolution, bounds, values)?.with_filter(self.filter))
    }
}
