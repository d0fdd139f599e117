//! Light arriving at a point.

use super::probe::{first_solid, points};
use super::{FALSE_ALARM, RELATIVE, ensure, is_unit, same, same_emission, same_spectrum, valid};
use crate::stats::{Moments, check_mean, chi2_sphere, integral_near, sidak};
use crate::{TestSampler, rng};
use glam::Vec3;
use tyndall_core::{
    Anchor, DirectSample, Geometry, LightDirect, LightPdf, Media, MediumId, Sampler, Sensor,
    Shading, Spectrum,
};

/// Points examined.
const POINTS: usize = 16;
/// Of which so many get the statistical tests.
const STATISTICAL: usize = 4;
/// Samples for the pointwise checks.
const POINTWISE: usize = 2_000;
/// Samples for each statistical test.
const SAMPLES: usize = 200_000;
/// Fewer visible samples than this, of the pointwise ones, promise no statistics.
const FEWEST: usize = 50;

/// Direct light is what a ray would find, with the density that is stated.
///
/// At points along the rays of the sensor and of random walks from it:
/// - a sample's connection runs along `wi`; its weight is finite;
/// - where `pdf_w` is positive, `pdf_direct_w` and `pdf_emission` of its target agree, and
///   weight × `pdf_w` is the radiance emitted there;
/// - visible samples follow the density that `pdf_direct_w` has for what a ray in their direction
///   finds ([`chi2_sphere`]), and their mean weight is the fluence that rays in all directions find.
///   Lights that subtend less than 0.02 rad are too small for this test, which then fails.
///
/// # Errors
/// A sentence with the first offence.
pub fn direct<H>(host: &H) -> Result<(), String>
where
    H: Geometry + Shading + Media + LightDirect + LightPdf + Sensor,
{
    for (i, (position, medium)) in points(host, POINTS)?.into_iter().enumerate() {
        let point = Point {
            host,
            position,
            medium,
        };
        let mut sampler = rng(i as u64);
        let mut visible = 0;
        for _ in 0..POINTWISE {
            if let Some(sample) = host.sample_direct(position, sampler.next()) {
                point.check_sample(&sample)?;
                visible += usize::from(sample.pdf_w > 0.0 && point.sees(&sample));
            }
        }
        if i < STATISTICAL && visible >= FEWEST {
            point.check_density(&mut sampler)?;
            point.check_fluence(&mut sampler)?;
        }
    }
    Ok(())
}

struct Point<'a, H> {
    host: &'a H,
    position: Vec3,
    medium: MediumId,
}

impl<H> Point<'_, H>
where
    H: Geometry + Shading + Media + LightDirect + LightPdf,
{
    fn anchor(&self) -> Anchor<H::Hit> {
        Anchor::Point(self.position)
    }

    fn sees(&self, sample: &DirectSample<H::Spectrum, H::Hit>) -> bool {
        let ray = self.host.connect(&self.anchor(), &sample.target);
        first_solid(self.host, ray, self.medium).is_none()
    }

    /// What a ray in direction `w` finds: a surface or the background.
    fn trace(&self, w: Vec3) -> Anchor<H::Hit> {
        let ray = self.host.spawn(&self.anchor(), w);
        match first_solid(self.host, ray, self.medium) {
            Some(hit) => Anchor::Surface(hit),
            None => Anchor::Direction(w),
        }
    }

    /// Radiance arriving from direction `w`, leaving `target`.
    fn radiance(&self, target: &Anchor<H::Hit>, w: Vec3) -> H::Spectrum {
        match target {
            Anchor::Surface(hit) => self.host.emitted(hit, -w),
            Anchor::Direction(_) => self.host.background(w),
            Anchor::Point(_) => H::Spectrum::default(),
        }
    }

    fn check_sample(&self, sample: &DirectSample<H::Spectrum, H::Hit>) -> Result<(), String> {
        let DirectSample {
            target,
            wi,
            weight,
            pdf_w,
            emission,
            cos_theta,
            ..
        } = sample;
        let at = || {
            format!(
                "from {} along {wi}, weight {weight:?}, pdf_w {pdf_w}",
                self.position
            )
        };
        let sound = is_unit(*wi)
            && valid(*weight)
            && [*pdf_w, emission.pdf_a, emission.pdf_w]
                .into_iter()
                .all(valid)
            && (0.0..=1.001).contains(cos_theta);
        ensure(sound, || {
            format!("{}, {emission:?}, cos θ {cos_theta}: unsound", at())
        })?;
        let ray = self.host.connect(&self.anchor(), target);
        ensure(ray.direction.dot(*wi) > 1.0 - 1e-4, || {
            format!("{}: the connection runs along {}", at(), ray.direction)
        })?;
        if *pdf_w == 0.0 {
            return Ok(());
        }
        let stated = self.host.pdf_direct_w(self.position, target);
        ensure(same(*pdf_w, stated, RELATIVE), || {
            format!("{}: pdf_direct_w is {stated}", at())
        })?;
        let leaving = self.host.pdf_emission(target, -*wi);
        ensure(same_emission(*emission, leaving, RELATIVE), || {
            format!("{}: {emission:?}, but pdf_emission is {leaving:?}", at())
        })?;
        let radiance = self.radiance(target, *wi);
        ensure(same_spectrum(*weight * *pdf_w, radiance, RELATIVE), || {
            format!("{}: weight × pdf_w is not the radiance {radiance:?}", at())
        })
    }

    fn check_density(&self, sampler: &mut TestSampler) -> Result<(), String> {
        chi2_sphere(
            |_| {
                let sample = self.host.sample_direct(self.position, sampler.next())?;
                (sample.pdf_w > 0.0 && self.sees(&sample)).then_some(sample.wi)
            },
            |w| self.host.pdf_direct_w(self.position, &self.trace(w)),
            SAMPLES,
            sidak(FALSE_ALARM, 2 * STATISTICAL),
        )
        .map_err(|why| {
            format!(
                "from {}: direct light does not follow the density of what its rays find: {why}",
                self.position
            )
        })
    }

    fn check_fluence(&self, sampler: &mut TestSampler) -> Result<(), String> {
        let mean = |s: H::Spectrum| f64::from(s.mean());
        let sampled: Moments = (0..SAMPLES)
            .map(|_| self.host.sample_direct(self.position, sampler.next()))
            .map(|sample| match sample {
                Some(s) if s.pdf_w > 0.0 && self.sees(&s) => mean(s.weight),
                _ => 0.0,
            })
            .collect();
        let sampled = sampled.estimate();
        let traced = |w| mean(self.radiance(&self.trace(w), w)) / sampled.mean;
        let ratio = integral_near(|w| traced(w) as f32, 1.0)?;
        let name = format!("from {}: fluence of direct light", self.position);
        let each = sidak(FALSE_ALARM, 2 * STATISTICAL);
        check_mean(&name, sampled, ratio * sampled.mean, each)
            .map_err(|why| format!("{why}; expected is what rays find"))
    }
}
