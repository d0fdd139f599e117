//! Volume files.

use crate::volume::in_leaf;
use crate::{Error, GridClass, Volume, VolumeFormat, VolumeGrid, Voxels, read_grids, read_vol};
use glam::{DAffine3, DMat3, DVec3, IVec3};
use serde::Serialize;
use std::fs;
use std::path::Path;
use tyndall_core::Spectrum;
use tyndall_media::{Piece, SparseGrid};

/// What a volume file holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct VolumeSummary {
    /// Its length in bytes.
    pub file_bytes: u64,
    /// Its grids.
    pub grids: Vec<GridSummary>,
}

/// A grid of a volume file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GridSummary {
    /// Its name; empty in a `.vol` file, which has none.
    pub name: String,
    /// The type of its values as the file names it.
    pub kind: String,
    /// What they mean.
    pub class: GridClass,
    /// Why its voxels are not read, and the mend; `None` if they are.
    pub unsupported: Option<String>,
    /// Its voxels, if they are read.
    pub voxels: Option<VoxelSummary>,
}

/// The voxels of a grid. Those of a `.vol` file are all active, and its box is that which it names.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct VoxelSummary {
    /// Active voxels, those of tiles too.
    pub active: u64,
    /// Leaves of 8³ voxels; `None` where there is no tree.
    pub leaves: Option<u64>,
    /// Cubes of one value that stand for 8³ voxels or more, active or not; `None` without a tree.
    pub tiles: Option<u64>,
    /// First and last active voxel in each axis.
    pub index_box: Option<[[i32; 3]; 2]>,
    /// Smallest and largest corner of the box around active voxels, each of which is a cell with its
    /// value in the middle; in the units of the file.
    pub world_box: Option<[[f64; 3]; 2]>,
    /// Edges of a voxel, if it lies along the axes; `None` if voxels are turned, sheared or mirrored.
    pub voxel_size: Option<[f64; 3]>,
    /// Where a step along each axis of the grid leads in the world, then where voxel (0, 0, 0) is.
    pub to_world: [[f64; 3]; 4],
    /// The value of what is not stored, a number a channel.
    pub background: Vec<f32>,
    /// The smallest value of a finite active voxel, channel by channel; `None` if there is no such
    /// voxel.
    pub min: Option<Vec<f32>>,
    /// The largest.
    pub max: Option<Vec<f32>>,
    /// Their mean, summed in `f64`.
    pub mean: Option<Vec<f64>>,
    /// Active voxels with a NaN or an infinity in them, which the three above leave out.
    pub non_finite: u64,
    /// The first of these; of a tile its first voxel.
    pub first_non_finite: Option<[i32; 3]>,
    /// Bytes that the grid takes in memory.
    pub bytes: u64,
}

impl VolumeSummary {
    /// Of an OpenVDB, NanoVDB or `.vol` file, which is read for it.
    ///
    /// # Errors
    /// As of [`read_grids`]; a grid of a kind that is not read is none.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let grids = match VolumeFormat::of(path) {
            Some(VolumeFormat::Vol) => vec![dense(&read_vol(path)?)],
            _ => read_grids(path, &[])?.into_iter().map(sparse).collect(),
        };
        let about = fs::metadata(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
        Ok(Self {
            file_bytes: about.len(),
            grids,
        })
    }
}

fn dense(volume: &Volume) -> GridSummary {
    let [x, y, z] = volume.resolution;
    let mut tally = Tally::new(volume.channels);
    let mut voxels = volume.values.chunks_exact(volume.channels);
    for k in 0..z {
        for j in 0..y {
            for (i, value) in (0..x).zip(&mut voxels) {
                let voxel = IVec3::from([i, j, k].map(|i| i as i32));
                tally.add([voxel; 2], 1, |c| value[c]);
            }
        }
    }
    let count = DVec3::from([x, y, z].map(|n| n as f64));
    let [min, max] = volume.bounds;
    let voxel = (max - min) / count;
    let to_world = DAffine3 {
        matrix3: DMat3::from_diagonal(voxel),
        translation: min + 0.5 * voxel,
    };
    let background = vec![0.0; volume.channels];
    let bytes = size_of_val::<[f32]>(&volume.values);
    GridSummary {
        name: String::new(),
        kind: match volume.channels {
            1 => "float".into(),
            n => format!("{n} × float"),
        },
        class: GridClass::Unknown,
        unsupported: None,
        voxels: Some(tally.summary(to_world, background, None, bytes)),
    }
}

fn sparse(grid: VolumeGrid) -> GridSummary {
    let voxels = match &grid.voxels {
        Voxels::Scalar(voxels) => Some(tree(voxels)),
        Voxels::Vector(voxels) => Some(tree(voxels)),
        Voxels::Unread => None,
    };
    GridSummary {
        name: grid.name,
        kind: grid.kind,
        class: grid.class,
        unsupported: grid.unsupported,
        voxels,
    }
}

fn tree<T: Spectrum>(grid: &SparseGrid<T>) -> VoxelSummary {
    let mut tally = Tally::new(T::CHANNELS);
    let mut tiles = 0;
    grid.visit(|origin, piece| match piece {
        Piece::Tile { edge, tile } => {
            tiles += 1;
            if tile.active {
                let count = u64::from(edge.unsigned_abs()).pow(3);
                tally.add([origin, origin + (edge - 1)], count, |c| {
                    tile.value.channel(c)
                });
            }
        }
        Piece::Leaf { leaf, active } => {
            for (slot, value) in grid.leaf_values(leaf).enumerate() {
                if active[slot / 64] >> (slot % 64) & 1 == 1 {
                    tally.add([origin + in_leaf(slot); 2], 1, |c| value.channel(c));
                }
            }
        }
    });
    let background = grid.background();
    let background = (0..T::CHANNELS).map(|c| background.channel(c)).collect();
    let nodes = [grid.leaf_count() as u64, tiles];
    tally.summary(grid.to_world(), background, Some(nodes), grid.bytes())
}

/// What was seen of active voxels.
struct Tally {
    active: u64,
    index_box: Option<[IVec3; 2]>,
    /// Smallest, largest and sum of the finite ones, a channel each.
    channels: Vec<(f32, f32, f64)>,
    non_finite: u64,
    first_non_finite: Option<IVec3>,
}

impl Tally {
    fn new(channels: usize) -> Self {
        Self {
            active: 0,
            index_box: None,
            channels: vec![(f32::INFINITY, f32::NEG_INFINITY, 0.0); channels],
            non_finite: 0,
            first_non_finite: None,
        }
    }

    /// Counts voxels of one value, from the first to the last of a cube.
    fn add(&mut self, [first, last]: [IVec3; 2], count: u64, value: impl Fn(usize) -> f32) {
        self.active += count;
        self.index_box = Some(match self.index_box {
            None => [first, last],
            Some([a, b]) => [a.min(first), b.max(last)],
        });
        if !(0..self.channels.len()).all(|c| value(c).is_finite()) {
            self.non_finite += count;
            self.first_non_finite.get_or_insert(first);
            return;
        }
        for (c, (min, max, sum)) in self.channels.iter_mut().enumerate() {
            let value = value(c);
            *min = min.min(value);
            *max = max.max(value);
            *sum += f64::from(value) * count as f64;
        }
    }

    /// `nodes` are leaves and tiles.
    fn summary(
        self,
        to_world: DAffine3,
        background: Vec<f32>,
        nodes: Option<[u64; 2]>,
        bytes: usize,
    ) -> VoxelSummary {
        let finite = self.active - self.non_finite;
        let channels = (finite > 0).then_some(self.channels);
        let channels = channels.as_ref();
        let size = to_world.matrix3.diagonal();
        let along_axes = to_world.matrix3 == DMat3::from_diagonal(size);
        VoxelSummary {
            active: self.active,
            leaves: nodes.map(|[leaves, _]| leaves),
            tiles: nodes.map(|[_, tiles]| tiles),
            index_box: self.index_box.map(|corners| corners.map(|c| c.to_array())),
            world_box: self.index_box.map(|corners| world_box(to_world, corners)),
            voxel_size: (along_axes && size.cmpgt(DVec3::ZERO).all()).then(|| size.to_array()),
            to_world: to_world.to_cols_array_2d(),
            background,
            min: channels.map(|all| all.iter().map(|c| c.0).collect()),
            max: channels.map(|all| all.iter().map(|c| c.1).collect()),
            mean: channels.map(|all| all.iter().map(|c| c.2 / finite as f64).collect()),
            non_finite: self.non_finite,
            first_non_finite: self.first_non_finite.map(|voxel| voxel.to_array()),
            bytes: bytes as u64,
        }
    }
}

/// Around the cells from the first to the last.
fn world_box(to_world: DAffine3, [first, last]: [IVec3; 2]) -> [[f64; 3]; 2] {
    let (first, last) = (first.as_dvec3() - 0.5, last.as_dvec3() + 0.5);
    let corners = (0..8).map(|i| {
        let far = [i & 1, i & 2, i & 4].map(|bit| bit != 0);
        let pick = |axis: usize| if far[axis] { last[axis] } else { first[axis] };
        to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
    });
    let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let whole = corners.fold(nothing, |[min, max], p| [min.min(p), max.max(p)]);
    whole.map(|corner| corner.to_array())
}
