//! Light leaving its sources.

mod unhittable;

use super::probe::scale;
use super::{FALSE_ALARM, RELATIVE, ensure, is_unit, same_emission, same_spectrum, valid};
use crate::rng;
use crate::stats::{Moments, check_mean, sidak};
use tyndall_core::{
    Anchor, EmissionPdf, EmissionSample, Geometry, LightDirect, LightEmission, LightKind, LightPdf,
    Media, Ray, Sampler, Sensor, Shading, Spectrum,
};
use unhittable::Unhittable;

/// Samples drawn.
const SAMPLES: usize = 20_000;
/// How far in front of a source, in diagonals of the scene, the ray back to it starts.
const BACK: f32 = 1e-3;
/// Rays closer to their source than this cosine are left out: there rounding blurs the source.
const GRAZING: f32 = 0.1;

/// Emitted light has the radiance of its source and the density that is stated.
///
/// Each of 20,000 samples is finite, of unit direction, with positive densities, and starts within
/// a thousandth of the scene's diagonal of its `source`, which is what its kind says. Then:
/// - of the background and of area lights (cosines below 0.1 left out), `pdf_emission` agrees, and
///   flux × `pdf_a` × `pdf_w` / cos θ is the emitted radiance; a ray back along the light finds the
///   surface, unless another is in between, which more than a tenth of the rays must not claim;
/// - of the other lights, `sample_direct` at a point of the ray states the same densities: one in a
///   thousand may fail, at the rim of a spot or a beam;
/// - directions from a point follow the density that `sample_direct` states around it
///   ([`chi2_sphere`](crate::stats::chi2_sphere)), of up to four points. Spots narrower than
///   0.02 rad, and lights that share their point, are too much for this test, which then fails.
///
/// # Errors
/// A sentence with the first offence.
pub fn emission<H>(host: &H) -> Result<(), String>
where
    H: Geometry + Shading + Media + LightEmission + LightDirect + LightPdf + Sensor,
{
    let scale = scale(host)?;
    let mut sampler = rng(3);
    let mut unhittable = Unhittable::new(host, scale);
    let (mut area, mut lost) = (0, 0);
    for _ in 0..SAMPLES {
        let Some(sample) = host.sample_emission(sampler.next()) else {
            continue;
        };
        check_sample(&sample)?;
        check_start(host, &sample, scale)?;
        let direction = sample.ray.direction;
        match &sample.source {
            Anchor::Surface(_) if sample.cos_theta < GRAZING => {}
            Anchor::Surface(hit) => {
                check_radiance(host, &sample, host.emitted(hit, direction))?;
                area += 1;
                lost += usize::from(!returns(host, &sample, scale));
            }
            Anchor::Direction(w) if sample.kind == LightKind::Background => {
                check_radiance(host, &sample, host.background(*w))?;
            }
            Anchor::Point(_) | Anchor::Direction(_) => unhittable.check(&sample),
        }
    }
    ensure(10 * lost <= area, || {
        format!("{lost} of {area} rays of area lights do not start on their source")
    })?;
    unhittable.conclude()
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

/// A sample without its source, which may not be printable.
fn describe<S: Spectrum, Hit>(sample: &EmissionSample<S, Hit>) -> String {
    let EmissionSample {
        ray,
        flux,
        pdf,
        cos_theta,
        kind,
        ..
    } = sample;
    format!("{kind:?} light along {ray:?}, cos θ {cos_theta}, flux {flux:?}, {pdf:?}")
}

fn check_sample<S: Spectrum, Hit>(sample: &EmissionSample<S, Hit>) -> Result<(), String> {
    let EmissionPdf { pdf_a, pdf_w } = sample.pdf;
    let sound = sample.ray.origin.is_finite()
        && is_unit(sample.ray.direction)
        && valid(sample.flux)
        && (pdf_a > 0.0 && pdf_a.is_finite() && pdf_w > 0.0 && pdf_w.is_finite())
        && (0.0..=1.001).contains(&sample.cos_theta);
    ensure(sound, || format!("unsound {}", describe(sample)))
}

/// The source is what the kind says, and where the ray starts.
fn check_start<H: Geometry>(
    host: &H,
    sample: &EmissionSample<H::Spectrum, H::Hit>,
    scale: f32,
) -> Result<(), String> {
    let Ray {
        origin, direction, ..
    } = sample.ray;
    let near = |p| origin.distance(p) <= BACK * scale;
    let right = match (sample.kind, &sample.source) {
        (LightKind::Area, Anchor::Surface(hit)) => {
            let surface = host.surface(hit);
            let cosine = surface.geometric_normal.dot(direction).abs();
            near(surface.position) && (cosine - sample.cos_theta).abs() < RELATIVE
        }
        (LightKind::Point, Anchor::Point(p)) => near(*p),
        (LightKind::Parallel | LightKind::Background, Anchor::Direction(w)) => {
            w.distance(-direction) < RELATIVE
        }
        _ => false,
    };
    ensure(right, || {
        format!("{}: the source is another, or cos θ", describe(sample))
    })
}

/// Whether a ray back along the light finds a surface where it started.
fn returns<H: Geometry>(
    host: &H,
    sample: &EmissionSample<H::Spectrum, H::Hit>,
    scale: f32,
) -> bool {
    let distance = BACK * scale;
    let ray = Ray::new(sample.ray.at(distance), -sample.ray.direction);
    let found = host.intersect(&ray, sample.medium);
    found.is_some_and(|(t, _)| t <= 2.0 * distance && t >= 0.5 * distance)
}

fn check_radiance<H: LightPdf>(
    host: &H,
    sample: &EmissionSample<H::Spectrum, H::Hit>,
    radiance: H::Spectrum,
) -> Result<(), String> {
    let stated = host.pdf_emission(&sample.source, sample.ray.direction);
    ensure(same_emission(sample.pdf, stated, RELATIVE), || {
        format!("{}, but pdf_emission is {stated:?}", describe(sample))
    })?;
    let EmissionPdf { pdf_a, pdf_w } = sample.pdf;
    let flux = radiance * (sample.cos_theta / (pdf_a * pdf_w));
    ensure(same_spectrum(sample.flux, flux, RELATIVE), || {
        format!(
            "{}, but radiance {radiance:?} × cos θ / density is {flux:?}",
            describe(sample)
        )
    })
}
