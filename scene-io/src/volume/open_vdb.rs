//! OpenVDB files.

use super::VolumeGrid;

pub(super) const MAGIC: [u8; 8] = [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];

/// The grids of a file; those whose name is not `wanted` without their voxels. What is wrong is said in
/// a sentence that names the grid and the mend.
pub(super) fn read(bytes: &[u8], wanted: &dyn Fn(&str) -> bool) -> Result<Vec<VolumeGrid>, String> {
    let _ = (bytes, wanted);
    Err("OpenVDB files are not read yet".into())
}
