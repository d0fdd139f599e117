//! Sparse grids of values, in the shape of OpenVDB's.

mod builder;
mod dense;
mod leaves;
mod mask;
mod tree;

pub use builder::{SparseBuilder, TileSize};
pub use leaves::Precision;
pub use tree::{Piece, Tile};

use crate::field::{Cells, Field, Hint, Range, Region};
use crate::{Filter, MediumError};
use glam::{DAffine3, DVec3, IVec3, Vec3};
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;
use tree::{Found, LEAF, Tree, leaf_slot, leaf_voxel};
use tyndall_core::{Aabb, Spectrum};

/// Values on an endless regular grid, of which only those that differ from a background are stored:
/// OpenVDB's tree in its form 5-4-3, made by [`SparseBuilder`]. It holds any values; a medium takes
/// those that pass [`Field::check`], and a density only on a background of 0.
///
/// Voxel (i, j, k) has its centre at `to_world`·(i, j, k), and any affine transformation with an
/// inverse will do. Clones share their voxels; for their memory see [`SparseGrid::bytes`].
#[derive(Clone)]
pub struct SparseGrid<T = f32> {
    tree: Arc<Tree<T>>,
    to_world: DAffine3,
    to_index: DAffine3,
    filter: Filter,
    /// The first and the last voxel of the box of all that is not background.
    content: Option<[IVec3; 2]>,
    bounds: Aabb,
}

/// What the active voxels of a grid hold; all zero without any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics<T> {
    /// How many there are.
    pub voxels: u64,
    /// The smallest value in each channel.
    pub min: T,
    /// The largest.
    pub max: T,
    /// Their mean, summed in `f64`.
    pub mean: T,
}

impl<T: Debug> Debug for SparseGrid<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("SparseGrid")
            .field("background", &self.tree.background)
            .field("content", &self.content)
            .field("to_world", &self.to_world)
            .field("filter", &self.filter)
            .finish_non_exhaustive()
    }
}

const EVERYWHERE: Aabb = Aabb {
    min: Vec3::NEG_INFINITY,
    max: Vec3::INFINITY,
};

impl<T: Spectrum> SparseGrid<T> {
    fn of(tree: Tree<T>, to_world: DAffine3) -> Result<Self, MediumError> {
        let grid = Self {
            content: content(&tree),
            tree: Arc::new(tree),
            to_world: DAffine3::IDENTITY,
            to_index: DAffine3::IDENTITY,
            filter: Filter::default(),
            bounds: Aabb::EMPTY,
        };
        grid.placed(to_world)
    }

    /// The same grid elsewhere: `by` takes what is there to its new place.
    ///
    /// # Errors
    /// [`MediumError::Transform`] if that, after the grid's own, has no inverse.
    pub fn transformed(self, by: DAffine3) -> Result<Self, MediumError> {
        let to_world = by * self.to_world;
        self.placed(to_world)
    }

    /// The same grid with this transformation in place of its own.
    ///
    /// # Errors
    /// [`MediumError::Transform`] if it has no inverse.
    pub fn placed(self, to_world: DAffine3) -> Result<Self, MediumError> {
        let to_index = to_world.inverse();
        let has_inverse = |m: DAffine3| m.is_finite() && m.matrix3.determinant() != 0.0;
        if !(has_inverse(to_world) && has_inverse(to_index)) {
            return Err(MediumError::Transform);
        }
        let filter = self.filter;
        let grid = Self {
            to_world,
            to_index,
            ..self
        };
        Ok(grid.with_filter(filter))
    }

    /// The same grid, read with another filter.
    #[must_use]
    pub fn with_filter(self, filter: Filter) -> Self {
        let reach = match filter {
            Filter::Trilinear => 1.0,
            Filter::Nearest => 0.5,
        };
        let bounds = match self.content {
            _ if self.tree.background != T::default() => EVERYWHERE,
            None => Aabb::EMPTY,
            Some([first, last]) => {
                let (first, last) = (first.as_dvec3() - reach, last.as_dvec3() + reach);
                let size = DAffine3::from_scale(last - first);
                let to_world = self.to_world * DAffine3::from_translation(first) * size;
                Region { to_world }.bounds()
            }
        };
        Self {
            filter,
            bounds,
            ..self
        }
    }

    /// Takes whole voxels into space.
    pub fn to_world(&self) -> DAffine3 {
        self.to_world
    }

    /// The value of all voxels that are not stored.
    pub fn background(&self) -> T {
        self.tree.background
    }

    /// How voxels are kept.
    pub fn precision(&self) -> Precision {
        self.tree.leaves.precision()
    }

    /// The value of a voxel.
    pub fn voxel(&self, ijk: IVec3) -> T {
        self.value(self.tree.find(ijk), ijk)
    }

    /// The first and the last voxel of the box around all that differ from the background.
    pub fn content(&self) -> Option<[IVec3; 2]> {
        self.content
    }

    /// Visits every leaf and tile, with its first voxel.
    pub fn visit<'a>(&'a self, visit: impl FnMut(IVec3, Piece<'a, T>)) {
        self.tree.visit(visit);
    }

    /// The voxels of a leaf that [`SparseGrid::visit`] named; for their order see [`Piece::Leaf`].
    pub fn leaf_values(&self, leaf: u32) -> impl ExactSizeIterator<Item = T> + '_ {
        (0..leaves::VOXELS).map(move |slot| self.tree.leaves.value(leaf, slot))
    }

    /// Of the active voxels, those of tiles too.
    pub fn statistics(&self) -> Statistics<T> {
        let (mut voxels, mut range) = (0, None);
        let mut sums = vec![0.0; T::CHANNELS];
        let mut add = |value: T, n: u64| {
            voxels += n;
            let one = Range::of(value);
            range = Some(range.map_or(one, |so_far: Range<T>| so_far.join(one, 0.0)));
            for (c, sum) in sums.iter_mut().enumerate() {
                *sum += f64::from(value.channel(c)) * n as f64;
            }
        };
        self.visit(|_, piece| match piece {
            Piece::Tile { edge, tile } => {
                if tile.active {
                    add(tile.value, (edge as u64).pow(3));
                }
            }
            Piece::Leaf { leaf, active } => {
                for slot in tree::active_slots(active) {
                    add(self.tree.leaves.value(leaf, slot), 1);
                }
            }
        });
        let range = range.unwrap_or(Range::of(T::default()));
        Statistics {
            voxels,
            min: range.min,
            max: range.max,
            mean: T::from_channels(|c| (sums[c] / voxels.max(1) as f64) as f32),
        }
    }

    /// How many leaves there are.
    pub fn leaf_count(&self) -> usize {
        self.tree.leaves.len()
    }

    /// Bytes of memory held: for a grid of many leaves 1.04 times those of their voxels (2048 a
    /// leaf of one channel; half of it, and 1.07 times, in [`Precision::Half`]).
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.tree.bytes()
    }

    fn value(&self, found: Found<T>, ijk: IVec3) -> T {
        match found {
            Found::Leaf(leaf) => self.tree.leaves.value(leaf, leaf_slot(ijk)),
            Found::Constant(value) => value,
        }
    }

    /// The first voxel that is stored, and the first channel in it, whose value is `bad`; of a tile
    /// its first.
    fn find(&self, bad: impl Fn(f32) -> bool) -> Option<([i32; 3], usize, f32)> {
        let bad_channel = |value: T| (0..T::CHANNELS).find(|&c| bad(value.channel(c)));
        let mut first = None;
        let mut check = |voxel: IVec3, value: T| {
            if first.is_none()
                && let Some(c) = bad_channel(value)
            {
                first = Some((voxel.to_array(), c, value.channel(c)));
            }
        };
        self.visit(|origin, piece| match piece {
            Piece::Tile { tile, .. } => check(origin, tile.value),
            Piece::Leaf { leaf, .. } => {
                for (slot, value) in self.leaf_values(leaf).enumerate() {
                    check(origin + leaf_voxel(slot), value);
                }
            }
        });
        first
    }

    #[inline]
    fn found(&self, ijk: IVec3, hint: &mut Hint) -> Found<T> {
        let key = ijk >> LEAF.ilog2();
        let tree = Arc::as_ptr(&self.tree).addr();
        if key == hint.key && tree == hint.tree {
            return Found::Leaf(hint.leaf);
        }
        let found = self.tree.find(ijk);
        if let Found::Leaf(leaf) = found {
            *hint = Hint { tree, key, leaf };
        }
        found
    }

    #[inline]
    fn near(&self, ijk: IVec3, hint: &mut Hint) -> T {
        self.value(self.found(ijk, hint), ijk)
    }

    /// The voxel `base` and those after it, some of them in other leaves: each of these is found once.
    fn corners_across(&self, base: IVec3, hint: &mut Hint) -> [T; 8] {
        let corner = |i: usize| base.saturating_add(IVec3::from(CORNERS[i]));
        // The place among the corners of the first one beyond the leaf, along each axis.
        let beyond = (base & (LEAF - 1)).cmpeq(IVec3::splat(LEAF - 1));
        let across = [beyond.x, beyond.y, beyond.z].map(usize::from);
        let across = (across[0] << 2) | (across[1] << 1) | across[2];
        let mut found = [self.found(base, hint); 8];
        for i in (1..8).filter(|i| i & across == *i) {
            found[i] = self.tree.find(corner(i));
        }
        std::array::from_fn(|i| self.value(found[i & across], corner(i)))
    }

    /// Between the voxel `base` and the one after it in each axis; `fraction` in \[0, 1\].
    #[inline]
    fn interpolate(&self, base: IVec3, fraction: Vec3, hint: &mut Hint) -> T {
        let inner = (base & (LEAF - 1)).max_element() < LEAF - 1;
        let corners: [T; 8] = if inner {
            match self.found(base, hint) {
                Found::Constant(value) => return value,
                Found::Leaf(leaf) => {
                    let slot = leaf_slot(base);
                    CORNERS.map(|[x, y, z]| {
                        let corner = ((x << 6) | (y << 3) | z) as usize;
                        self.tree.leaves.value(leaf, slot + corner)
                    })
                }
            }
        } else {
            self.corners_across(base, hint)
        };
        let lerp = |a: T, b: T, s: f32| a * (1.0 - s) + b * s;
        let z = |i: usize| lerp(corners[i], corners[i + 1], fraction.z);
        let y = |i: usize| lerp(z(i), z(i + 2), fraction.y);
        lerp(y(0), y(4), fraction.x)
    }
}

/// The greatest whole numbers not above; without `f64::floor`, which is a call on many targets.
#[inline]
fn floor(x: DVec3) -> IVec3 {
    let toward_zero = x.as_ivec3();
    let above = toward_zero.as_dvec3().cmpgt(x);
    toward_zero.saturating_sub(IVec3::select(above, IVec3::ONE, IVec3::ZERO))
}

/// The corners of a cube, x slowest.
const CORNERS: [[i32; 3]; 8] = [
    [0, 0, 0],
    [0, 0, 1],
    [0, 1, 0],
    [0, 1, 1],
    [1, 0, 0],
    [1, 0, 1],
    [1, 1, 0],
    [1, 1, 1],
];

impl<T: Spectrum> Field<T> for SparseGrid<T> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    #[inline]
    fn lookup(&self, p: Vec3, hint: &mut Hint) -> T {
        let x = self.to_index.transform_point3(p.as_dvec3());
        match self.filter {
            Filter::Nearest => self.near(floor(x + 0.5), hint),
            Filter::Trilinear => {
                let base = floor(x);
                // Beyond the last voxel there is, `base` stays behind.
                let fraction = (x - base.as_dvec3()).as_vec3();
                self.interpolate(base, fraction.clamp(Vec3::ZERO, Vec3::ONE), hint)
            }
        }
    }

    fn range(&self, region: &Region) -> Range<T> {
        let Some([first, last]) = self.content else {
            return Range::of(self.tree.background);
        };
        // A hundredth of a voxel for the rounding of lookups.
        let [min, max] = region.bounds_in(&self.to_index);
        let [min, max] = match self.filter {
            Filter::Trilinear => [(min - 0.01).floor(), (max + 0.01).floor() + 1.0],
            Filter::Nearest => [(min + 0.49).floor(), (max + 0.51).floor()],
        };
        // One voxel around the content stands for all the background beyond.
        let (first, last) = (first.as_dvec3() - 1.0, last.as_dvec3() + 1.0);
        let cut = |x: DVec3| x.clamp(first, last).as_ivec3();
        self.tree.range(cut(min), cut(max))
    }

    fn check(&self) -> Result<(), MediumError> {
        let bad = |v: f32| !(v.is_finite() && v >= 0.0);
        if let Some((voxel, channel, value)) = self.find(bad) {
            return Err(MediumError::Voxel {
                voxel,
                channel,
                value,
            });
        }
        let background = |channel| self.tree.background.channel(channel);
        match (0..T::CHANNELS).find(|&c| bad(background(c))) {
            None => Ok(()),
            Some(channel) => Err(MediumError::Background {
                channel,
                value: background(channel),
            }),
        }
    }

    /// A leaf each, half a voxel off: what is read inside then lies in it or beside it.
    fn cells(&self) -> Cells {
        let leaf = f64::from(LEAF);
        let [first, last] = match self.bounds {
            bounds if bounds.is_empty() => [DVec3::ZERO; 2],
            bounds => Region::of(bounds).bounds_in(&self.to_index),
        };
        // A tenth of a voxel for the rounding of places.
        let first = ((first + 0.4) / leaf).floor();
        let size = ((last + 0.6) / leaf).floor() - first + 1.0;
        let corner = DAffine3::from_translation(leaf * first - 0.5);
        Cells {
            to_world: self.to_world * corner * DAffine3::from_scale(DVec3::splat(leaf)),
            size,
        }
    }
}

/// The box around all that is not background.
fn content<T: Spectrum>(tree: &Tree<T>) -> Option<[IVec3; 2]> {
    let mut content: Option<[IVec3; 2]> = None;
    let add = |content: &mut Option<[IVec3; 2]>, first: IVec3, last: IVec3| {
        *content = Some(match *content {
            None => [first, last],
            Some([a, b]) => [a.min(first), b.max(last)],
        });
    };
    tree.visit(|origin, piece| match piece {
        Piece::Tile { edge, tile } => {
            if tile.value != tree.background {
                add(&mut content, origin, origin + (edge - 1));
            }
        }
        Piece::Leaf { leaf, .. } => {
            let last = origin + (LEAF - 1);
            if content.is_some_and(|[a, b]| origin.cmpge(a).all() && last.cmple(b).all()) {
                return; // It can add nothing.
            }
            for slot in 0..leaves::VOXELS {
                if tree.leaves.value(leaf, slot) != tree.background {
                    let voxel = origin + leaf_voxel(slot);
                    add(&mut content, voxel, voxel);
                }
            }
        }
    });
    content
}
