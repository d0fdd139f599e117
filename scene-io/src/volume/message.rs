//! What is said of grids, and which can be written.

use super::VolumeGrid;
use super::open_vdb::SEPARATOR;

/// Bytes of the longest name that both formats hold.
const LONGEST_NAME: usize = 255;
/// Of a grid that is to be written.
pub(super) const UNREAD: &str = "its voxels were not read: ask for it by name, or leave it out";

/// What a file calls something: one line, not too long.
pub(super) fn shown(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let plain = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    text.chars().map(plain).take(80).collect()
}

/// A problem of the grid of this name.
pub(super) fn in_grid(name: &[u8], problem: impl AsRef<str>) -> String {
    format!("grid `{}`: {}", shown(name), problem.as_ref())
}

/// Whether grids can be written to a file of either format.
pub(super) fn check(grids: &[VolumeGrid]) -> Result<(), String> {
    if grids.is_empty() {
        return Err("there is no grid to write: name one at least".into());
    }
    let held = |name: &[u8]| {
        name.len() <= LONGEST_NAME && !name.iter().any(|byte| [0, SEPARATOR].contains(byte))
    };
    match grids.iter().find(|grid| !held(grid.name.as_bytes())) {
        None => Ok(()),
        Some(grid) => Err(in_grid(
            grid.name.as_bytes(),
            format!(
                "its name has {} bytes: give it one of at most {LONGEST_NAME}, without \\0 and \\x1e",
                grid.name.len()
            ),
        )),
    }
}
