//! Intersection, spawned rays and connections.

use super::probe::{Probe, probes, scale};
use super::{ensure, is_unit};
use crate::rng;
use tyndall_core::{Anchor, Geometry, Media, Ray, Sampler, Sensor, warp};

/// Rays traced.
const RAYS: usize = 4000;
/// Directions closer to a surface than this sine are left out: there the next hit may be near.
const GRAZING: f32 = 0.01;
/// A point within this share of the scene's diagonal is the same point.
const NEAR: f32 = 1e-4;
/// Share of connections that may fail, where rounding at an edge decides.
const EDGES: f64 = 1e-3;

/// Surfaces are where the rays say, rays leave them and reach them.
///
/// On 4,000 hits of random walks from the sensor:
/// - the hit lies on the ray, within it, and is met again by the ray cut behind it, not by the ray
///   cut before it, by 1e-3 of its distance and 1e-4 of the scene's diagonal; normals are unit
///   vectors on one side;
/// - a spawned ray keeps its direction, starts at its surface, and does not *meet itself*: no hit
///   within 1e-4 of the scene's diagonal whose normal is the same (cosine above 0.999), for
///   directions that leave the surface at a sine above 0.01;
/// - a connection between a hit and what is seen from there meets nothing, either way, and ends at
///   its target: one in a thousand may fail, at edges;
/// - without null surfaces, `occluded` says what `intersect` says.
///
/// # Errors
/// A sentence with the first offence.
pub fn geometry<H: Geometry + Media + Sensor>(host: &H) -> Result<(), String> {
    let mut sampler = rng(2);
    let scale = scale(host)?;
    let mut connections = Connections::default();
    for probe in probes(host, RAYS)? {
        check_hit(host, &probe, scale)?;
        check_spawn(host, &probe, scale, &mut sampler)?;
        connections.check(host, &probe, scale)?;
    }
    let Connections { tried, failed, why } = connections;
    ensure(failed as f64 <= EDGES * tried as f64, || {
        format!("{failed} of {tried} connections between points that see each other fail: {why}")
    })
}

fn check_hit<H: Geometry + Media>(
    host: &H,
    probe: &Probe<H::Hit>,
    scale: f32,
) -> Result<(), String> {
    let Probe {
        ray,
        medium,
        t,
        hit,
    } = probe;
    ensure(*t > 0.0 && t.is_finite() && *t <= ray.t_max, || {
        format!("{ray:?} hits at {t}, which is not within it")
    })?;
    let surface = host.surface(hit);
    let distance = surface.position.distance(ray.at(*t));
    ensure(distance <= NEAR * scale.max(*t), || {
        format!("{ray:?} hits at {t}, {distance} off {surface:?}")
    })?;
    let (geometric, shading) = (surface.geometric_normal, surface.shading_normal);
    let sound = is_unit(geometric) && is_unit(shading) && geometric.dot(shading) > 0.0;
    ensure(sound, || {
        format!("normals of {surface:?} are not unit vectors on the same side")
    })?;
    let meets = |end: f32| host.intersect(&ray.up_to(end), *medium).is_some();
    let slack = 1e-3 * t + NEAR * scale;
    ensure(
        meets(t + slack) && (*t <= slack || !meets(t - slack)),
        || {
            format!(
                "{ray:?} hits at {t}, but not so if t_max is just behind, or if it is just before"
            )
        },
    )?;
    ensure(host.has_null_surfaces() || host.occluded(ray), || {
        format!("{ray:?} hits at {t} but is not occluded")
    })
}

fn check_spawn<H: Geometry + Media>(
    host: &H,
    probe: &Probe<H::Hit>,
    scale: f32,
    sampler: &mut impl Sampler,
) -> Result<(), String> {
    let surface = host.surface(&probe.hit);
    let direction = warp::uniform_sphere(sampler.next());
    if surface.geometric_normal.dot(direction).abs() < GRAZING {
        return Ok(());
    }
    let ray = host.spawn(&Anchor::Surface(probe.hit.clone()), direction);
    let distance = ray.origin.distance(surface.position);
    let sound = ray.direction.distance(direction) < 1e-5 && ray.t_max == f32::INFINITY;
    ensure(sound && distance <= 10.0 * NEAR * scale, || {
        format!("{ray:?} was spawned along {direction} at {surface:?}")
    })?;
    let medium = host.medium_across(&probe.hit, direction, probe.medium);
    let Some((t, next)) = host.intersect(&ray, medium) else {
        return Ok(());
    };
    let next = host.surface(&next);
    let same_normal = next.geometric_normal.dot(surface.geometric_normal) > 0.999;
    ensure(t > NEAR * scale || !same_normal, || {
        format!("{ray:?}, spawned at {surface:?}, meets it again at {t}: {next:?}")
    })
}

#[derive(Default)]
struct Connections {
    tried: usize,
    failed: usize,
    /// The first failure.
    why: String,
}

impl Connections {
    /// The start of a probe's ray sees its hit: connects them both ways.
    fn check<H: Geometry + Media>(
        &mut self,
        host: &H,
        probe: &Probe<H::Hit>,
        scale: f32,
    ) -> Result<(), String> {
        let direction = probe.ray.direction;
        let surface = host.surface(&probe.hit);
        // Half way, so that the point is not on the surface that the ray left.
        let point = probe.ray.at(0.5 * probe.t);
        let grazing = surface.geometric_normal.dot(direction).abs() < GRAZING;
        if grazing || 0.5 * probe.t < 10.0 * NEAR * scale {
            return Ok(());
        }
        let (here, there) = (Anchor::Point(point), Anchor::Surface(probe.hit.clone()));
        let forth = host.connect(&here, &there);
        let back = host.connect(&there, &here);
        for (ray, target) in [(forth, surface.position), (back, point)] {
            let end = ray.at(ray.t_max);
            let off = end.distance(target);
            ensure(
                is_unit(ray.direction) && off <= 10.0 * NEAR * scale.max(ray.t_max),
                || format!("{ray:?} connects to {target} and ends at {end}"),
            )?;
            self.count(host, probe, &ray);
        }
        Ok(())
    }

    fn count<H: Geometry>(&mut self, host: &H, probe: &Probe<H::Hit>, ray: &Ray) {
        self.tried += 1;
        if let Some((t, _)) = host.intersect(ray, probe.medium) {
            if self.failed == 0 {
                self.why = format!("{ray:?} meets a surface at {t}");
            }
            self.failed += 1;
        }
    }
}
