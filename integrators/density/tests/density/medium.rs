//! Photons in media.

use glam::{DVec3, Vec3};
use tyndall_core::{Rgb, Sampler};
use tyndall_density::{Chord, in_scattered};
use tyndall_media::Phase;
use tyndall_testkit::rng;

/// Forward scattering sends on what travels *towards* the sensor.
#[test]
fn forward_scattering_continues_the_flight() {
    let forward = Phase::henyey_greenstein(0.5).expect("a valid mean cosine");
    let flux = Rgb::new(1.0, 2.0, 0.0);
    let along = |direction: Vec3| in_scattered(&forward, Vec3::X, direction, flux);
    // (1 − g²)/(4π (1 ∓ g)³): 27 times as much forwards as backwards.
    let ahead = 0.75 / (4.0 * std::f32::consts::PI * 0.125);
    assert!((along(Vec3::X).0 - ahead * flux.0).length() < 1e-6);
    assert!((along(-Vec3::X).0 - ahead / 27.0 * flux.0).length() < 1e-6);
}

/// The part of a ray inside a ball, from the roots of the quadratic in `f64`.
fn clipped(origin: Vec3, direction: Vec3, radius: f32, t_max: f32) -> Option<(f64, f64)> {
    let (origin, direction): (DVec3, DVec3) = (origin.as_dvec3(), direction.as_dvec3());
    let b = origin.dot(direction);
    let discriminant = b * b - origin.length_squared() + f64::from(radius).powi(2);
    let root = (discriminant > 0.0).then(|| discriminant.sqrt())?;
    let (start, end) = ((-b - root).max(0.0), (-b + root).min(f64::from(t_max)));
    (start < end).then_some((start, end - start))
}

/// Balls around the origin against rays at random, some of which start or end inside. Lengths of a
/// few units and a squared distance rounded to 1e-6: the chord is good to 1e-6/half.
#[test]
fn the_chord_is_the_ray_inside_the_ball() {
    let mut sampler = rng(7);
    let mut inside = 0;
    for _ in 0..100_000 {
        let [x, y, z]: [f32; 3] = sampler.next();
        let origin = 4.0 * Vec3::new(x, y, z) - Vec3::splat(2.0);
        let direction = tyndall_core::warp::uniform_sphere(sampler.next());
        let [radius, t_max]: [f32; 2] = sampler.next();
        let (radius, t_max) = (2.0 * radius, 3.0 * t_max);
        let t = -origin.dot(direction);
        let distance_squared = (origin + t * direction).length_squared();
        let half = (radius * radius - distance_squared).max(0.0).sqrt();
        let tolerance = 1e-5 / half.max(1e-3);
        let chord = Chord::new(t, distance_squared, radius, t_max);
        let (start, length) = chord.map_or((0.0, 0.0), |c| (c.start, c.length));
        let expected = clipped(origin, direction, radius, t_max);
        assert!((length - expected.map_or(0.0, |e| e.1 as f32)).abs() < tolerance);
        if let (Some(_), Some(expected)) = (chord, expected) {
            assert!((start - expected.0 as f32).abs() < tolerance);
            inside += 1;
        }
    }
    assert!(inside > 10_000, "only {inside} rays met their ball");
}

#[test]
fn no_chord_where_nothing_is_inside() {
    for (t, distance_squared, radius, t_max) in [
        (1.0, 4.1, 2.0, 10.0),           // beside
        (-3.0, 0.0, 2.0, 10.0),          // behind the origin
        (13.0, 0.0, 2.0, 10.0),          // beyond the end
        (1.0, 0.0, 0.0, 10.0),           // no ball
        (1.0, 0.0, f32::INFINITY, 10.0), // no density
        (f32::NAN, 0.0, 2.0, 10.0),
        (1.0, f32::NAN, 2.0, 10.0),
        (1.0, 1.0, f32::NAN, 10.0),
        (0.0, 1.0, 2.0, 0.0),
    ] {
        assert_eq!(
            Chord::new(t, distance_squared, radius, t_max),
            None,
            "{t} {radius}"
        );
    }
    // A small ball far away keeps its length, which the difference of its ends would lose.
    let far = Chord::new(1e6, 0.0, 1e-3, f32::INFINITY).expect("a chord");
    assert_eq!(far.length, 2e-3);
}
