//! Quantities that vary in space.

use crate::MediumError;
use glam::{DAffine3, DMat3, DVec3, IVec3, Vec3};
use std::fmt::Debug;
use std::sync::Arc;
use tyndall_core::{Aabb, Spectrum};

/// A quantity at every point of a box: a density, an albedo, a temperature.
///
/// [`DenseGrid`](crate::DenseGrid) and [`SparseGrid`](crate::SparseGrid) are two; a renderer with
/// noise of its own implements this, or wraps a closure in [`Procedural`](crate::Procedural).
pub trait Field<T>: Debug + Send + Sync {
    /// A box outside which it is zero: a medium does not look there. Infinite if there is none.
    fn bounds(&self) -> Aabb;

    /// Its value at a point inside. `hint` is what the last lookup nearby left there, be it of
    /// another field; it changes no value.
    fn lookup(&self, p: Vec3, hint: &mut Hint) -> T;

    /// Bounds of all lookups inside a region, which may reach out of the box. They may be wider than
    /// need be, at a cost of time; where they are too narrow, the image is wrong.
    fn range(&self, region: &Region) -> Range<T>;

    /// Whether a medium can take it: nothing may be negative or not finite.
    ///
    /// # Errors
    /// What is wrong where.
    fn check(&self) -> Result<(), MediumError>;

    /// The cells whose bounds are worth asking for; they cover all that is not zero.
    fn cells(&self) -> Cells;
}

impl<T, F: Field<T> + ?Sized> Field<T> for Arc<F> {
    fn bounds(&self) -> Aabb {
        (**self).bounds()
    }

    fn lookup(&self, p: Vec3, hint: &mut Hint) -> T {
        (**self).lookup(p, hint)
    }

    fn range(&self, region: &Region) -> Range<T> {
        (**self).range(region)
    }

    fn check(&self) -> Result<(), MediumError> {
        (**self).check()
    }

    fn cells(&self) -> Cells {
        (**self).cells()
    }
}

/// Where in a field the last lookup was.
#[derive(Clone, Copy, Debug)]
pub struct Hint {
    /// Of this tree, by its address.
    pub(crate) tree: usize,
    pub(crate) key: IVec3,
    pub(crate) leaf: u32,
}

impl Default for Hint {
    fn default() -> Self {
        Self {
            tree: 0,
            key: IVec3::MAX,
            leaf: 0,
        }
    }
}

/// A lattice of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// Takes corners of cells, whole numbers from 0 on, into space.
    pub to_world: DAffine3,
    /// How many there are along each axis, at most 2³⁰; of the last there may be a part.
    pub size: DVec3,
}

/// A part of space: a box, maybe turned and sheared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Takes the unit cube there.
    pub to_world: DAffine3,
}

impl Cells {
    /// A box in so many equal cells along each axis; of the last there may be a part.
    pub fn of(bounds: Aabb, count: DVec3) -> Self {
        let place = DAffine3::from_translation(bounds.min.as_dvec3());
        Self {
            to_world: place * DAffine3::from_scale(bounds.size().as_dvec3() / count),
            size: count,
        }
    }

    /// The same box in cells of an eighth of the edge, as often as it takes that none is much longer
    /// than the least edge of `other`.
    pub(crate) fn refined_to(mut self, other: &Self) -> Self {
        let edges = |cells: &Self| {
            let DMat3 {
                x_axis,
                y_axis,
                z_axis,
            } = cells.to_world.matrix3;
            DVec3::from([x_axis, y_axis, z_axis].map(DVec3::length))
        };
        let finest = 2.0 * edges(other).min_element();
        while edges(&self).max_element() > finest && self.size.max_element() < MOST_CELLS / 8.0 {
            self.to_world *= DAffine3::from_scale(DVec3::splat(0.125));
            self.size *= 8.0;
        }
        self
    }
}

/// Cells along an axis.
pub(crate) const MOST_CELLS: f64 = (1 << 30) as f64;

impl Region {
    /// A box along the axes; where it has no end, it ends at the largest `f32`.
    pub fn of(bounds: Aabb) -> Self {
        let end = DVec3::splat(f32::MAX.into());
        let [min, max] = [bounds.min, bounds.max].map(|p| p.as_dvec3().clamp(-end, end));
        let size = DAffine3::from_scale(max - min);
        Self {
            to_world: DAffine3::from_translation(min) * size,
        }
    }

    /// The least and the greatest coordinates of the region in another frame.
    pub fn bounds_in(&self, from_world: &DAffine3) -> [DVec3; 2] {
        let DAffine3 {
            matrix3,
            translation,
        } = *from_world * self.to_world;
        let [mut min, mut max] = [translation; 2];
        for edge in [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis] {
            min += edge.min(DVec3::ZERO);
            max += edge.max(DVec3::ZERO);
        }
        [min, max]
    }

    /// The box around it, never smaller.
    pub fn bounds(&self) -> Aabb {
        let [min, max] = self.bounds_in(&DAffine3::IDENTITY);
        let down = |x: f64| {
            let rounded = x as f32;
            if f64::from(rounded) > x {
                rounded.next_down()
            } else {
                rounded
            }
        };
        Aabb {
            min: Vec3::from_array(min.to_array().map(down)),
            max: -Vec3::from_array((-max).to_array().map(down)),
        }
    }

    /// Its longest diagonal.
    pub fn diagonal(&self) -> f64 {
        let m = self.to_world.matrix3;
        let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let length = |[y, z]: [f64; 2]| (m.x_axis + y * m.y_axis + z * m.z_axis).length();
        signs.map(length).into_iter().fold(0.0, f64::max)
    }
}

/// What is known of many values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range<T> {
    /// Nothing is smaller, channel by channel.
    pub min: T,
    /// Nothing is larger.
    pub max: T,
    /// Their mean, roughly: it guides sampling and biases nothing.
    pub mean: T,
}

impl<T: Spectrum> Range<T> {
    /// A single value.
    #[inline]
    pub fn of(value: T) -> Self {
        Self {
            min: value,
            max: value,
            mean: value,
        }
    }

    /// Of two sets of values; `share` of them, from 0 to 1, are `other`'s.
    #[must_use]
    pub fn join(self, other: Self, share: f32) -> Self {
        Self {
            min: self.min.zip(other.min, f32::min),
            max: self.max.zip(other.max, f32::max),
            mean: self.mean * (1.0 - share) + other.mean * share,
        }
    }
}

/// Counts values one by one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gather<T> {
    range: Option<Range<T>>,
    count: f32,
}

impl<T: Spectrum> Gather<T> {
    pub(crate) fn new() -> Self {
        Self {
            range: None,
            count: 0.0,
        }
    }

    /// Counts `n` values of this range.
    pub(crate) fn add(&mut self, range: Range<T>, n: f32) {
        self.count += n;
        self.range = Some(match self.range {
            None => range,
            Some(so_far) => so_far.join(range, n / self.count),
        });
    }

    /// Zero if there were none.
    pub(crate) fn range(self) -> Range<T> {
        self.range.unwrap_or(Range::of(T::default()))
    }
}

impl<T: Spectrum> FromIterator<T> for Range<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        let mut gather = Gather::new();
        for value in values {
            gather.add(Self::of(value), 1.0);
        }
        gather.range()
    }
}
