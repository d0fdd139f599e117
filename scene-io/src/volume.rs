//! Sparse volumes: OpenVDB and NanoVDB files.

mod blosc;
mod bytes;
mod dense;
mod half;
mod level;
mod level_set;
mod message;
mod nano_vdb;
mod open_vdb;
mod rebuild;
mod skeleton;

use crate::Error;
use crate::file::nearest;
use crate::image_out::write_whole;
use crate::open::read;
use crate::vol::read_vol;
pub(crate) use dense::write_dense;
pub use nano_vdb::NanoCodec;
pub(crate) use rebuild::in_leaf;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use tyndall_core::Rgb;
use tyndall_media::{Precision, SparseGrid};

/// A grid of a volume file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct VolumeGrid {
    /// Its name, as `density`; names may repeat.
    pub name: String,
    /// What its values mean.
    pub class: GridClass,
    /// The type of its values: as the file names it, such as `float`, but `half` or `vec3h` for those that
    /// an OpenVDB file stores as halves, whatever their type; a type that is not read may stand with
    /// the form of its tree. Of a new grid, the type of OpenVDB that has its precision.
    pub kind: String,
    /// Why its voxels cannot be read, whatever is asked for: a sentence with the mend.
    pub unsupported: Option<String>,
    /// Its voxels.
    pub voxels: Voxels,
}

impl VolumeGrid {
    /// A grid that is to be written.
    pub fn new(name: impl Into<String>, class: GridClass, voxels: Voxels) -> Self {
        let of = |precision, [single, half]: [&'static str; 2]| match precision {
            Precision::Single => single,
            Precision::Half => half,
        };
        let kind = match &voxels {
            Voxels::Scalar(grid) => of(grid.precision(), ["float", "half"]),
            Voxels::Vector(grid) => of(grid.precision(), ["vec3s", "vec3h"]),
            Voxels::Unread => "unread",
        };
        Self {
            name: name.into(),
            class,
            kind: kind.into(),
            unsupported: None,
            voxels,
        }
    }
}

/// What the values of a grid mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum GridClass {
    /// The file does not say, or says what has no use here.
    #[default]
    Unknown,
    /// A density.
    FogVolume,
    /// Distances to a surface, negative inside.
    LevelSet,
    /// Components of a vector on the faces of voxels, such as a velocity.
    Staggered,
}

/// The voxels of a grid.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Voxels {
    /// One channel: float, half, double.
    Scalar(SparseGrid<f32>),
    /// Three: a vector of these.
    Vector(SparseGrid<Rgb>),
    /// Not wanted, or of a type that has no use here.
    Unread,
}

/// What kind of volume file a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeFormat {
    /// OpenVDB, `.vdb`.
    OpenVdb,
    /// NanoVDB, `.nvdb`.
    NanoVdb,
    /// Mitsuba's, `.vol`.
    Vol,
}

impl VolumeFormat {
    /// By the extension, in capitals or not; `None` if it is that of no volume.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_ascii_lowercase();
        Some(match extension.to_str()? {
            "vdb" => Self::OpenVdb,
            "nvdb" => Self::NanoVdb,
            "vol" => Self::Vol,
            _ => return None,
        })
    }
}

/// Why a grid could not be made another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConversionError {
    /// The band of a level set has no width.
    #[error(
        "its background, the half width of the band of a level set, is {background}: make it positive and finite"
    )]
    Band {
        /// The background.
        background: f32,
    },
    /// A distance is none.
    #[error("its voxel {voxel:?} is NaN: give it a distance")]
    Distance {
        /// The first bad voxel.
        voxel: [i32; 3],
    },
    /// A value is too large for halves.
    #[error("its voxel {voxel:?} is {value} and halves end at 65504: keep it in 32 bits")]
    Half {
        /// The first bad voxel; of a tile its first, or \[0, 0, 0\] if it is the background.
        voxel: [i32; 3],
        /// Its value in the first channel that is too large.
        value: f32,
    },
}

/// Which grids of a file to read the voxels of, asked of each without them.
type Wanted<'a> = dyn Fn(&VolumeGrid) -> bool + 'a;

/// Reads the grids of an OpenVDB or NanoVDB file whose name is `wanted`; of the others only what they
/// are ([`Voxels::Unread`]).
///
/// # Errors
/// [`Error::Read`] if the file cannot be read, [`Error::Volume`] if it is damaged, of a kind that is not
/// read, or no such file.
pub fn read_volume(path: &Path, wanted: impl Fn(&str) -> bool) -> Result<Vec<VolumeGrid>, Error> {
    read_wanted(path, &|grid| wanted(&grid.name))
}

/// Reads the grids of these names; without names all that can be read, and of the others what they
/// are and why they cannot ([`VolumeGrid::unsupported`]). A `.vol` file is one grid, which is called
/// `density` if it has one channel and `albedo` if it has three; its voxels that are 0 are inactive.
///
/// # Errors
/// As of [`read_volume`], or of [`read_vol`] if the extension is `.vol`; [`Error::Volume`] also if
/// there is no grid of a name, which names the nearest.
pub fn read_grids(path: &Path, names: &[String]) -> Result<Vec<VolumeGrid>, Error> {
    let wanted = |grid: &VolumeGrid| match names {
        [] => grid.unsupported.is_none(),
        names => names.contains(&grid.name),
    };
    let mut grids = match VolumeFormat::of(path) {
        Some(VolumeFormat::Vol) => {
            let grid = dense::sparse(read_vol(path)?);
            vec![grid.map_err(|problem| volume_error(path, problem))?]
        }
        _ => read_wanted(path, &wanted)?,
    };
    let is_there = |name: &String| grids.iter().any(|grid| grid.name == *name);
    if let Some(name) = names.iter().find(|name| !is_there(name)) {
        let known = grids.iter().map(|grid| grid.name.as_str());
        let mend = match nearest(name, known.clone()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if grids.is_empty() => "it holds none".into(),
            None => {
                let known: Vec<_> = known.map(|name| format!("`{name}`")).collect();
                format!("choose one of {}", known.join(", "))
            }
        };
        return Err(volume_error(
            path,
            format!("there is no grid `{name}`; {mend}"),
        ));
    }
    grids.retain(|grid| names.is_empty() || wanted(grid));
    Ok(grids)
}

fn read_wanted(path: &Path, wanted: &Wanted<'_>) -> Result<Vec<VolumeGrid>, Error> {
    let bytes = read(path)?;
    let grids = if bytes.starts_with(&open_vdb::MAGIC) {
        open_vdb::read(&bytes, wanted)
    } else if bytes.starts_with(nano_vdb::MAGIC) {
        nano_vdb::read(&bytes, wanted)
    } else {
        Err("it is neither an OpenVDB nor a NanoVDB file: export it as .vdb or .nvdb".into())
    };
    grids.map_err(|problem| volume_error(path, problem))
}

fn volume_error(path: &Path, problem: String) -> Error {
    Error::Volume {
        path: path.to_owned(),
        problem,
    }
}

/// Writes grids as an OpenVDB file, their voxels with the precision that they have. Files of the same
/// grids are the same to the byte. What was at `path` before stays if writing fails.
///
/// # Errors
/// [`Error::Write`] if the file cannot be written, there is no grid, one is [`Voxels::Unread`], or its
/// name has more than 255 bytes, a zero byte or the byte 0x1e: OpenVDB or NanoVDB cannot hold those.
pub fn write_open_vdb(path: &Path, grids: &[VolumeGrid]) -> Result<(), Error> {
    let bytes = message::check(grids).and_then(|()| open_vdb::write(grids));
    let bytes = bytes.map_err(|reason| Error::write(path, reason))?;
    write_whole(path, |out| out.write_all(&bytes).map_err(|e| e.to_string()))
}

/// Writes grids to a NanoVDB file (32.4) as float or Vec3f, half precision as float. A class that
/// NanoVDB does not know of such values, as fog of vectors, becomes unknown. What was at `path` before
/// stays if writing fails.
///
/// # Errors
/// As of [`write_open_vdb`].
pub fn write_nano_vdb(path: &Path, grids: &[VolumeGrid], codec: NanoCodec) -> Result<(), Error> {
    message::check(grids).map_err(|reason| Error::write(path, reason))?;
    write_whole(path, |out| nano_vdb::write(out, grids, codec))
}
