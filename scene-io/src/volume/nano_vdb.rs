//! NanoVDB files.

use super::VolumeGrid;

pub(super) const MAGIC: &[u8] = b"NanoVDB";

/// The grids of a file; those whose name is not `wanted` without their voxels. What is wrong is said in
/// a sentence that names the grid and the mend.
pub(super) fn read(bytes: &[u8], wanted: &dyn Fn(&str) -> bool) -> Result<Vec<VolumeGrid>, String> {
    let _ = (bytes, wanted);
    Err("NanoVDB files are not read yet".into())
}
