//! Connections to the sensor.

use super::{FALSE_ALARM, RELATIVE, ensure, is_unit, same, valid};
use crate::stats::{Moments, check_mean, sidak};
use crate::{TestSampler, rng};
use glam::Vec3;
use std::f32::consts::TAU;
use tyndall_core::{
    Frame, Ray, Sampler, SensorConnection, SensorImportance, SensorRay, Spectrum, warp,
};

/// Rays for the pointwise checks.
const RAYS: usize = 2_000;
/// Of which so many may find no connection: rounding decides at the rim of the film.
const RIM: usize = 20;
/// Samples for each statistical test.
const SAMPLES: usize = 200_000;
/// Lens points whose rays get a test of their density.
const LENS_POINTS: usize = 2;
/// Tiles of the film in each axis.
const TILES: usize = 4;
/// Tests of means: every tile and the whole film.
const MEANS: usize = TILES * TILES + 1;
/// Radius of the glowing sphere, in distances between points of the lens.
const FAR: f32 = 10.0;

/// Connections are what the sensor's rays are.
///
/// For a sensor whose pixels are means over their area, with `u[0..2]` of `sensor_ray` for the place
/// in the pixel, and whose `connect_sensor` maps `u` to the lens as `sensor_ray` does `u[2..4]`:
/// - a point of a sensor's ray is connected to the place of that ray on the film, along it, with its
///   `pdf_w`;
/// - rays of one point of the lens have `pdf_w` for density: the mean of its inverse is the solid
///   angle that connects;
/// - a sphere of unit radiance around the sensor splats the image that the rays gather.
///
/// The last two hold for each of 4 × 4 tiles and for the whole film.
///
/// # Errors
/// A sentence with the first offence.
pub fn importance<H: SensorImportance>(host: &H) -> Result<(), String> {
    let mut sampler = rng(5);
    let mut rim = 0;
    for _ in 0..RAYS {
        let px = pixel(host, sampler.next());
        let u = sampler.next();
        let start = host.sensor_ray(px, u);
        let point = start
            .ray
            .at(Sphere::around(host).radius * (0.1 + sampler.next_1d()));
        match host.connect_sensor(point, [u[2], u[3]]) {
            Some(connection) => check_connection(px, u, &start, point, &connection)?,
            None => rim += 1,
        }
    }
    ensure(rim <= RIM, || {
        format!("{rim} of {RAYS} points on rays of the sensor do not connect to it")
    })?;
    for _ in 0..LENS_POINTS {
        let lens = sampler.next();
        check_density(host, lens, &mut sampler)?;
    }
    check_image(host, &mut sampler)
}

fn pixel<H: SensorImportance>(host: &H, u: [f32; 2]) -> [u32; 2] {
    let resolution = host.resolution();
    [0, 1].map(|i| ((u[i] * resolution[i] as f32) as u32).min(resolution[i] - 1))
}

fn check_connection<S: Spectrum>(
    px: [u32; 2],
    u: [f32; 4],
    start: &SensorRay<S>,
    point: Vec3,
    connection: &SensorConnection<S>,
) -> Result<(), String> {
    let at = || format!("{connection:?} from {point} on {start:?} of pixel {px:?}, u {u:?}");
    let distance = point.distance(start.ray.origin);
    let along = is_unit(connection.wi)
        && connection.wi.distance(-start.ray.direction) < RELATIVE
        && same(connection.distance, distance, RELATIVE);
    ensure(along, || format!("{}: not along the ray", at()))?;
    let off = |i: usize| (connection.raster[i] - px[i] as f32 - u[i]).abs();
    ensure(off(0) < 1e-2 && off(1) < 1e-2, || {
        format!("{}: elsewhere on the film", at())
    })?;
    let known = start.pdf_w > 0.0 && same(connection.pdf_w, start.pdf_w, RELATIVE);
    ensure(known, || {
        format!("{}: both pdf_w must be the same and positive", at())
    })?;
    ensure(valid(connection.weight), || format!("{}: unsound", at()))
}

/// The solid angle of each tile, seen from one point of the lens, by connections and by rays.
fn check_density<H: SensorImportance>(
    host: &H,
    lens: [f32; 2],
    sampler: &mut TestSampler,
) -> Result<(), String> {
    let ray = |px, [a, b]: [f32; 2]| host.sensor_ray(px, [a, b, lens[0], lens[1]]);
    let sphere = Sphere {
        center: ray([0, 0], [0.5; 2]).ray.origin,
        ..Sphere::around(host)
    };
    let cap = sphere.seen(|| ray(pixel(host, sampler.next()), sampler.next()).ray);
    let (mut connected, mut traced) = ([Moments::new(); MEANS], [Moments::new(); MEANS]);
    for _ in 0..SAMPLES {
        let point = sphere.center + sphere.radius * cap.direction(sampler.next());
        let connection = host.connect_sensor(point, lens);
        let (px, angle) = connection.map_or(([0; 2], 0.0), |c| (whole(c.raster), cap.angle()));
        record(&mut connected, tile(host, px), angle);
        let px = pixel(host, sampler.next());
        let pdf_w = ray(px, sampler.next()).pdf_w;
        record(&mut traced, tile(host, px), pdf_w.recip());
    }
    compare(
        "solid angle by connections, less that by pdf_w",
        &connected,
        &traced,
    )
}

/// Both images of the sphere, as sums of pixels.
fn check_image<H: SensorImportance>(host: &H, sampler: &mut TestSampler) -> Result<(), String> {
    let sphere = Sphere::around(host);
    let cap = sphere.seen(|| {
        host.sensor_ray(pixel(host, sampler.next()), sampler.next())
            .ray
    });
    let pixels: f32 = host.resolution().map(|n| n as f32).iter().product();
    let (mut splatted, mut traced) = ([Moments::new(); MEANS], [Moments::new(); MEANS]);
    for _ in 0..SAMPLES {
        let w = cap.direction(sampler.next());
        let area = cap.angle() * sphere.radius * sphere.radius;
        let connection = host.connect_sensor(sphere.center + sphere.radius * w, sampler.next());
        let (px, sent) = connection.map_or(([0; 2], 0.0), |c| {
            (whole(c.raster), c.weight.mean() * c.wi.dot(-w) * area)
        });
        record(&mut splatted, tile(host, px), sent);
        let px = pixel(host, sampler.next());
        let weight = host.sensor_ray(px, sampler.next()).weight.mean();
        record(&mut traced, tile(host, px), weight * pixels);
    }
    compare("splatted image, less the traced", &splatted, &traced)
}

fn compare(what: &str, a: &[Moments; MEANS], b: &[Moments; MEANS]) -> Result<(), String> {
    let each = sidak(FALSE_ALARM, MEANS * (LENS_POINTS + 1));
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        let (a, b) = (a.estimate(), b.estimate());
        let name = format!(
            "tile {i} of {TILES} × {TILES} ({} is the film), {}: {what}",
            MEANS - 1,
            b.mean
        );
        check_mean(&name, a.difference(&b), 0.0, each)?;
    }
    Ok(())
}

fn whole(raster: [f32; 2]) -> [u32; 2] {
    raster.map(|x| x as u32)
}

fn tile<H: SensorImportance>(host: &H, px: [u32; 2]) -> usize {
    let resolution = host.resolution();
    let [x, y] = [0, 1].map(|i| px[i] as usize * TILES / resolution[i] as usize);
    y.min(TILES - 1) * TILES + x.min(TILES - 1)
}

fn record(sums: &mut [Moments; MEANS], tile: usize, value: f32) {
    for (i, sum) in sums.iter_mut().enumerate() {
        let counts = i == tile || i == MEANS - 1;
        sum.push(if counts { f64::from(value) } else { 0.0 });
    }
}

/// A sphere that holds the lens, whose inside glows with radiance 1.
#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3,
    radius: f32,
}

/// The part of it that the sensor sees.
struct Cap {
    axis: Frame,
    /// 1 − cos of its angle from the centre.
    height: f32,
}

impl Sphere {
    /// Large enough that the coordinates of the lens are exact on its scale.
    fn around<H: SensorImportance>(host: &H) -> Self {
        let origin = |a: f32, b: f32| host.sensor_ray([0, 0], [0.5, 0.5, a, b]).ray.origin;
        let center = origin(0.5, 0.5);
        let lens = origin(0.0, 0.0).distance(origin(1.0 - f32::EPSILON, 1.0 - f32::EPSILON));
        let radius = (FAR * lens).max(center.length());
        Self {
            center,
            radius: if radius > 0.0 { radius } else { 1.0 },
        }
    }

    /// Direction from the centre to where a ray from within leaves the sphere.
    fn leaves(&self, ray: &Ray) -> Vec3 {
        let offset = (ray.origin - self.center) / self.radius;
        let middle = offset.dot(ray.direction);
        let half = (1.0 - offset.length_squared() + middle * middle).max(0.0);
        (offset + (half.sqrt() - middle) * ray.direction).normalize()
    }

    fn seen(&self, mut ray: impl FnMut() -> Ray) -> Cap {
        let seen: Vec<Vec3> = (0..RAYS).map(|_| self.leaves(&ray())).collect();
        let axis = seen.iter().sum::<Vec3>().normalize_or(Vec3::Z);
        let heights = seen.iter().map(|w| 0.5 * (*w - axis).length_squared());
        Cap {
            axis: Frame::around(axis),
            height: (1.5 * heights.fold(0.0, f32::max)).min(2.0),
        }
    }
}

impl Cap {
    fn direction(&self, u: [f32; 2]) -> Vec3 {
        self.axis.to_world(warp::uniform_cone(self.height, u))
    }

    fn angle(&self) -> f32 {
        TAU * self.height
    }
}
