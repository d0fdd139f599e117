//! Light leaving its sources.

use super::probe::scale;
use super::{FALSE_ALARM, ensure, is_unit, same, same_spectrum, valid};
use crate::rng;
use crate::stats::{Moments, check_mean, sidak};
use tyndall_core::{
    Anchor, EmissionPdf, EmissionSample, Geometry, LightEmission, LightKind, LightPdf, Ray,
    Sampler, Shading, Spectrum,
};

/// Samples drawn.
const SAMPLES: usize = 20_000;
/// How far in front of a source, in diagonals of the scene, the ray back to it starts.
const BACK: f32 = 1e-3;
/// Relative difference allowed, since the place looked up is not exactly the place sampled.
const LOOKED_UP: f32 = 1e-2;
/// Rays closer to their source than this cosine are left out: there the place is too uncertain.
const GRAZING: f32 = 0.1;

/// Emitted light has the radiance of its source and the density that is stated.
///
/// Each of 20,000 samples is finite, of unit direction, with positive densities. For the background
/// and for area lights, whose surface is looked up by a ray back along the light,
/// `pdf_emission` agrees and flux × `pdf_a` × `pdf_w` / cos θ is the emitted radiance, within one
/// per cent; cosines below 0.1 are left out. Where
/// another surface is within a thousandth of the scene's diagonal of the light, the sample is left
/// out; more than a tenth of such samples is an error.
///
/// # Errors
/// A sentence with the first offence.
pub fn emission<H: Geometry + Shading + LightEmission + LightPdf>(host: &H) -> Result<(), String> {
    let mut sampler = rng(3);
    let (mut area, mut lost) = (0, 0);
    for _ in 0..SAMPLES {
        let Some(sample) = host.sample_emission(sampler.next()) else {
            continue;
        };
        check_sample(&sample)?;
        let direction = sample.ray.direction;
        match sample.kind {
            LightKind::Point | LightKind::Parallel => {}
            LightKind::Background => {
                let at = Anchor::Direction(-direction);
                check_source(host, &sample, &at, host.background(-direction))?;
            }
            LightKind::Area if sample.cos_theta < GRAZING => {}
            LightKind::Area => {
                area += 1;
                match source(host, &sample) {
                    Some(hit) => {
                        let radiance = host.emitted(&hit, direction);
                        check_source(host, &sample, &Anchor::Surface(hit), radiance)?;
                    }
                    None => lost += 1,
                }
            }
        }
    }
    ensure(10 * lost <= area, || {
        format!("{lost} of {area} rays of area lights do not start on their source")
    })
}

/// The mean flux of 20,000 emitted rays is the total power of the lights, per channel.
///
/// # Errors
/// A sentence with the measured power.
pub fn power<H: LightEmission>(host: &H, power: H::Spectrum) -> Result<(), String> {
    let mut sampler = rng(4);
    let mut channels = vec![Moments::new(); H::Spectrum::CHANNELS];
    for _ in 0..SAMPLES {
        let flux = host
            .sample_emission(sampler.next())
            .map_or(H::Spectrum::default(), |sample| sample.flux);
        for (i, moments) in channels.iter_mut().enumerate() {
            moments.push(f64::from(flux.channel(i)));
        }
    }
    let each = sidak(FALSE_ALARM, H::Spectrum::CHANNELS);
    channels.iter().enumerate().try_for_each(|(i, moments)| {
        let name = format!("emitted power, channel {i}");
        check_mean(&name, moments.estimate(), f64::from(power.channel(i)), each)
    })
}

fn check_sample<S: Spectrum>(sample: &EmissionSample<S>) -> Result<(), String> {
    let EmissionPdf { pdf_a, pdf_w } = sample.pdf;
    let sound = sample.ray.origin.is_finite()
        && is_unit(sample.ray.direction)
        && valid(sample.flux)
        && (pdf_a > 0.0 && pdf_a.is_finite() && pdf_w > 0.0 && pdf_w.is_finite())
        && (0.0..=1.001).contains(&sample.cos_theta);
    ensure(sound, || format!("unsound {sample:?}"))
}

/// The surface that the light left, on a ray back to it.
fn source<H: Geometry>(host: &H, sample: &EmissionSample<H::Spectrum>) -> Option<H::Hit> {
    let distance = BACK * scale(host);
    let ray = Ray::new(sample.ray.at(distance), -sample.ray.direction);
    let (t, hit) = host.intersect(&ray, sample.medium)?;
    (t <= 2.0 * distance && t >= 0.5 * distance).then_some(hit)
}

fn check_source<H: LightPdf>(
    host: &H,
    sample: &EmissionSample<H::Spectrum>,
    at: &Anchor<H::Hit>,
    radiance: H::Spectrum,
) -> Result<(), String> {
    let stated = host.pdf_emission(at, sample.ray.direction);
    let EmissionPdf { pdf_a, pdf_w } = sample.pdf;
    ensure(
        same(pdf_a, stated.pdf_a, LOOKED_UP) && same(pdf_w, stated.pdf_w, LOOKED_UP),
        || format!("{sample:?}, but pdf_emission is {stated:?}"),
    )?;
    let flux = radiance * (sample.cos_theta / (pdf_a * pdf_w));
    ensure(same_spectrum(sample.flux, flux, LOOKED_UP), || {
        format!("{sample:?}, but radiance {radiance:?} × cos θ / density is {flux:?}")
    })
}
