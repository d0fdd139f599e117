//! Light that only connections find: `sample_direct` knows what its emission is.

use super::describe;
use crate::conformance::{FALSE_ALARM, RELATIVE, ensure, same_emission};
use crate::stats::{chi2_sphere, sidak};
use crate::{TestSampler, rng};
use glam::Vec3;
use tyndall_core::{
    Anchor, DirectSample, EmissionSample, LightDirect, LightEmission, LightKind, Sampler, Spectrum,
};

/// Emission samples compared.
const COMPARED: usize = 2_000;
/// Direct samples drawn to find the light of one of them.
const TRIES: usize = 64;
/// Of those compared, one in so many may differ.
const EDGES: usize = 1_000;
/// Point lights that get a χ² test.
const POINTS: usize = 4;
/// Numbers kept with which `sample_direct` finds a point light.
const WAYS: usize = 8;
/// Samples for each statistical test.
const SAMPLES: usize = 200_000;
/// A point within this share of the scene's diagonal is the same point.
const NEAR: f32 = 1e-4;

/// A point light, and how to find it.
struct Source {
    position: Vec3,
    ways: Vec<[f32; 4]>,
}

/// Compares emitted light with direct light.
pub(super) struct Unhittable<'a, H> {
    host: &'a H,
    scale: f32,
    sampler: TestSampler,
    tried: usize,
    found: usize,
    failed: usize,
    /// The first failure.
    why: String,
    points: Vec<Source>,
}

impl<'a, H: LightEmission + LightDirect> Unhittable<'a, H> {
    pub(super) fn new(host: &'a H, scale: f32) -> Self {
        Self {
            host,
            scale,
            sampler: rng(7),
            tried: 0,
            found: 0,
            failed: 0,
            why: String::new(),
            points: Vec::new(),
        }
    }

    /// Looks for the light of the sample from a point of its ray, until densities agree.
    pub(super) fn check(&mut self, sample: &EmissionSample<H::Spectrum, H::Hit>) {
        if self.tried == COMPARED || sample.flux.is_black() {
            return;
        }
        self.tried += 1;
        let from = sample.ray.at(self.scale);
        let mut other = None;
        for _ in 0..TRIES {
            let u = self.sampler.next();
            let direct = self.host.sample_direct(from, u);
            let Some(direct) = direct.filter(|direct| is_same_light(sample, direct)) else {
                continue;
            };
            if same_emission(direct.emission, sample.pdf, RELATIVE) {
                self.found += 1;
                return self.remember(sample, u);
            }
            other = Some(direct.emission);
        }
        if let Some(emission) = other {
            self.found += 1;
            self.failed += 1;
            if self.failed == 1 {
                self.why = format!("{}: at {from} it is {emission:?}", describe(sample));
            }
        }
    }

    fn remember(&mut self, sample: &EmissionSample<H::Spectrum, H::Hit>, u: [f32; 4]) {
        let Anchor::Point(position) = sample.source else {
            return;
        };
        let near = NEAR * self.scale;
        let known = self.points.iter_mut();
        match known
            .into_iter()
            .find(|p| p.position.distance(position) <= near)
        {
            Some(known) if known.ways.len() < WAYS => known.ways.push(u),
            Some(_) => {}
            None => self.points.push(Source {
                position,
                ways: vec![u],
            }),
        }
    }

    pub(super) fn conclude(&self) -> Result<(), String> {
        let Self {
            tried,
            found,
            failed,
            why,
            ..
        } = self;
        ensure(*found > 0 || *tried < TRIES, || {
            format!("{tried} rays were emitted by lights that sample_direct does not find")
        })?;
        ensure(failed * EDGES <= *found, || {
            format!("sample_direct states another emission for {failed} of {found} rays: {why}")
        })?;
        let mut points = self.points.iter().take(POINTS);
        points.try_for_each(|point| self.check_directions(point))
    }

    /// Both densities count, for the choice of the light may be part of either.
    fn check_directions(&self, source: &Source) -> Result<(), String> {
        let Source { position, ways } = source;
        let is_here = |at: &Anchor<H::Hit>| matches!(at, Anchor::Point(p) if p.distance(*position) <= NEAR * self.scale);
        let mut sampler = rng(8);
        let emitted = |_| {
            let sample = self.host.sample_emission(sampler.next())?;
            let here = is_here(&sample.source) && !sample.flux.is_black();
            here.then_some(sample.ray.direction)
        };
        let density = |w| {
            let from = *position + self.scale * w;
            let direct = ways.iter().find_map(|u| {
                let direct = self.host.sample_direct(from, *u)?;
                (direct.kind == LightKind::Point && is_here(&direct.target)).then_some(direct)
            });
            direct.map_or(0.0, |d| d.emission.pdf_a * d.emission.pdf_w)
        };
        let each = sidak(FALSE_ALARM, POINTS);
        chi2_sphere(emitted, density, SAMPLES, each).map_err(|why| {
            format!("light from {position} does not follow the density that is stated: {why}")
        })
    }
}

fn is_same_light<S, Hit>(sample: &EmissionSample<S, Hit>, direct: &DirectSample<S, Hit>) -> bool {
    direct.kind == sample.kind && direct.wi.distance(-sample.ray.direction) < 1e-2
}
