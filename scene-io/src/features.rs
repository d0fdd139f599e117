//! What a denoiser takes besides the image: colour, normal and distance of what rays meet first.

use crate::Scene;
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::{
    Anchor, Domain, Geometry, Media, Medium, Rgb, Sampler, Sensor, SensorRay, Shading, Spectrum,
    Streams, SurfaceKind,
};

/// Means over the samples of each pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Features {
    /// Between 0 and 1.
    pub albedo: Vec<Rgb>,
    /// In the world, of length 1 at most.
    pub normal: Vec<Vec3>,
    /// From the start of the ray; infinite where nothing is met.
    pub depth: Vec<f32>,
}

/// What one ray meets first.
#[derive(Clone, Copy, Debug)]
struct Feature {
    /// What the surface or the medium sends back of the light that it meets.
    albedo: Rgb,
    /// Shading normal on the ray's side; zero in a medium.
    normal: Vec3,
    /// Distance along the ray.
    depth: f32,
}

impl<S: Spectrum> Scene<S> {
    /// What a ray of the sensor meets first; `None` if it leaves the scene.
    fn feature(&self, start: &SensorRay<S>, sampler: &mut impl Sampler) -> Option<Feature> {
        let (mut ray, mut medium) = (start.ray, start.medium);
        loop {
            let hit = self.intersect(&ray, medium);
            let segment = ray.up_to(hit.as_ref().map_or(f32::INFINITY, |(t, _)| *t));
            let collision = self.medium(medium).and_then(|medium| {
                let flight = medium.sample_free_flight(&segment, S::splat(1.0), sampler);
                flight.collision
            });
            if let Some(collision) = collision {
                let depth = start.ray.origin.distance(ray.at(collision.t));
                return Some(Feature {
                    albedo: rgb(collision.coefficients.albedo()),
                    normal: Vec3::ZERO,
                    depth,
                });
            }
            let (_, hit) = hit?;
            if self.surface_kind(&hit) != SurfaceKind::Null {
                let surface = self.surface(&hit);
                let facing = -surface.geometric_normal.dot(ray.direction);
                let albedo = self.bsdf(&hit).map_or(S::splat(1.0), |b| b.albedo());
                return Some(Feature {
                    albedo: rgb(albedo),
                    normal: surface.shading_normal * 1.0_f32.copysign(facing),
                    depth: start.ray.origin.distance(surface.position),
                });
            }
            medium = self.medium_across(&hit, ray.direction, medium);
            ray = self.spawn(&Anchor::Surface(hit), ray.direction);
        }
    }

    /// What the sensor's rays meet first: means of `samples` rays a pixel, on the current rayon pool,
    /// the same bits on any number of threads. The random numbers are those of `streams` that no
    /// integrator takes.
    ///
    /// A surface that light passes straight is not met. The albedo of a surface is its reflectance,
    /// that of rough metal for light of normal incidence, and 1 where directions are discrete
    /// (mirrors, smooth glass) or light passes (rough glass), as denoisers expect.
    ///
    /// In a medium, light is met at the distance of a collision, which is sampled: the mean of many
    /// samples blends the medium and what is behind it by what is seen of both. There the albedo is
    /// that of a single scattering, σs/σt, and the normal zero.
    ///
    /// # Panics
    /// If `samples` is 0.
    pub fn features(&self, streams: &impl Streams, samples: u32) -> Features {
        assert!(samples > 0, "features are means of at least one sample");
        let [width, height] = self.resolution().map(u64::from);
        let means = (0..width * height).into_par_iter().map(|i| {
            let px = [(i % width) as u32, (i / width) as u32];
            let mut sampler = streams.sampler(Domain::FEATURES, i);
            let found = (0..samples).filter_map(|_| {
                let start = self.sensor_ray(px, sampler.next());
                self.feature(&start, &mut sampler)
            });
            mean(found, samples)
        });
        let means: Vec<Feature> = means.collect();
        Features {
            albedo: means.iter().map(|m| m.albedo).collect(),
            normal: means.iter().map(|m| m.normal).collect(),
            depth: means.iter().map(|m| m.depth).collect(),
        }
    }
}

/// Colour and normal count as 0 where nothing is met, the distance not at all. The weights of the
/// reconstruction filter do not count: its negative ones would lead out of the range of a colour.
fn mean(found: impl Iterator<Item = Feature>, samples: u32) -> Feature {
    let (mut albedo, mut normal, mut depth) = (Rgb::default(), Vec3::ZERO, 0.0);
    let mut count = 0_u32;
    for feature in found {
        albedo += feature.albedo;
        normal += feature.normal;
        depth += f64::from(feature.depth);
        count += 1;
    }
    Feature {
        albedo: albedo / samples as f32,
        normal: normal / samples as f32,
        depth: if count > 0 {
            (depth / f64::from(count)) as f32
        } else {
            f32::INFINITY
        },
    }
}

/// All channels, or the one in all of three.
fn rgb<S: Spectrum>(colour: S) -> Rgb {
    Rgb::from_channels(|i| colour.channel(i.min(S::CHANNELS - 1)))
}
