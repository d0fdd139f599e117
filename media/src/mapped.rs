//! A field seen through a function.

use crate::MediumError;
use crate::field::{Cells, Field, Hint, Range, Region};
use glam::Vec3;
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;
use tyndall_core::{Aabb, Spectrum};

/// [`Field::check`] looks at so many arguments, evenly from the least to the greatest.
const CHECKED: usize = 1024;

/// A field of `U` that is a function of a field of `T`: the colour of a temperature.
///
/// No channel of the function may fall where a channel of its argument rises. Then the bounds of
/// the field's values become those of the function's, as tight as they were; a
/// [`BlackBody`](crate::BlackBody) is so. [`Field::check`] tries 1024 arguments and refuses a
/// function that falls, or that is negative or not finite.
#[derive(Clone)]
pub struct Mapped<T, U> {
    field: Arc<dyn Field<T>>,
    function: Arc<dyn Fn(T) -> U + Send + Sync>,
}

impl<T: Spectrum, U: Spectrum> Mapped<T, U> {
    /// `function` of `field`. A medium that is made of it checks both.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Aabb, Coefficients, Medium};
    /// use tyndall_media::{BlackBody, DenseGrid, GridMedium, Mapped, Phase};
    /// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    /// let density = DenseGrid::new([1; 3], bounds, vec![1.0])?;
    /// let temperature = DenseGrid::new([1, 1, 2], bounds, vec![1900.0, 1200.0])?;
    /// let body = BlackBody::relative_to(1900.0)?;
    /// let soot = Coefficients { sigma_a: 2.0_f32, sigma_s: 0.0, emission: 0.0 };
    /// let fire = GridMedium::new(density, soot, Phase::Isotropic)?
    ///     .with_source(Mapped::rising(temperature, move |t| body.luminance(t)))?;
    /// assert!((fire.coefficients(Vec3::ZERO).emission - 2.0).abs() < 1e-5);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    pub fn rising(
        field: impl Field<T> + 'static,
        function: impl Fn(T) -> U + Send + Sync + 'static,
    ) -> Self {
        Self {
            field: Arc::new(field),
            function: Arc::new(function),
        }
    }
}

impl<T: Spectrum, U: Spectrum> Field<U> for Mapped<T, U> {
    fn bounds(&self) -> Aabb {
        self.field.bounds()
    }

    #[inline]
    fn lookup(&self, p: Vec3, hint: &mut Hint) -> U {
        (self.function)(self.field.lookup(p, hint))
    }

    fn range(&self, region: &Region) -> Range<U> {
        let Range { min, max, mean } = self.field.range(region);
        let [min, max, mean] = [min, max, mean].map(|value| (self.function)(value));
        Range { min, max, mean }
    }

    fn check(&self) -> Result<(), MediumError> {
        self.field.check()?;
        let bounds = self.bounds();
        if bounds.is_empty() {
            return Ok(());
        }
        let Range { min, max, .. } = self.field.range(&Region::of(bounds));
        let mut before = U::default();
        for i in 0..=CHECKED {
            let share = i as f32 / CHECKED as f32;
            // So that no channel falls, even by rounding.
            let value =
                (self.function)(min.zip(max, |min, max| (min + (max - min) * share).min(max)));
            for channel in 0..U::CHANNELS {
                let (value, before) = (value.channel(channel), before.channel(channel));
                if !(value.is_finite() && value >= before) {
                    return Err(MediumError::Falling {
                        channel,
                        value,
                        before,
                    });
                }
            }
            before = value;
        }
        Ok(())
    }

    fn cells(&self) -> Cells {
        self.field.cells()
    }
}

impl<T, U> Debug for Mapped<T, U> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mapped")
            .field("field", &self.field)
            .finish_non_exhaustive()
    }
}
