//! Fields that a host computes, and what happens where they leave their bounds.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::rays::{BOUNDS, point, ray};
use glam::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tyndall_core::{Aabb, Coefficients, Medium, Ray, Rgb, Spectrum};
use tyndall_media::{AnyMedium, Field, GridMedium, MediumError, Phase, Procedural};
use tyndall_testkit::{
    rng,
    stats::{Estimate, Moments, check_means},
};

const FALSE_ALARM: f64 = 1e-6;

/// A ball of density 4 in its middle and 0 at its rim.
fn ball(p: Vec3) -> f32 {
    4.0 * (1.0 - p.distance(BOUNDS.center())).max(0.0)
}

/// The least and the greatest of [`ball`] in a box.
fn ball_bounds(part: Aabb) -> [f32; 2] {
    let center = BOUNDS.center();
    let nearest = center.clamp(part.min, part.max);
    let farthest = (center - part.min).abs().max((part.max - center).abs());
    // A hair more for the rounding of `ball`.
    [ball(center + farthest) - 1e-5, ball(nearest) + 1e-5]
}

fn medium<S: Spectrum>(density: Procedural, sigma_a: S, sigma_s: S) -> GridMedium<S, Procedural> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: sigma_a,
    };
    GridMedium::new(density, coefficients, Phase::Isotropic).unwrap()
}

/// ∫ density dt, by the midpoint rule over the part of the ray in the box: the kinks cost 1e-7.
fn column(ray: &Ray) -> f64 {
    const STEPS: usize = 20_000;
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let [a, b] = [BOUNDS.min, BOUNDS.max].map(|face| (face.as_dvec3() - origin) / direction);
    let start = a.min(b).max_element().max(0.0);
    let end = a.max(b).min_element().min(f64::from(ray.t_max));
    let step = (end - start).max(0.0) / STEPS as f64;
    let values = (0..STEPS).map(|i| {
        let p = origin + direction * (start + step * (i as f64 + 0.5));
        4.0 * (1.0 - p.distance(BOUNDS.center().as_dvec3())).max(0.0)
    });
    values.sum::<f64>() * step
}

#[test]
fn estimates_are_unbiased_with_one_bound_and_with_many() {
    let one = Procedural::new(BOUNDS, 4.0, ball).unwrap();
    let many = (one.clone().with_local_bounds([13, 7, 10], ball_bounds)).unwrap();
    let mut sampler = rng(1);
    let (sigma_a, sigma_s) = (Rgb::new(0.1, 0.2, 0.7), Rgb::new(0.0, 0.3, 0.3));
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for density in [one, many] {
        let medium = medium(density, sigma_a, sigma_s);
        for ray in (0..20).map(|_| ray(&mut sampler)).collect::<Vec<_>>() {
            let column = column(&ray);
            let mut moments = [[Moments::new(); 3]; 3];
            for _ in 0..20_000 {
                let transmittance = medium.transmittance(&ray, &mut sampler);
                let emitted = medium.emitted(&ray, &mut sampler);
                let flight = medium.sample_free_flight(&ray, Rgb::splat(1.0), &mut sampler);
                let passed = if flight.collision.is_none() { 1.0 } else { 0.0 };
                for (c, moments) in moments.iter_mut().enumerate() {
                    moments[0].push(f64::from(transmittance.channel(c)));
                    moments[1].push(f64::from(emitted.channel(c)));
                    moments[2].push(f64::from(passed * flight.weight.channel(c)));
                }
            }
            for (c, moments) in moments.iter().enumerate() {
                let [a, s] = [sigma_a, sigma_s].map(|sigma| f64::from(sigma.channel(c)));
                let expected = (-(a + s) * column).exp();
                let [transmittance, emitted, passed] = moments.map(|m| m.estimate());
                cases.push(("transmittance", transmittance, expected));
                cases.push(("emitted", emitted, (1.0 - expected) * a / (a + s)));
                cases.push(("passed", passed, expected));
            }
        }
        assert_eq!(medium.density().overruns(), 0);
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// A rod that fills 1/150 of the box: with bounds of parts at most a tenth of the lookups, and the
/// way through what is empty has none.
#[test]
fn bounds_of_parts_save_lookups() {
    let lookups = Arc::new(AtomicU64::new(0));
    let counted = lookups.clone();
    let axis = BOUNDS.center();
    let rod = move |p: Vec3| {
        counted.fetch_add(1, Ordering::Relaxed);
        let inside = (p - axis).truncate().abs().max_element() < 0.1;
        if inside { 5.0 } else { 0.0 }
    };
    let bounds = move |part: Aabb| {
        let reach = 0.1001;
        let meets = (part.min - axis).truncate().max_element() < reach
            && (part.max - axis).truncate().min_element() > -reach;
        [0.0, if meets { 5.0 } else { 0.0 }]
    };
    let one = Procedural::new(BOUNDS, 5.0, rod).unwrap();
    let many = one.clone().with_local_bounds([30, 15, 1], bounds).unwrap();
    let cost = |density: Procedural| {
        let medium = medium(density, 1.0_f32, 1.0);
        lookups.store(0, Ordering::Relaxed);
        let mut sampler = rng(2);
        for _ in 0..1000 {
            let ray = ray(&mut sampler);
            medium.transmittance(&ray, &mut sampler);
        }
        lookups.load(Ordering::Relaxed)
    };
    let [one, many] = [one, many].map(cost);
    assert!(many > 0 && 10 * many <= one, "{many} against {one}");
}

#[test]
fn a_bound_that_does_not_hold_is_refused() {
    let grey = Coefficients {
        sigma_a: 1.0_f32,
        sigma_s: 1.0,
        emission: 0.0,
    };
    let refused = |field: Procedural| {
        let error = GridMedium::new(field, grey, Phase::Isotropic).unwrap_err();
        assert!(matches!(error, MediumError::Overrun { .. }), "{error}");
        error.to_string()
    };
    let low = Procedural::new(BOUNDS, 3.0, ball).unwrap();
    let message = refused(low);
    assert!(message.contains("is bounded by 0 and 3"), "{message}");
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let spot = move |p: Vec3| if p.x > 1.5 { bad } else { 1.0 };
        refused(Procedural::new(BOUNDS, 3.0, spot).unwrap());
    }
    // The bound of the box holds, that of a cell does not, or is no number.
    for wrong in [[0.0, 2.0], [1.0, 4.0], [0.0, f32::NAN], [f32::NAN, 4.0]] {
        let field = Procedural::new(BOUNDS, 4.0, ball).unwrap();
        refused(field.with_local_bounds([9; 3], move |_| wrong).unwrap());
    }
}

/// A spike that no check can be hoped to find.
#[test]
fn what_slips_through_is_finite_and_counted() {
    for spike in [1e30, f32::INFINITY, f32::NAN, -5.0] {
        let at = BOUNDS.center();
        let field = move |p: Vec3| if p.distance(at) < 1e-3 { spike } else { 1.0 };
        let medium = medium(Procedural::new(BOUNDS, 1e3, field).unwrap(), 1.0_f32, 1.0);
        assert_eq!(medium.density().overruns(), 0);
        let here = medium.coefficients(at).sigma_t();
        assert!((0.0..=2e3).contains(&here), "{here}");
        assert_eq!(medium.clone().density().overruns(), 1);
        let ray = Ray::new(at, Vec3::X).up_to(1e-2);
        let mut sampler = rng(3);
        for _ in 0..100 {
            assert!(medium.transmittance(&ray, &mut sampler).is_finite());
            let flight = medium.sample_free_flight(&ray, 1.0, &mut sampler);
            assert!(flight.weight.is_finite());
        }
        assert!(medium.density().overruns() > 1);
    }
}

#[test]
fn albedo_and_emission_may_be_functions_too() {
    let density: Arc<dyn Field<f32>> = Arc::new(Procedural::new(BOUNDS, 2.0, |_| 2.0).unwrap());
    let albedo = |p: Vec3| Rgb::new(1.0, 0.5, 0.25) * (p.x + 1.0) / 3.0;
    let albedo = Procedural::new(BOUNDS, Rgb::splat(1.0), albedo).unwrap();
    let glow = Procedural::new(BOUNDS, Rgb::splat(9.0), |p| Rgb::splat(p.y)).unwrap();
    let grey = Coefficients {
        sigma_a: Rgb::splat(1.0),
        ..Coefficients::default()
    };
    let smoke = GridMedium::new(density, grey, Phase::Isotropic).unwrap();
    let smoke = smoke
        .with_albedo(albedo)
        .unwrap()
        .with_emission(glow)
        .unwrap();
    let any = AnyMedium::Field(Arc::new(smoke));
    let p = point(&mut rng(4));
    let here = any.coefficients(p);
    let expected = Rgb::new(2.0, 1.0, 0.5) * ((p.x + 1.0) / 3.0);
    assert!((here.sigma_s - expected).map(f32::abs).max_channel() < 1e-6);
    assert_eq!(here.emission, Rgb::splat(p.y));
    let bright = Procedural::new(BOUNDS, Rgb::splat(1.5), |_| Rgb::splat(1.0)).unwrap();
    let density = Procedural::new(BOUNDS, 2.0, |_| 2.0).unwrap();
    let error = medium(density, Rgb::splat(1.0), Rgb::default()).with_albedo(bright);
    assert!(matches!(error, Err(MediumError::Albedo { channel: 0, .. })));
}

#[test]
fn wrong_numbers_are_named() {
    let flat = Aabb {
        max: BOUNDS.max.with_z(0.0),
        ..BOUNDS
    };
    let error = Procedural::new(flat, 1.0, ball).unwrap_err();
    assert_eq!(error, MediumError::GridBounds);
    for value in [-1.0, f32::INFINITY] {
        let error = Procedural::new(BOUNDS, value, ball).unwrap_err();
        assert_eq!(error, MediumError::Majorant { channel: 0, value });
    }
    for resolution in [[0, 1, 1], [1 << 9; 3], [usize::MAX; 3]] {
        let field = Procedural::new(BOUNDS, 4.0, ball).unwrap();
        let error = field
            .with_local_bounds(resolution, ball_bounds)
            .unwrap_err();
        assert_eq!(error, MediumError::Cells { resolution });
    }
}
