//! Fields that a host computes.

use crate::MediumError;
use crate::field::{Cells, Field, Hint, Range, Region};
use crate::grid::has_volume;
use glam::{DVec3, Vec3};
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tyndall_core::{Aabb, Spectrum};

/// The nodes of the Gauss–Legendre rule of two points on \[0, 1\]: exact for cubics.
const GAUSS: [f32; 2] = [0.211_324_87, 0.788_675_1];
/// [`Field::check`] looks at this many points at least, and at `IN_CELL` in every cell.
const CHECKED: usize = 4096;
const IN_CELL: usize = 8;

/// A value at a point.
type Value<T> = dyn Fn(Vec3) -> T + Send + Sync;
/// The least and the greatest value in a box.
type Bounds<T> = dyn Fn(Aabb) -> [T; 2] + Send + Sync;

/// A function in a box: a renderer's own noise as density, albedo or emission.
///
/// Tracking needs to know how large it can get: one bound for the box is enough, and bounds of
/// any part of it ([`Procedural::with_local_bounds`]) save what lookups a loose one wastes.
///
/// # Where it leaves its bounds
/// A value above the bound of the box is taken to be the bound, a negative one or NaN to be 0: the
/// image is then finite but not that of the function. Two things tell. A medium that is made of
/// the function calls [`Field::check`], which looks at 8 points of every cell and at 4096 in all,
/// and is refused with the point and the value if one is out of bounds. Lookups out of the bounds
/// of the box are counted while rendering: see [`Procedural::overruns`]. A value between a bound
/// of a part that is too low and that of the box is not counted.
#[derive(Clone)]
pub struct Procedural<T = f32> {
    bounds: Aabb,
    majorant: T,
    value: Arc<Value<T>>,
    local: Option<Arc<Bounds<T>>>,
    resolution: [usize; 3],
    overruns: Arc<AtomicU64>,
}

impl<T: Spectrum> Procedural<T> {
    /// `value` at every point of `bounds`, from 0 to `majorant`.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Aabb, Coefficients, Medium};
    /// use tyndall_media::{GridMedium, Phase, Procedural};
    /// let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
    /// let ball = Procedural::new(bounds, 1.0, |p| (1.0 - p.length()).max(0.0))?;
    /// let smoke = Coefficients { sigma_a: 0.0_f32, sigma_s: 3.0, emission: 0.0 };
    /// let smoke = GridMedium::new(ball, smoke, Phase::Isotropic)?;
    /// assert_eq!(smoke.coefficients(Vec3::new(0.5, 0.0, 0.0)).sigma_s, 1.5);
    /// assert_eq!(smoke.density().overruns(), 0);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    ///
    /// # Errors
    /// [`MediumError::GridBounds`] if the box has no volume; [`MediumError::Majorant`] if the bound
    /// is negative or not finite.
    pub fn new(
        bounds: Aabb,
        majorant: T,
        value: impl Fn(Vec3) -> T + Send + Sync + 'static,
    ) -> Result<Self, MediumError> {
        if !has_volume(bounds) {
            return Err(MediumError::GridBounds);
        }
        for channel in 0..T::CHANNELS {
            let value = majorant.channel(channel);
            if !(value.is_finite() && value >= 0.0) {
                return Err(MediumError::Majorant { channel, value });
            }
        }
        Ok(Self {
            bounds,
            majorant,
            value: Arc::new(value),
            local: None,
            resolution: [1; 3],
            overruns: Arc::default(),
        })
    }

    /// Bounds of parts of the box: `bounds` returns the least and the greatest value in any box
    /// inside of it, and is asked for those of `resolution` equal cells and of cubes of many cells.
    /// They may be loose, to \[0, `majorant`\].
    ///
    /// # Errors
    /// [`MediumError::Cells`] if there are no cells, or more than [`MediumError::MOST_CELLS`].
    pub fn with_local_bounds(
        self,
        resolution: [usize; 3],
        bounds: impl Fn(Aabb) -> [T; 2] + Send + Sync + 'static,
    ) -> Result<Self, MediumError> {
        let cells = (resolution.iter()).try_fold(1_usize, |n, &m| n.checked_mul(m));
        if !cells.is_some_and(|n| (1..=MediumError::MOST_CELLS).contains(&n)) {
            return Err(MediumError::Cells { resolution });
        }
        Ok(Self {
            local: Some(Arc::new(bounds)),
            resolution,
            ..self
        })
    }

    /// How many lookups of this field and its clones were above the bound of the box, negative or
    /// NaN; whoever renders should say so if it is not 0.
    pub fn overruns(&self) -> u64 {
        self.overruns.load(Ordering::Relaxed)
    }

    /// What the host says of a part of the box.
    fn stated(&self, part: Aabb) -> [T; 2] {
        match &self.local {
            Some(local) => local(part),
            None => [T::default(), self.majorant],
        }
    }

    #[cold]
    fn overrun(&self, value: T) -> T {
        self.overruns.fetch_add(1, Ordering::Relaxed);
        value.zip(self.majorant, |v, most| v.max(0.0).min(most))
    }

    fn check_point(&self, p: Vec3, [least, most]: [T; 2]) -> Result<(), MediumError> {
        let here = (self.value)(p);
        for channel in 0..T::CHANNELS {
            let value = here.channel(channel);
            let [low, high] = [least, most].map(|bound| bound.channel(channel));
            let limit = self.majorant.channel(channel);
            // A bound that is not a number holds nothing.
            let stated = low <= value && value <= high;
            if !(stated && 0.0 <= value && value <= limit) {
                return Err(MediumError::Overrun {
                    channel,
                    value,
                    at: p,
                    least: low.max(0.0),
                    most: high.min(limit),
                });
            }
        }
        Ok(())
    }

    /// The cell at an index.
    fn cell(&self, index: usize) -> Aabb {
        let [nx, ny, nz] = self.resolution;
        let count = Vec3::from([nx, ny, nz].map(|n| n as f32));
        let at = Vec3::from([index % nx, index / nx % ny, index / nx / ny].map(|i| i as f32));
        let corner = |at: Vec3| self.bounds.min + self.bounds.size() * (at / count);
        Aabb {
            min: corner(at),
            max: corner(at + 1.0),
        }
    }
}

impl<T: Spectrum> Field<T> for Procedural<T> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    #[inline]
    fn lookup(&self, p: Vec3, _: &mut Hint) -> T {
        let value = (self.value)(p);
        let fits = |c| (0.0..=self.majorant.channel(c)).contains(&value.channel(c));
        if (0..T::CHANNELS).all(fits) {
            value
        } else {
            self.overrun(value)
        }
    }

    /// As stated, inside \[0, majorant\]; the mean is that of 8 points.
    fn range(&self, region: &Region) -> Range<T> {
        let around = region.bounds();
        let part = Aabb {
            min: around.min.max(self.bounds.min),
            max: around.max.min(self.bounds.max),
        };
        if part.is_empty() {
            return Range::of(T::default());
        }
        let [least, most] = self.stated(part);
        // What is not a number is no bound.
        let max = most.zip(self.majorant, f32::min).map(|x| x.max(0.0));
        let min = least.map(|x| x.max(0.0)).zip(max, f32::min);
        let points = (0..8).map(|i| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|i| GAUSS[i])));
        let sum: T = points
            .map(|u| self.lookup(part.min + part.size() * u, &mut Hint::default()))
            .sum();
        let mean = (sum / 8.0).zip(min, f32::max).zip(max, f32::min);
        Range { min, max, mean }
    }

    fn check(&self) -> Result<(), MediumError> {
        let cells = self.resolution.iter().product();
        let in_cell = IN_CELL.max(CHECKED / cells);
        for index in 0..cells {
            let cell = self.cell(index);
            let stated = self.stated(cell);
            for i in 0..in_cell {
                let u = spread(index * in_cell + i);
                self.check_point(cell.min + cell.size() * u, stated)?;
            }
        }
        Ok(())
    }

    fn cells(&self) -> Cells {
        Cells::of(self.bounds, DVec3::from(self.resolution.map(|n| n as f64)))
    }
}

impl<T: Spectrum> Debug for Procedural<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Procedural")
            .field("bounds", &self.bounds)
            .field("majorant", &self.majorant)
            .field("resolution", &self.resolution)
            .field("overruns", &self.overruns())
            .finish_non_exhaustive()
    }
}

/// Point `i` of a sequence that fills the unit cube evenly: the additive recurrence of the root of
/// x⁴ = x + 1, 1.2207… (Roberts 2018).
fn spread(i: usize) -> Vec3 {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let at = |power: i32| (0.5 + (i + 1) as f64 * ROOT.powi(-power)).fract();
    DVec3::new(at(1), at(2), at(3)).as_vec3()
}
