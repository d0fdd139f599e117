//! Dense grids of values.

use crate::MediumError;
use crate::field::{Cells, Field, Hint, Range, Region};
use crate::lattice::{Lattice, clip, counts};
use glam::{DAffine3, DVec3, Vec3};
use std::fmt::{self, Debug, Formatter};
use std::ops::ControlFlow;
use std::sync::Arc;
use tyndall_core::{Aabb, Ray, Spectrum};

/// The nodes of the Gauss–Legendre rule of two points, ±1/√3: exact for cubics.
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// How a grid is read between the centres of its voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Continuous: linear in each axis.
    #[default]
    Trilinear,
    /// Constant within each voxel.
    Nearest,
}

/// Values on a regular grid that fills a box: one channel (a density) or several (an albedo).
///
/// Voxel `[x, y, z]` of `[nx, ny, nz]` is value `(z·ny + y)·nx + x` and has its centre at
/// (x + ½)/nx, … of the box; outside the outermost centres the value is constant. Mitsuba's
/// `gridvolume` with wrap mode `clamp` is the same function. Clones share their values.
///
/// ```
/// use glam::Vec3;
/// use tyndall_core::Aabb;
/// use tyndall_media::DenseGrid;
/// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(2.0, 1.0, 1.0) };
/// let grid = DenseGrid::new([2, 1, 1], bounds, vec![1.0_f32, 3.0])?;
/// assert_eq!(grid.lookup(Vec3::new(0.75, 0.5, 0.5)), 1.5);
/// # Ok::<(), tyndall_media::MediumError>(())
/// ```
#[derive(Clone)]
pub struct DenseGrid<T = f32> {
    resolution: [usize; 3],
    bounds: Aabb,
    values: Arc<[T]>,
    filter: Filter,
    /// Voxels per scene unit.
    scale: Vec3,
}

impl<T> Debug for DenseGrid<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("DenseGrid")
            .field("resolution", &self.resolution)
            .field("bounds", &self.bounds)
            .field("filter", &self.filter)
            .finish_non_exhaustive()
    }
}

/// Voxels per scene unit.
fn scale(resolution: [usize; 3], bounds: Aabb) -> Result<Vec3, MediumError> {
    let scale = counts(resolution) / bounds.size();
    let good = has_volume(bounds) && scale.is_finite();
    good.then_some(scale).ok_or(MediumError::GridBounds)
}

impl<T: Spectrum> DenseGrid<T> {
    /// A grid of `values`, x fastest, that fills `bounds`, read trilinearly.
    ///
    /// # Errors
    /// [`MediumError::GridBounds`] if the box has no volume, [`MediumError::GridValues`] if the
    /// number of values is wrong or zero, [`MediumError::Voxel`] if one is negative or not finite.
    pub fn new(resolution: [usize; 3], bounds: Aabb, values: Vec<T>) -> Result<Self, MediumError> {
        let scale = scale(resolution, bounds)?;
        let voxels = resolution
            .iter()
            .try_fold(1_usize, |n, &m| n.checked_mul(m));
        if values.is_empty() || voxels != Some(values.len()) {
            let values = values.len();
            return Err(MediumError::GridValues { resolution, values });
        }
        let grid = Self {
            resolution,
            bounds,
            values: values.into(),
            filter: Filter::default(),
            scale,
        };
        match grid.find(|v| !(v.is_finite() && v >= 0.0)) {
            None => Ok(grid),
            Some((voxel, channel, value)) => Err(MediumError::Voxel {
                voxel,
                channel,
                value,
            }),
        }
    }

    /// The same grid, read with another filter.
    #[must_use]
    pub fn with_filter(self, filter: Filter) -> Self {
        Self { filter, ..self }
    }

    /// The same grid in another box.
    ///
    /// # Errors
    /// [`MediumError::GridBounds`] if that has no volume.
    pub fn with_bounds(self, bounds: Aabb) -> Result<Self, MediumError> {
        let scale = scale(self.resolution, bounds)?;
        Ok(Self {
            bounds,
            scale,
            ..self
        })
    }

    /// The same grid with `f` applied to every value, for instance [`Spectrum::splat`] to make a
    /// coloured grid of a grey one.
    ///
    /// # Errors
    /// As [`DenseGrid::new`].
    pub fn map<U: Spectrum>(&self, f: impl FnMut(T) -> U) -> Result<DenseGrid<U>, MediumError> {
        let values = self.values.iter().copied().map(f).collect();
        let grid = DenseGrid::new(self.resolution, self.bounds, values)?;
        Ok(grid.with_filter(self.filter))
    }

    /// Voxels in each axis.
    pub fn resolution(&self) -> [usize; 3] {
        self.resolution
    }

    /// The voxels, x fastest.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The box that it fills.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How it is read between the centres of its voxels.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// The value at `p`, by the filter; points outside read the nearest face.
    #[inline]
    pub fn lookup(&self, p: Vec3) -> T {
        let p = p.clamp(self.bounds.min, self.bounds.max);
        let x = (p - self.bounds.min) * self.scale;
        match self.filter {
            // x is not negative: truncation is `floor`, which is a call on many targets.
            Filter::Nearest => self.voxel(x.as_ivec3().to_array()),
            Filter::Trilinear => {
                let base = (x + 0.5).as_ivec3() - 1;
                self.interpolate(base.to_array(), x - 0.5 - base.as_vec3())
            }
        }
    }

    /// The largest value in each channel.
    pub fn max(&self) -> T {
        largest(self.values.iter().copied())
    }

    /// The voxels that lookups inside `region` may read: those in it, and up to one more on every
    /// side.
    fn footprint(&self, region: &Region) -> impl Iterator<Item = T> {
        let cell = self.bounds.size().as_dvec3() / counts(self.resolution).as_dvec3();
        let to_cells = DAffine3::from_scale(cell.recip())
            * DAffine3::from_translation(-self.bounds.min.as_dvec3());
        let [first, last] = region.bounds_in(&to_cells);
        let [x, y, z] = std::array::from_fn(|i| {
            // A hundredth of a voxel for the rounding of lookups.
            let clamp = |g: f64| (g.max(0.0) as usize).min(self.resolution[i] - 1);
            clamp((first[i] - 0.51).floor())..clamp((last[i] - 0.49).ceil()) + 1
        });
        let [nx, ny, _] = self.resolution;
        let rows = z.flat_map(move |z| y.clone().map(move |y| (z * ny + y) * nx));
        rows.flat_map(move |row| self.values[row + x.start..row + x.end].iter().copied())
    }

    /// The first voxel, and the first channel in it, whose value is `bad`.
    pub(crate) fn find(&self, bad: impl Fn(f32) -> bool) -> Option<([i32; 3], usize, f32)> {
        let [nx, ny, _] = self.resolution;
        self.values.iter().enumerate().find_map(|(i, value)| {
            let channel = (0..T::CHANNELS).find(|&c| bad(value.channel(c)))?;
            let voxel = [i % nx, i / nx % ny, i / nx / ny].map(|i| i as i32);
            Some((voxel, channel, value.channel(channel)))
        })
    }

    /// The value of a voxel, or of the nearest there is.
    #[inline]
    pub(crate) fn voxel(&self, index: [i32; 3]) -> T {
        let [x, y, z] = self.place(index);
        self.values[(z * self.resolution[1] + y) * self.resolution[0] + x]
    }

    /// The voxel of this index, or the nearest there is.
    #[inline]
    fn place(&self, index: [i32; 3]) -> [usize; 3] {
        [0, 1, 2].map(|i| (index[i].max(0) as usize).min(self.resolution[i] - 1))
    }

    /// Between the centres of voxel `base` and of the one after it in each axis; `fraction` in
    /// \[0, 1\].
    #[inline]
    fn interpolate(&self, base: [i32; 3], fraction: Vec3) -> T {
        let [nx, ny, _] = self.resolution;
        let first = self.place(base);
        let [x, y, z] = self.place(base.map(|i| i.saturating_add(1)));
        let at = (first[2] * ny + first[1]) * nx + first[0];
        let (x, y, z) = (x - first[0], (y - first[1]) * nx, (z - first[2]) * nx * ny);
        let lerp = |a: T, b: T, s: f32| a * (1.0 - s) + b * s;
        let along_x = |at: usize| lerp(self.values[at], self.values[at + x], fraction.x);
        let along_y = |at: usize| lerp(along_x(at), along_x(at + y), fraction.y);
        lerp(along_y(at), along_y(at + z), fraction.z)
    }

    /// The lattice in whose cells the value is a single polynomial: the voxels, or for trilinear
    /// interpolation the cells between their centres, with half a cell more on every side.
    fn lattice(&self) -> Lattice {
        let cell = self.bounds.size().as_dvec3() / counts(self.resolution).as_dvec3();
        let origin = self.bounds.min.as_dvec3();
        match self.filter {
            Filter::Nearest => Lattice {
                origin,
                cell,
                count: self.resolution,
            },
            Filter::Trilinear => Lattice {
                origin: origin - 0.5 * cell,
                cell,
                count: self.resolution.map(|n| n + 1),
            },
        }
    }
}

impl DenseGrid {
    /// ∫ value dt along the part of the ray inside the box: exact but for rounding, since the
    /// value along a ray is constant in a voxel (nearest) or a cubic between voxel centres
    /// (trilinear), which two points of Gauss integrate exactly. Summed in `f64`.
    ///
    /// Its cost is the number of voxels met.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Aabb, Ray};
    /// use tyndall_media::DenseGrid;
    /// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(2.0, 1.0, 1.0) };
    /// let grid = DenseGrid::new([2, 1, 1], bounds, vec![1.0, 3.0])?;
    /// let ray = Ray::new(Vec3::new(-1.0, 0.5, 0.5), Vec3::X);
    /// assert!((grid.line_integral(&ray) - 4.0).abs() < 1e-7);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    pub fn line_integral(&self, ray: &Ray) -> f64 {
        let Some(span) = clip(ray, self.bounds) else {
            return 0.0;
        };
        let lattice = self.lattice();
        let along = lattice.coordinates(ray);
        let mut sum = 0.0;
        let _ = lattice.walk(ray, span, |cell, enter, leave| {
            sum += (leave - enter) * self.mean_in_cell(cell, along, [enter, leave]);
            ControlFlow::Continue(())
        });
        sum
    }

    /// The mean of the value over a stretch inside one cell of the lattice, on a ray whose
    /// coordinates in the lattice are `origin + t·slope`.
    #[inline]
    fn mean_in_cell(
        &self,
        cell: [usize; 3],
        [origin, slope]: [DVec3; 2],
        [enter, leave]: [f64; 2],
    ) -> f64 {
        let index = cell.map(|i| i as i32);
        if self.filter == Filter::Nearest {
            return f64::from(self.voxel(index));
        }
        let corner = DVec3::from(cell.map(|i| i as f64));
        let value = |t: f64| {
            let fraction = origin + t * slope - corner;
            let fraction = fraction.clamp(DVec3::ZERO, DVec3::ONE).as_vec3();
            f64::from(self.interpolate(index.map(|i| i - 1), fraction))
        };
        let (middle, half) = (0.5 * (enter + leave), 0.5 * (leave - enter));
        let offset = half * GAUSS;
        0.5 * (value(middle - offset) + value(middle + offset))
    }
}

/// Voxels along an edge of the cells whose bounds are known.
const CELL: usize = 8;

impl<T: Spectrum> Field<T> for DenseGrid<T> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    #[inline]
    fn lookup(&self, p: Vec3, _: &mut Hint) -> T {
        self.lookup(p)
    }

    fn range(&self, region: &Region) -> Range<T> {
        self.footprint(region).collect()
    }

    /// [`DenseGrid::new`] has.
    fn check(&self) -> Result<(), MediumError> {
        Ok(())
    }

    fn cells(&self) -> Cells {
        Cells::of(
            self.bounds,
            counts(self.resolution).as_dvec3() / CELL as f64,
        )
    }
}

/// Whether a box has a volume that numbers can hold.
pub(crate) fn has_volume(bounds: Aabb) -> bool {
    let size = bounds.size();
    size.cmpgt(Vec3::splat(1e-18)).all() && size.cmplt(Vec3::splat(1e18)).all()
}

/// The largest of `values`, which are at least 0, in each channel.
fn largest<T: Spectrum>(values: impl Iterator<Item = T>) -> T {
    values.fold(T::default(), |a, b| a.zip(b, f32::max))
}
