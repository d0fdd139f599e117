//! What is told of a volume file.

use crate::progress::plain;
use indicatif::{HumanBytes, HumanCount};
use std::fmt::{self, Display};
use tyndall_scene_io::{GridClass, GridSummary, VolumeSummary, VoxelSummary};

/// A summary for people: a grid a paragraph, its name in front.
pub(super) struct Report<'a>(pub(super) &'a VolumeSummary);

impl Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let grids = count(self.0.grids.len() as u64, ["grid", "grids"]);
        write!(f, "file        {}, {grids}", HumanBytes(self.0.file_bytes))?;
        self.0.grids.iter().try_for_each(|g| grid(f, g))
    }
}

fn grid(f: &mut fmt::Formatter<'_>, grid: &GridSummary) -> fmt::Result {
    let name = match grid.name.as_str() {
        "" => "(no name)".to_owned(),
        name => plain(name),
    };
    let class = match grid.class {
        GridClass::FogVolume => ", fog volume",
        GridClass::LevelSet => ", level set",
        GridClass::Staggered => ", staggered",
        _ => "",
    };
    write!(f, "\ngrid        {name}: {}{class}", plain(&grid.kind))?;
    if let Some(why) = &grid.unsupported {
        write!(f, ", not read\n            {}", plain(why))?;
    }
    match &grid.voxels {
        Some(voxels) => self::voxels(f, voxels),
        None => Ok(()),
    }
}

fn voxels(f: &mut fmt::Formatter<'_>, voxels: &VoxelSummary) -> fmt::Result {
    let active = count(voxels.active, ["active voxel", "active voxels"]);
    write!(f, "\n            {active}")?;
    if let (Some(leaves), Some(tiles)) = (voxels.leaves, voxels.tiles) {
        let leaves = count(leaves, ["leaf", "leaves"]);
        let tiles = count(tiles, ["tile", "tiles"]);
        let background = channels(&voxels.background);
        write!(f, ", {leaves}, {tiles}, background {background}")?;
    }
    if let Some([first, last]) = voxels.index_box {
        write!(f, "\n            index {first:?} to {last:?}")?;
    }
    if let Some([min, max]) = voxels.world_box {
        write!(f, "\n            world {} to {}", list(min), list(max))?;
    }
    match voxels.voxel_size {
        Some([x, y, z]) if x == y && x == z => write!(f, "\n            voxel {}", number(x))?,
        Some(size) => write!(f, "\n            voxel {}", list(size))?,
        None => {
            let [x, y, z, origin] = voxels.to_world.map(list);
            write!(f, "\n            voxel turned, sheared or mirrored: ")?;
            write!(f, "axes {x}, {y}, {z}, origin {origin}")?;
        }
    }
    if let (Some(min), Some(max), Some(mean)) = (&voxels.min, &voxels.max, &voxels.mean) {
        let (min, max, mean) = (channels(min), channels(max), channels(mean));
        write!(f, "\n            min {min}, max {max}, mean {mean}")?;
    }
    if let Some(first) = voxels.first_non_finite {
        let voxels = count(voxels.non_finite, ["active voxel", "active voxels"]);
        write!(
            f,
            "\n            not finite: {voxels}, the first {first:?}; min, max and mean leave them out, and no medium takes them"
        )?;
    }
    write!(f, "\n            memory {}", HumanBytes(voxels.bytes))
}

/// So many of what is called so in singular and plural.
fn count(number: u64, [one, many]: [&str; 2]) -> String {
    let name = if number == 1 { one } else { many };
    format!("{} {name}", HumanCount(number))
}

/// One number if there is one channel.
fn channels<T: Copy + Into<f64>>(values: &[T]) -> String {
    let numbers: Vec<_> = values.iter().map(|&x| number(x.into())).collect();
    match numbers.as_slice() {
        [one] => one.clone(),
        all => format!("[{}]", all.join(", ")),
    }
}

fn list(values: [f64; 3]) -> String {
    channels(&values)
}

/// With the digits of a float, which is what files hold; with an exponent where it is long.
fn number(x: f64) -> String {
    // −0 is 0 to a reader.
    let x = x + 0.0;
    let (single, text) = (x as f32, format!("{:?}", x as f32));
    let fits = single.is_finite() == x.is_finite() && (single != 0.0 || x == 0.0);
    let text = if fits { text } else { format!("{x:?}") };
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short_and_right() {
        for (x, text) in [
            (f64::from(0.007_671_5_f32), "0.0076715"),
            (50.0, "50"),
            (-0.0, "0"),
            (3.499_153_5e-7, "3.4991535e-7"),
            (1e-300, "1e-300"),
            (-1e300, "-1e300"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(x), text);
        }
    }
}
