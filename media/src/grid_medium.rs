//! A medium whose density is a grid.

use crate::channels::{channel_pmf, check_coefficients};
use crate::field::{Field, Hint, Range, Region};
use crate::grid::has_volume;
use crate::majorant::{Cell, Majorants};
use crate::{DenseGrid, MediumError, Phase};
use glam::Vec3;
use std::ops::ControlFlow;
use std::sync::Arc;
use tyndall_core::{Aabb, Coefficients, FreeFlight, Majorant, Medium, Ray, Sampler, Spectrum};

/// Emission is uneven if its maximum is so many times its mean.
const UNEVEN: f32 = 2.0;
/// Collisions that are asked for where emission is even.
const GLIMPSES: f64 = 8.0;

/// How [`GridMedium`] finds the transmittance of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tracking {
    /// Ratio tracking (Novák et al. 2014): an unbiased estimate; cost as the optical depth of the
    /// majorant.
    #[default]
    Ratio,
    /// Regular tracking: exact, no random numbers; cost as the number of voxels met.
    Regular,
}

/// A medium that fills a box: a density times constant coefficients, with an optional albedo and
/// emission that vary too. Outside the box of the density there is nothing.
///
/// σt(x) = density(x)·σt; σs(x) = σt(x)·albedo(x); emission(x) = density(x)·emission, or that of
/// its field.
///
/// # Cost
/// Bounds of the density are known in a tree of cells ([`Field::cells`]). What is empty costs
/// nothing but a step past it. A free flight takes as many lookups as the optical depth of the
/// largest density of each cell up to the collision; a transmittance as many as that of the
/// difference between the largest and the smallest. A channel that is clear where another is dense
/// goes on through every collision of the other (1e6 of them where the other has σt = 1e6 over a
/// length of 1).
#[derive(Clone, Debug)]
pub struct GridMedium<S, D = DenseGrid> {
    density: D,
    per_density: Coefficients<S>,
    albedo: Option<Arc<dyn Field<S>>>,
    glow: Option<Glow<S>>,
    phase: Phase,
    /// ∫ density dt, where transmittance is to be found by it.
    regular: Option<fn(&D, &Ray) -> f64>,
    majorants: Majorants,
}

/// What a medium emits, where that has a field of its own.
#[derive(Clone, Debug)]
enum Glow<S> {
    /// Emission, W·sr⁻¹·m⁻² per scene unit.
    Emission(Arc<dyn Field<S>>),
    /// Emission over σa, W·sr⁻¹·m⁻².
    Source(Arc<dyn Field<S>>),
}

impl<S: Spectrum, D: Field<f32>> GridMedium<S, D> {
    /// A medium of coefficients `per_density` (1/scene unit where the density is 1).
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_core::{Aabb, Coefficients, Medium, Ray};
    /// use tyndall_media::{DenseGrid, GridMedium, Phase};
    /// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    /// let density = DenseGrid::new([2, 1, 1], bounds, vec![1.0, 3.0])?;
    /// let smoke = Coefficients { sigma_a: 0.1_f32, sigma_s: 0.9, emission: 0.0 };
    /// let smoke = GridMedium::new(density, smoke, Phase::Isotropic)?;
    /// let here = smoke.coefficients(Vec3::new(1.0, 0.5, 0.5));
    /// assert!((here.sigma_s - 2.7).abs() < 1e-6);
    /// let ray = Ray::new(Vec3::new(-5.0, 0.5, 0.5), Vec3::X);
    /// assert!((smoke.optical_depth(&ray) - 2.0).abs() < 1e-6);
    /// # Ok::<(), tyndall_media::MediumError>(())
    /// ```
    ///
    /// # Errors
    /// [`MediumError::Coefficient`] if a coefficient is negative or not finite, alone or times the
    /// largest density; [`MediumError::Endless`], [`MediumError::GridBounds`] and
    /// [`MediumError::TooDense`]; those of [`Field::check`].
    pub fn new(
        density: D,
        per_density: Coefficients<S>,
        phase: Phase,
    ) -> Result<Self, MediumError> {
        check_coefficients(&per_density)?;
        density.check()?;
        let bounds = density.bounds();
        if !bounds.is_empty() {
            if !(bounds.min.is_finite() && bounds.max.is_finite()) {
                return Err(MediumError::Endless);
            }
            if !has_volume(bounds) {
                return Err(MediumError::GridBounds);
            }
            let most = density.range(&Region::of(bounds)).max;
            let densest = scaled(per_density, most);
            check_coefficients(&densest)?;
        }
        let majorants = majorants(&density, per_density, None);
        let depth = majorants.depth(bounds);
        if depth > MediumError::DENSEST {
            return Err(MediumError::TooDense { depth });
        }
        Ok(Self {
            density,
            per_density,
            albedo: None,
            glow: None,
            phase,
            regular: None,
            majorants,
        })
    }

    /// Takes the albedo σs/σt from a field, which keeps σt and splits it anew; it may have a box of
    /// its own, outside of which it is 0.
    ///
    /// # Errors
    /// [`MediumError::Albedo`] if it may exceed 1; those of [`Field::check`].
    pub fn with_albedo(self, albedo: impl Field<S> + 'static) -> Result<Self, MediumError> {
        albedo.check()?;
        let bounds = albedo.bounds();
        if !bounds.is_empty() {
            let max = albedo.range(&Region::of(bounds)).max;
            for channel in 0..S::CHANNELS {
                let value = max.channel(channel);
                if value.is_nan() || value > 1.0 {
                    return Err(MediumError::Albedo { channel, value });
                }
            }
        }
        let albedo = Some(Arc::new(albedo) as Arc<dyn Field<S>>);
        Ok(Self { albedo, ..self })
    }

    /// Takes the emission, W·sr⁻¹·m⁻² per scene unit, from a field, which may have a box of its
    /// own; outside the density's box nothing glows.
    ///
    /// # Errors
    /// Those of [`Field::check`].
    pub fn with_emission(self, emission: impl Field<S> + 'static) -> Result<Self, MediumError> {
        emission.check()?;
        Ok(self.with_glow(Glow::Emission(Arc::new(emission))))
    }

    /// Takes the source function, W·sr⁻¹·m⁻², from a field, which may have a box of its own:
    /// emission(x) = σa(x)·source(x), as of fire in thermal equilibrium, whose source is that of a
    /// [`BlackBody`](crate::BlackBody) of its temperature. What is opaque looks like its source.
    ///
    /// # Errors
    /// Those of [`Field::check`].
    pub fn with_source(self, source: impl Field<S> + 'static) -> Result<Self, MediumError> {
        source.check()?;
        Ok(self.with_glow(Glow::Source(Arc::new(source))))
    }

    fn with_glow(self, glow: Glow<S>) -> Self {
        Self {
            majorants: majorants(&self.density, self.per_density, Some(&glow)),
            glow: Some(glow),
            ..self
        }
    }

    /// The box outside which there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.density.bounds()
    }

    /// The density.
    pub fn density(&self) -> &D {
        &self.density
    }

    /// Whether it emits.
    pub(crate) fn emits(&self) -> bool {
        self.glow.is_some() || !self.per_density.emission.is_black()
    }

    /// What the mean densities of the majorant cells on the way let through.
    pub(crate) fn mean_transmittance(&self, ray: &Ray) -> S {
        let mut column = 0.0;
        let _ = self.walk(ray, false, |enter, leave, cell| {
            column += (leave - enter) * f64::from(cell.density.mean);
            ControlFlow::Continue(())
        });
        let sigma_t = self.per_density.sigma_t();
        sigma_t.map(|sigma_t| (-sigma_t * column as f32).exp())
    }

    /// Visits the stretches of the ray that are not empty, in order; with `glow` for its emission.
    #[inline]
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        glow: bool,
        visit: impl FnMut(f64, f64, &Cell) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        self.majorants.walk(ray, glow, visit)
    }

    /// σt where the density is 1.
    #[inline]
    pub(crate) fn sigma_t(&self) -> S {
        self.per_density.sigma_t()
    }

    /// The density at a point inside the box.
    #[inline]
    pub(crate) fn density_at(&self, p: Vec3, hint: &mut Hint) -> f32 {
        self.density.lookup(p, hint)
    }

    /// Emission at a point in a majorant cell.
    #[inline]
    pub(crate) fn emission(&self, p: Vec3, density: f32) -> S {
        match &self.glow {
            None => self.per_density.emission * density,
            // Cells may reach out of the box.
            Some(Glow::Emission(field)) if self.bounds().contains(p) => inside(field, p),
            Some(Glow::Emission(_)) => S::default(),
            Some(Glow::Source(_)) => self.coefficients_at(p, density).emission,
        }
    }

    /// The coefficients at a point of the box where the density is this.
    pub(crate) fn coefficients_at(&self, p: Vec3, density: f32) -> Coefficients<S> {
        let mut here = scaled(self.per_density, density);
        if let Some(field) = &self.albedo {
            let albedo = inside(field, p).map(|a| a.min(1.0));
            let sigma_t = here.sigma_t();
            here.sigma_s = sigma_t * albedo;
            here.sigma_a = sigma_t - here.sigma_s;
        }
        match &self.glow {
            None => {}
            Some(Glow::Emission(field)) => here.emission = inside(field, p),
            Some(Glow::Source(field)) => {
                here.emission = here.sigma_a * inside(field, p);
            }
        }
        here
    }
}

impl<S: Spectrum> GridMedium<S> {
    /// Chooses how transmittance is found.
    #[must_use]
    pub fn with_tracking(self, tracking: Tracking) -> Self {
        let regular: Option<fn(&DenseGrid, &Ray) -> f64> = match tracking {
            Tracking::Ratio => None,
            Tracking::Regular => Some(DenseGrid::line_integral),
        };
        Self { regular, ..self }
    }

    /// ∫σt dt along the ray, exact but for rounding: see [`DenseGrid::line_integral`].
    pub fn optical_depth(&self, ray: &Ray) -> S {
        times(self.sigma_t(), self.density.line_integral(ray))
    }
}

/// What a field holds at a point; zero outside of its box.
fn inside<S: Spectrum>(field: &Arc<dyn Field<S>>, p: Vec3) -> S {
    if field.bounds().contains(p) {
        field.lookup(p, &mut Hint::default())
    } else {
        S::default()
    }
}

/// An optical depth.
fn times<S: Spectrum>(sigma_t: S, column: f64) -> S {
    sigma_t.map(|sigma_t| (f64::from(sigma_t) * column) as f32)
}

/// Bounds of the density. Where the medium emits, some collisions are asked for, because emission is
/// counted at tentative ones: about [`GLIMPSES`] across a region, and one across a cell.
fn majorants<S: Spectrum>(
    density: &impl Field<f32>,
    per_density: Coefficients<S>,
    glow: Option<&Glow<S>>,
) -> Majorants {
    let sigma_t = per_density.sigma_t();
    let cells = match glow {
        None => density.cells(),
        Some(Glow::Emission(field) | Glow::Source(field)) => {
            density.cells().refined_to(&field.cells())
        }
    };
    Majorants::new(cells, sigma_t.max_channel(), |region, is_cell| {
        let density = density.range(region);
        let uneven_density = density.max > UNEVEN * density.mean;
        let uneven_field =
            |range: Range<S>| range.max.max_channel() > UNEVEN * range.mean.max_channel();
        let (emitted, uneven) = match glow {
            None => (per_density.emission * density.max, uneven_density),
            Some(Glow::Emission(field)) => {
                let range = field.range(region);
                (range.max, uneven_field(range))
            }
            // An albedo may turn all of σt into σa.
            Some(Glow::Source(field)) => {
                let range = field.range(region);
                let uneven = uneven_density || uneven_field(range);
                (sigma_t * density.max * range.max, uneven)
            }
        };
        let emits = !emitted.is_black();
        let glimpses = match (emits, is_cell) {
            (false, _) => 0.0,
            (true, true) => 1.0,
            (true, false) => GLIMPSES,
        };
        let cell = Cell {
            density,
            rate: (glimpses / region.diagonal()) as f32,
            uneven: emits && uneven,
        };
        (density.max > 0.0 || emits).then_some(cell)
    })
}

#[inline]
fn scaled<S: Spectrum>(coefficients: Coefficients<S>, density: f32) -> Coefficients<S> {
    Coefficients {
        sigma_a: coefficients.sigma_a * density,
        sigma_s: coefficients.sigma_s * density,
        emission: coefficients.emission * density,
    }
}

impl<S: Spectrum, D: Field<f32>> Medium for GridMedium<S, D> {
    type Spectrum = S;
    type Phase<'a>
        = &'a Phase
    where
        D: 'a;

    fn coefficients(&self, p: Vec3) -> Coefficients<S> {
        if !self.bounds().contains(p) {
            return Coefficients::default();
        }
        let density = self.density_at(p, &mut Hint::default());
        self.coefficients_at(p, density)
    }

    #[inline]
    fn phase(&self, _: Vec3) -> &Phase {
        &self.phase
    }

    fn transmittance(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        match self.regular {
            None => self.ratio_track(ray, sampler),
            Some(column) => {
                times(self.sigma_t(), column(&self.density, ray)).map(|tau| (-tau).exp())
            }
        }
    }

    fn emitted(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        if !self.emits() {
            return S::default();
        }
        self.emission_track(ray, sampler)
    }

    fn sample_free_flight(
        &self,
        ray: &Ray,
        importance: S,
        sampler: &mut impl Sampler,
    ) -> FreeFlight<S> {
        self.delta_track(ray, importance, sampler)
    }

    /// Σ pmf·σt·Tr over the channels, with the true σt at `t`, and the transmittance of the mean
    /// densities of the majorant cells on the way: near the true density where the smoke is smooth
    /// at their scale, and exact where it is constant.
    fn pdf_free_flight(&self, ray: &Ray, t: f32, importance: S) -> f32 {
        let p = ray.at(t);
        if !(0.0..ray.t_max).contains(&t) || !self.bounds().contains(p) {
            return 0.0;
        }
        let transmittance = self.mean_transmittance(&ray.up_to(t));
        let sigma_t = self.sigma_t() * self.density_at(p, &mut Hint::default());
        (channel_pmf(importance) * sigma_t * transmittance).sum()
    }

    fn pmf_passing(&self, ray: &Ray, importance: S) -> f32 {
        (channel_pmf(importance) * self.mean_transmittance(ray)).sum()
    }

    fn majorants(&self, ray: &Ray, mut visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        let sigma_t = self.sigma_t().max_channel();
        let _ = self.walk(ray, false, |enter, leave, cell| {
            visit(Majorant {
                t_min: enter as f32,
                t_max: leave as f32,
                sigma_bar: sigma_t * cell.density.max,
            })
        });
    }

    #[inline]
    fn homogeneous(&self) -> Option<Coefficients<S>> {
        None
    }
}
