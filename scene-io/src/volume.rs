//! Sparse volumes: OpenVDB and NanoVDB files.

mod blosc;
mod nano_vdb;
mod open_vdb;

use crate::Error;
use crate::image_out::write_whole;
use crate::open::read;
pub use nano_vdb::NanoCodec;
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
    /// The type of its values as the file names it, such as `float` or `half`.
    pub kind: String,
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
            voxels,
        }
    }
}

/// What the values of a grid mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GridClass {
    /// The file does not say.
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
pub enum Voxels {
    /// One channel: float, half, double.
    Scalar(SparseGrid<f32>),
    /// Three: a vector of these.
    Vector(SparseGrid<Rgb>),
    /// Not wanted, or of a type that has no use here.
    Unread,
}

/// Reads the grids of an OpenVDB or NanoVDB file whose name is `wanted`; of the others only what they
/// are ([`Voxels::Unread`]).
///
/// # Errors
/// [`Error::Read`] if the file cannot be read, [`Error::Volume`] if it is broken, of a kind that is not
/// read, or no such file.
pub fn read_volume(path: &Path, wanted: impl Fn(&str) -> bool) -> Result<Vec<VolumeGrid>, Error> {
    let bytes = read(path)?;
    let grids = if bytes.starts_with(&open_vdb::MAGIC) {
        open_vdb::read(&bytes, &wanted)
    } else if bytes.starts_with(nano_vdb::MAGIC) {
        nano_vdb::read(&bytes, &wanted)
    } else {
        Err("is neither an OpenVDB nor a NanoVDB file: export it as .vdb or .nvdb".into())
    };
    grids.map_err(|problem| Error::Volume {
        path: path.to_owned(),
        problem,
    })
}

/// Writes grids as an OpenVDB file, their voxels with the precision that they have. Files of the same
/// grids are the same to the byte. What was at `path` before stays if writing fails.
///
/// # Errors
/// [`Error::Write`], also if a grid is [`Voxels::Unread`].
pub fn write_open_vdb(path: &Path, grids: &[VolumeGrid]) -> Result<(), Error> {
    let bytes = open_vdb::write(grids).map_err(|reason| Error::write(path, reason))?;
    write_whole(path, |out| out.write_all(&bytes).map_err(|e| e.to_string()))
}

/// Writes grids to a NanoVDB file (32.4) as float or Vec3f, half precision as float. Nothing is left
/// half-written.
///
/// # Errors
/// [`Error::Write`] if the file cannot be written, there is no grid, one was not read or has a name of
/// 256 bytes or more.
pub fn write_nano_vdb(path: &Path, grids: &[VolumeGrid], codec: NanoCodec) -> Result<(), Error> {
    write_whole(path, |out| nano_vdb::write(out, grids, codec))
}
