//! Scattering at surfaces.

use super::probe::{Probe, probes};
use super::{FALSE_ALARM, RELATIVE, ensure, is_unit, same, same_spectrum, valid};
use crate::rng;
use crate::stats::{Moments, chi2_sphere, p_value, sidak};
use glam::Vec3;
use tyndall_core::{
    BsdfSample, Geometry, Media, PathFrom, Sampler, Sensor, ShadingPdf, Spectrum, Surface,
    SurfaceKind, warp,
};

/// Hits examined.
const HITS: usize = 64;
/// Of which finite ones get a χ² test.
const CHI2_HITS: usize = 8;
/// Samples for each statistical test.
const SAMPLES: usize = 20_000;
/// Samples for each pointwise check.
const POINTWISE: usize = 200;

/// Scattering functions, their samples and their densities agree.
///
/// On hits of random walks from the sensor that are not null, for both [`PathFrom`]:
/// - a sample is a unit vector whose weight is f·|cos θ| / `pdf_w`, and whose `pdf_w` is
///   `bsdf_pdf_w`; a discrete one has `pdf_w` 0, and its weight from the sensor times η² is that
///   from the light;
/// - samples follow `bsdf_pdf_w` ([`chi2_sphere`]);
/// - f(wo, wi) from the sensor is f(wi, wo) from the light, each times the ratio of the shading
///   cosine to the geometric one (Veach 1997, §5.3);
/// - from the light no more energy leaves than arrives: the mean weight is at most 1.
///
/// # Errors
/// A sentence with the first offence.
pub fn shading<H: Geometry + ShadingPdf + Media + Sensor>(host: &H) -> Result<(), String> {
    let mut finite = 0;
    for (i, probe) in probes(host, HITS)?.iter().enumerate() {
        let bounce = Bounce::new(host, probe);
        let kind = host.surface_kind(&probe.hit);
        if kind == SurfaceKind::Null {
            continue;
        }
        let mut sampler = rng(i as u64);
        bounce.check_energy(&mut sampler)?;
        for _ in 0..POINTWISE {
            bounce.check_samples(kind, sampler.next())?;
            bounce.check_reciprocity(warp::uniform_sphere(sampler.next()))?;
        }
        if kind == SurfaceKind::Finite && finite < CHI2_HITS {
            finite += 1;
            bounce.check_density(&mut sampler)?;
        }
    }
    Ok(())
}

struct Bounce<'a, H: Geometry> {
    host: &'a H,
    hit: &'a H::Hit,
    surface: Surface,
    wo: Vec3,
}

impl<'a, H: Geometry + ShadingPdf> Bounce<'a, H> {
    fn new(host: &'a H, probe: &'a Probe<H::Hit>) -> Self {
        Self {
            host,
            hit: &probe.hit,
            surface: host.surface(&probe.hit),
            wo: -probe.ray.direction,
        }
    }

    fn sample(&self, u: [f32; 3], from: PathFrom) -> Option<BsdfSample<H::Spectrum>> {
        self.host.bsdf_sample(self.hit, self.wo, u, from)
    }

    fn at(&self) -> String {
        format!("at {:?} with wo {}", self.surface, self.wo)
    }

    fn check_samples(&self, kind: SurfaceKind, u: [f32; 3]) -> Result<(), String> {
        let [sight, light] =
            [PathFrom::Sensor, PathFrom::Light].map(|from| (from, self.sample(u, from)));
        for (from, sample) in [&sight, &light] {
            if let Some(sample) = sample {
                self.check_sample(kind, sample, *from)?;
            }
        }
        match (sight.1, light.1) {
            (Some(a), Some(b)) if a.delta && b.delta && a.wi.distance(b.wi) < 1e-4 => {
                let scaled = a.weight * (a.eta * a.eta);
                ensure(same_spectrum(scaled, b.weight, RELATIVE), || {
                    format!(
                        "{}: weight {:?} from the sensor times the square of eta {} is not {:?}, \
                         that from the light: radiance scales with the squared index",
                        self.at(),
                        a.weight,
                        a.eta,
                        b.weight
                    )
                })
            }
            _ => Ok(()),
        }
    }

    fn check_sample(
        &self,
        kind: SurfaceKind,
        sample: &BsdfSample<H::Spectrum>,
        from: PathFrom,
    ) -> Result<(), String> {
        let sound = is_unit(sample.wi) && valid(sample.weight) && sample.eta > 0.0;
        ensure(sound, || format!("{}: unsound {sample:?}", self.at()))?;
        if sample.delta {
            return ensure(sample.pdf_w == 0.0, || {
                format!(
                    "{}: a discrete sample has no density: {sample:?}",
                    self.at()
                )
            });
        }
        ensure(kind == SurfaceKind::Finite, || {
            format!("{}: a {kind:?} surface gave {sample:?}", self.at())
        })?;
        let pdf_w = self.host.bsdf_pdf_w(self.hit, self.wo, sample.wi, from);
        ensure(
            sample.pdf_w > 0.0 && same(sample.pdf_w, pdf_w, RELATIVE),
            || {
                format!(
                    "{}: {sample:?}, but bsdf_pdf_w is {pdf_w} ({from:?})",
                    self.at()
                )
            },
        )?;
        let cosine = self.surface.shading_normal.dot(sample.wi).abs();
        let value = self.host.bsdf_eval(self.hit, self.wo, sample.wi, from) * cosine;
        ensure(
            same_spectrum(sample.weight * sample.pdf_w, value, RELATIVE),
            || {
                format!(
                    "{}: {sample:?}, but f·cos is {value:?} ({from:?})",
                    self.at()
                )
            },
        )
    }

    fn check_reciprocity(&self, wi: Vec3) -> Result<(), String> {
        let Surface {
            geometric_normal,
            shading_normal,
            ..
        } = self.surface;
        // Light leaving along w, per geometric cosine.
        let correction = |w: Vec3| shading_normal.dot(w).abs() / geometric_normal.dot(w).abs();
        let sight = self.host.bsdf_eval(self.hit, self.wo, wi, PathFrom::Sensor) * correction(wi);
        let light =
            self.host.bsdf_eval(self.hit, wi, self.wo, PathFrom::Light) * correction(self.wo);
        ensure(
            same_spectrum(sight, light, RELATIVE) && valid(sight),
            || {
                format!(
                    "{}, wi {wi}: f from the sensor is {sight:?}, from the light, with wo and wi \
                 exchanged, {light:?}: not reciprocal",
                    self.at()
                )
            },
        )
    }

    fn check_energy(&self, sampler: &mut impl Sampler) -> Result<(), String> {
        let weights: Moments = (0..SAMPLES)
            .map(|_| self.sample(sampler.next(), PathFrom::Light))
            .map(|sample| sample.map_or(0.0, |s| f64::from(s.weight.max_channel())))
            .collect();
        let mean = weights.estimate();
        let excess = mean.mean - 1.0 - f64::from(RELATIVE);
        if excess <= 0.0 {
            return Ok(());
        }
        let p = 0.5 * p_value(excess / mean.standard_error, mean.count as f64 - 1.0);
        ensure(p > sidak(FALSE_ALARM, 2 * HITS), || {
            format!("{}: more light leaves than arrives: {mean:?}", self.at())
        })
    }

    fn check_density(&self, sampler: &mut impl Sampler) -> Result<(), String> {
        for from in [PathFrom::Sensor, PathFrom::Light] {
            chi2_sphere(
                |_| {
                    let sample = self.sample(sampler.next(), from)?;
                    (!sample.delta).then_some(sample.wi)
                },
                |wi| self.host.bsdf_pdf_w(self.hit, self.wo, wi, from),
                SAMPLES,
                sidak(FALSE_ALARM, 4 * CHI2_HITS),
            )
            .map_err(|why| format!("{}: samples do not follow bsdf_pdf_w: {why}", self.at()))?;
        }
        Ok(())
    }
}
