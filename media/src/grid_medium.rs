//! A medium whose density is a grid.

use crate::channels::{channel_pmf, check_coefficients};
use crate::grid::largest;
use crate::majorant::{Cell, MajorantGrid};
use crate::{DenseGrid, MediumError, Phase};
use glam::Vec3;
use std::ops::ControlFlow;
use tyndall_core::{Aabb, Coefficients, FreeFlight, Majorant, Medium, Ray, Sampler, Spectrum};

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

/// A medium that fills a box: a density grid times constant coefficients, with an optional grid of
/// albedo and one of emission. Outside the box there is nothing.
///
/// σt(x) = density(x)·σt; σs(x) = σt(x)·albedo(x); emission(x) = density(x)·emission, or that of
/// its grid.
///
/// # Cost
/// A free flight takes as many lookups as the majorant's optical depth up to the collision, so a
/// thin region in the same majorant cell (at least 8 voxels wide) as a dense one is slow, though right. So is
/// a channel that is clear where another is dense: it goes on through every collision of the other
/// (1e6 of them where the other has σt = 1e6 over a length of 1).
#[derive(Clone, Debug)]
pub struct GridMedium<S> {
    density: DenseGrid,
    per_density: Coefficients<S>,
    albedo: Option<DenseGrid<S>>,
    emission: Option<DenseGrid<S>>,
    phase: Phase,
    tracking: Tracking,
    majorants: MajorantGrid,
}

impl<S: Spectrum> GridMedium<S> {
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
    /// largest density; [`MediumError::TooDense`].
    pub fn new(
        density: DenseGrid,
        per_density: Coefficients<S>,
        phase: Phase,
    ) -> Result<Self, MediumError> {
        check_coefficients(&per_density)?;
        let densest = scaled(per_density, density.max());
        check_coefficients(&densest)?;
        let sigma_t = densest.sigma_t().max_channel();
        let diagonal = density.bounds().size().length();
        if sigma_t * diagonal > MediumError::DENSEST {
            return Err(MediumError::TooDense { sigma_t, diagonal });
        }
        let majorants = majorants(&density, per_density, None);
        Ok(Self {
            density,
            per_density,
            albedo: None,
            emission: None,
            phase,
            tracking: Tracking::default(),
            majorants,
        })
    }

    /// Takes the albedo σs/σt from a grid, which keeps σt and splits it anew. The grid may have a
    /// box and a resolution of its own.
    ///
    /// # Errors
    /// [`MediumError::Albedo`] if a voxel is above 1.
    pub fn with_albedo(self, albedo: DenseGrid<S>) -> Result<Self, MediumError> {
        if let Some((voxel, channel, value)) = albedo.find(|a| a > 1.0) {
            return Err(MediumError::Albedo {
                voxel,
                channel,
                value,
            });
        }
        let albedo = Some(albedo);
        Ok(Self { albedo, ..self })
    }

    /// Takes the emission, W·sr⁻¹·m⁻² per scene unit, from a grid, which may have a box and a
    /// resolution of its own; outside the density's box nothing glows.
    #[must_use]
    pub fn with_emission(self, emission: DenseGrid<S>) -> Self {
        Self {
            majorants: majorants(&self.density, self.per_density, Some(&emission)),
            emission: Some(emission),
            ..self
        }
    }

    /// Chooses how transmittance is found.
    #[must_use]
    pub fn with_tracking(self, tracking: Tracking) -> Self {
        Self { tracking, ..self }
    }

    /// The box outside which there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.density.bounds()
    }

    /// ∫σt dt along the ray, exact but for rounding: see [`DenseGrid::line_integral`].
    pub fn optical_depth(&self, ray: &Ray) -> S {
        let integral = self.density.line_integral(ray);
        let sigma_t = self.per_density.sigma_t();
        sigma_t.map(|sigma_t| (f64::from(sigma_t) * integral) as f32)
    }

    /// What the mean densities of the majorant cells on the way let through.
    fn mean_transmittance(&self, ray: &Ray) -> S {
        let mut column = 0.0;
        let _ = self.majorants.walk(ray, |enter, leave, cell| {
            column += (leave - enter) * f64::from(cell.density);
            ControlFlow::Continue(())
        });
        let sigma_t = self.per_density.sigma_t();
        sigma_t.map(|sigma_t| (-sigma_t * column as f32).exp())
    }

    /// σt at a point inside the box.
    #[inline]
    pub(crate) fn extinction(&self, p: Vec3) -> S {
        self.per_density.sigma_t() * self.density.lookup(p)
    }

    /// Emission at a point inside the box.
    #[inline]
    pub(crate) fn emission(&self, p: Vec3) -> S {
        match &self.emission {
            Some(grid) => grid.lookup(p),
            None => self.per_density.emission * self.density.lookup(p),
        }
    }

    #[inline]
    pub(crate) fn majorant_grid(&self) -> &MajorantGrid {
        &self.majorants
    }
}

/// Bounds of σt, all channels. Where the medium emits they are at least one over the diagonal of
/// the majorant cell, because emission is counted at tentative collisions: about one a cell keeps
/// the variance of a thin flame low.
fn majorants<S: Spectrum>(
    density: &DenseGrid,
    per_density: Coefficients<S>,
    emission: Option<&DenseGrid<S>>,
) -> MajorantGrid {
    let sigma_t = per_density.sigma_t().max_channel();
    MajorantGrid::new(density.bounds(), density.resolution(), |region| {
        let densest = largest(density.footprint(region));
        let emitted = match emission {
            Some(grid) => largest(grid.footprint(region)),
            None => per_density.emission * densest,
        };
        let visible = if emitted.is_black() {
            0.0
        } else {
            region.size().length().recip()
        };
        Cell {
            sigma_bar: (sigma_t * densest).max(visible),
            density: mean(density.footprint(region)),
        }
    })
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), v| (sum + f64::from(v), n + 1.0));
    (sum / count) as f32
}

#[inline]
fn scaled<S: Spectrum>(coefficients: Coefficients<S>, density: f32) -> Coefficients<S> {
    Coefficients {
        sigma_a: coefficients.sigma_a * density,
        sigma_s: coefficients.sigma_s * density,
        emission: coefficients.emission * density,
    }
}

impl<S: Spectrum> Medium for GridMedium<S> {
    type Spectrum = S;
    type Phase<'a> = &'a Phase;

    fn coefficients(&self, p: Vec3) -> Coefficients<S> {
        if !self.bounds().contains(p) {
            return Coefficients::default();
        }
        let mut here = scaled(self.per_density, self.density.lookup(p));
        if let Some(grid) = &self.albedo {
            let albedo = grid.lookup(p).map(|a| a.min(1.0));
            let sigma_t = here.sigma_t();
            here.sigma_s = sigma_t * albedo;
            here.sigma_a = sigma_t - here.sigma_s;
        }
        if let Some(grid) = &self.emission {
            here.emission = grid.lookup(p);
        }
        here
    }

    #[inline]
    fn phase(&self, _: Vec3) -> &Phase {
        &self.phase
    }

    fn transmittance(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        match self.tracking {
            Tracking::Ratio => self.ratio_track(ray, sampler, |_, _, _| {}),
            Tracking::Regular => self.optical_depth(ray).map(|tau| (-tau).exp()),
        }
    }

    fn emitted(&self, ray: &Ray, sampler: &mut impl Sampler) -> S {
        if self.emission.is_none() && self.per_density.emission.is_black() {
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
        (channel_pmf(importance) * self.extinction(p) * transmittance).sum()
    }

    fn pmf_passing(&self, ray: &Ray, importance: S) -> f32 {
        (channel_pmf(importance) * self.mean_transmittance(ray)).sum()
    }

    fn majorants(&self, ray: &Ray, mut visit: impl FnMut(Majorant) -> ControlFlow<()>) {
        let _ = self.majorants.walk(ray, |enter, leave, cell| {
            visit(Majorant {
                t_min: enter as f32,
                t_max: leave as f32,
                sigma_bar: cell.sigma_bar,
            })
        });
    }

    #[inline]
    fn homogeneous(&self) -> Option<Coefficients<S>> {
        None
    }
}
