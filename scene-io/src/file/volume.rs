//! Grids that a medium names: of `.vol`, OpenVDB and NanoVDB files.

use super::reader::{Field, Table};
use crate::files::Files;
use crate::media::{Boxed, ColourValues, Scalars};
use crate::vol::{Volume, read_vol};
use crate::{Error, GridClass, VolumeFormat, VolumeGrid, Voxels, read_volume};
use glam::{DAffine3, DVec3, Vec3};
use std::cell::RefCell;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use tyndall_core::{Aabb, Rgb, Spectrum};
use tyndall_media::{DenseGrid, Field as _, Filter, SparseGrid};

/// What dense grids fill until they are placed.
pub(super) const UNIT: Aabb = Aabb {
    min: Vec3::ZERO,
    max: Vec3::ONE,
};

/// Where the grids of a medium are, and how they are read.
#[derive(Clone, Copy)]
pub(super) struct Placing {
    /// Of sparse grids, after their own transformation.
    pub(super) transform: DAffine3,
    /// Of dense grids, if not as their files say.
    pub(super) corners: Option<[DVec3; 2]>,
    pub(super) filter: Filter,
}

/// A grid of a file, as a medium names it.
pub(super) struct Source<'a> {
    /// What names it.
    field: Field<'a>,
    file: &'a str,
    grid: Option<Field<'a>>,
    /// The grid's name, unless the medium says another.
    usual: &'static str,
}

impl<'a> Source<'a> {
    /// The `file` and the `grid` of a table; without `file`, it is that of `other`.
    pub(super) fn of(
        table: &Table<'a>,
        usual: &'static str,
        other: Option<&Self>,
    ) -> Result<Self, Error> {
        let (field, file) = match (table.optional("file"), other) {
            (None, Some(other)) => (table.field().clone(), other.file),
            _ => {
                let field = table.required("file")?;
                let file = field.string()?;
                (field, file)
            }
        };
        Ok(Self {
            field,
            file,
            grid: table.optional("grid"),
            usual,
        })
    }

    /// A file without more.
    pub(super) fn file(field: &Field<'a>, usual: &'static str) -> Result<Self, Error> {
        Ok(Self {
            field: field.clone(),
            file: field.string()?,
            grid: None,
            usual,
        })
    }

    /// Whether it is a `.vol` file: these have no names and no transformation.
    pub(super) fn is_dense(&self) -> bool {
        VolumeFormat::of(Path::new(self.file)) == Some(VolumeFormat::Vol)
    }

    fn dense(&self, files: &Files) -> Result<Volume, Error> {
        if let Some(grid) = &self.grid {
            return Err(grid.error("a .vol file has one grid without a name: remove the key"));
        }
        read_vol(&files.named(self.file)).map_err(|e| self.field.error(e))
    }
}

/// The volume files of a scene. A grid that several media name is read once, and they share it.
pub(super) struct Volumes<'a> {
    files: &'a Files,
    read: RefCell<Vec<Read>>,
}

/// A file of which grids were read.
struct Read {
    path: PathBuf,
    names: Vec<String>,
    grids: Vec<VolumeGrid>,
}

impl<'a> Volumes<'a> {
    pub(super) fn new(files: &'a Files) -> Self {
        let read = RefCell::default();
        Self { files, read }
    }

    /// Numbers of a file.
    pub(super) fn scalars(&self, source: &Source<'_>, placing: &Placing) -> Result<Scalars, Error> {
        if source.is_dense() {
            let volume = source.dense(self.files)?;
            let corners = placing.corners.unwrap_or(volume.bounds);
            if volume.channels != 1 {
                let n = volume.channels;
                let why = format!("has {n} channels where 1 is needed: write one of 1");
                return Err(self.fault(source, why));
            }
            let grid = self.boxed(source, volume.resolution, volume.values, placing)?;
            return Ok(Scalars::Dense(Boxed { grid, corners }));
        }
        let grid = self.sparse(source)?;
        match grid.voxels {
            Voxels::Scalar(voxels) => self.placed(source, voxels, placing).map(Scalars::Sparse),
            _ => {
                let why = format!(
                    "grid {:?} holds vectors where numbers are needed: name another with `grid`",
                    grid.name
                );
                Err(self.fault(source, why))
            }
        }
    }

    /// Colours of a file; of one channel, they are grey.
    pub(super) fn colours(
        &self,
        source: &Source<'_>,
        placing: &Placing,
    ) -> Result<ColourValues, Error> {
        if source.is_dense() {
            let volume = source.dense(self.files)?;
            let corners = placing.corners.unwrap_or(volume.bounds);
            let values: Vec<_> = match volume.channels {
                1 => volume.values.into_iter().map(Rgb::splat).collect(),
                3 => (volume.values.chunks_exact(3))
                    .map(|c| Rgb::new(c[0], c[1], c[2]))
                    .collect(),
                n => {
                    let why = format!("has {n} channels: write one of 1 or 3 channels");
                    return Err(self.fault(source, why));
                }
            };
            let grid = self.boxed(source, volume.resolution, values, placing)?;
            return Ok(ColourValues::Dense(Boxed { grid, corners }));
        }
        match self.sparse(source)?.voxels {
            Voxels::Vector(grid) => self.placed(source, grid, placing).map(ColourValues::Sparse),
            Voxels::Scalar(grid) => self.placed(source, grid, placing).map(ColourValues::Grey),
            Voxels::Unread => Err(self.fault(source, CHANGED)),
        }
    }

    /// A complaint about a file.
    pub(super) fn fault(&self, source: &Source<'_>, problem: impl Display) -> Error {
        let path = self.files.named(source.file);
        source.field.error(format!("{}: {problem}", path.display()))
    }

    fn boxed<T: Spectrum>(
        &self,
        source: &Source<'_>,
        resolution: [usize; 3],
        values: Vec<T>,
        placing: &Placing,
    ) -> Result<DenseGrid<T>, Error> {
        let grid = DenseGrid::new(resolution, UNIT, values);
        let grid = grid.map_err(|e| self.fault(source, e))?;
        Ok(grid.with_filter(placing.filter))
    }

    fn placed<T: Spectrum>(
        &self,
        source: &Source<'_>,
        grid: SparseGrid<T>,
        placing: &Placing,
    ) -> Result<SparseGrid<T>, Error> {
        let placed = || {
            grid.check()?;
            let grid = grid.transformed(placing.transform)?;
            Ok::<_, tyndall_media::MediumError>(grid.with_filter(placing.filter))
        };
        placed().map_err(|e| self.fault(source, e))
    }

    /// A grid of an OpenVDB or NanoVDB file.
    fn sparse(&self, source: &Source<'_>) -> Result<VolumeGrid, Error> {
        let path = self.files.named(source.file);
        let mut read = self.read.borrow_mut();
        let known = match read.iter().position(|r| r.path == path) {
            Some(i) => i,
            None => {
                // Which grids there are.
                let all = read_volume(&path, |_| false).map_err(|e| source.field.error(e))?;
                read.push(Read {
                    path,
                    names: all.into_iter().map(|grid| grid.name).collect(),
                    grids: Vec::new(),
                });
                read.len() - 1
            }
        };
        let read = &mut read[known];
        let name = self.name(source, &read.names)?;
        if let Some(grid) = read.grids.iter().find(|grid| grid.name == name) {
            return Ok(grid.clone());
        }
        let grids = read_volume(&read.path, |n| n == name).map_err(|e| source.field.error(e))?;
        let grid = grids.into_iter().find(|grid| grid.name == name);
        let grid = grid.ok_or_else(|| self.fault(source, CHANGED))?;
        if grid.class == GridClass::LevelSet {
            let why = format!(
                "grid {name:?} is a level set, distances to a surface: make fog of it with `tyndall \
                 volume convert {} -o fog.vdb --fog`",
                read.path.display()
            );
            return Err(self.fault(source, why));
        }
        read.grids.push(grid.clone());
        Ok(grid)
    }

    /// The name of the grid that is meant among those of the file: what the medium says, the usual
    /// one, or the only one.
    fn name(&self, source: &Source<'_>, names: &[String]) -> Result<String, Error> {
        let known: Vec<_> = names.iter().map(String::as_str).collect();
        let name = match (&source.grid, known.as_slice()) {
            (Some(field), _) => known[field.name_in("grid", &known)?],
            (None, [only]) => only,
            (None, _) if known.contains(&source.usual) => source.usual,
            (None, []) => return Err(self.fault(source, "has no grids: export it again")),
            (None, _) => {
                let why = format!(
                    "has no grid {:?} but {}: name one with `grid`",
                    source.usual,
                    known.join(", ")
                );
                return Err(self.fault(source, why));
            }
        };
        match known.iter().filter(|&&n| n == name).count() {
            1 => Ok(name.to_owned()),
            n => {
                let why = format!("has {n} grids {name:?}: give them different names");
                Err(self.fault(source, why))
            }
        }
    }

    /// The grids that no medium names, a line each file.
    pub(super) fn notices(&self) -> Vec<String> {
        let read = self.read.borrow();
        let notice = |read: &Read| {
            let used = |name: &&String| !read.grids.iter().any(|grid| grid.name == **name);
            let unused: Vec<_> = read.names.iter().filter(used).map(String::as_str).collect();
            let velocity = unused.iter().any(|name| VELOCITY.contains(name));
            let why = if velocity {
                "; velocity does not blur the image"
            } else {
                ""
            };
            let (path, unused_) = (read.path.display(), unused.join(", "));
            (!unused.is_empty()).then(|| format!("{path}: no medium uses {unused_}{why}"))
        };
        read.iter().filter_map(notice).collect()
    }
}

const CHANGED: &str = "changes while it is read: try again";

/// What exporters call the motion of a volume.
const VELOCITY: [&str; 7] = ["velocity", "vel", "v", "motion", "vel.x", "vel.y", "vel.z"];
