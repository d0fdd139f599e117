//! Points and surfaces of a host, found by random walks from its sensor.

use crate::{TestSampler, rng};
use glam::Vec3;
use tyndall_core::{
    Anchor, Geometry, Media, MediumId, Ray, Sampler, Sensor, Shading, SurfaceKind, warp,
};

/// A ray, what it met, and where.
pub(super) struct Probe<Hit> {
    pub(super) ray: Ray,
    /// The medium that the ray came through.
    pub(super) medium: MediumId,
    pub(super) t: f32,
    pub(super) hit: Hit,
}

/// Up to `count` hits of walks from the sensor that leave surfaces in uniform directions, on both
/// sides, four hits a walk.
///
/// # Errors
/// If the host has bounds and no walk met a surface.
pub(super) fn probes<H: Geometry + Media + Sensor>(
    host: &H,
    count: usize,
) -> Result<Vec<Probe<H::Hit>>, String> {
    let mut sampler = rng(count as u64);
    let mut probes = Vec::new();
    for _ in 0..count {
        let (mut ray, mut medium) = sensor_ray(host, &mut sampler);
        for _ in 0..4 {
            let Some((t, hit)) = host.intersect(&ray, medium) else {
                break;
            };
            let direction = warp::uniform_sphere(sampler.next());
            let next = host.spawn(&Anchor::Surface(hit.clone()), direction);
            let behind = host.medium_across(&hit, direction, medium);
            probes.push(Probe {
                ray,
                medium,
                t,
                hit,
            });
            (ray, medium) = (next, behind);
        }
        if probes.len() >= count {
            break;
        }
    }
    if probes.is_empty() && !host.bounds().is_empty() {
        return Err(format!(
            "the host has bounds {:?}, but no ray from its sensor met a surface: point the sensor at one",
            host.bounds()
        ));
    }
    probes.truncate(count);
    Ok(probes)
}

/// `count` points along the rays of the sensor and of walks from it.
pub(super) fn points<H: Geometry + Media + Sensor>(
    host: &H,
    count: usize,
) -> Result<Vec<(Vec3, MediumId)>, String> {
    let mut sampler = rng(count as u64 + 1);
    let scale = scale(host)?;
    let mut points: Vec<_> = probes(host, count.div_ceil(2))?
        .iter()
        .map(|p| (p.ray.at(p.t * sampler.next_1d()), p.medium))
        .collect();
    while points.len() < count {
        let (ray, medium) = sensor_ray(host, &mut sampler);
        let end = host.intersect(&ray, medium).map_or(scale, |(t, _)| t);
        points.push((ray.at(end * sampler.next_1d()), medium));
    }
    Ok(points)
}

fn sensor_ray<H: Sensor>(host: &H, sampler: &mut TestSampler) -> (Ray, MediumId) {
    let px = host
        .resolution()
        .map(|n| ((sampler.next_1d() * n as f32) as u32).min(n.saturating_sub(1)));
    let start = host.sensor_ray(px, sampler.next());
    (start.ray, start.medium)
}

/// The diagonal of the bounds; 1 if they are empty, the mean distance of hits if they are
/// infinite.
///
/// # Errors
/// As [`probes`].
pub(super) fn scale<H: Geometry + Media + Sensor>(host: &H) -> Result<f32, String> {
    let bounds = host.bounds();
    if bounds.is_empty() {
        return Ok(1.0);
    }
    let diagonal = bounds.size().length();
    if diagonal.is_finite() {
        return Ok(diagonal);
    }
    let probes = probes(host, 64)?;
    Ok(probes.iter().map(|p| p.t).sum::<f32>() / probes.len() as f32)
}

/// The first surface within the ray that is not null.
pub(super) fn first_solid<H: Geometry + Shading + Media>(
    host: &H,
    mut ray: Ray,
    mut medium: MediumId,
) -> Option<H::Hit> {
    loop {
        let (t, hit) = host.intersect(&ray, medium)?;
        if host.surface_kind(&hit) != SurfaceKind::Null {
            return Some(hit);
        }
        medium = host.medium_across(&hit, ray.direction, medium);
        let next = host.spawn(&Anchor::Surface(hit), ray.direction);
        let walked = t + (next.origin - ray.at(t)).dot(ray.direction);
        if walked >= ray.t_max {
            return None;
        }
        ray = next.up_to(ray.t_max - walked);
    }
}
