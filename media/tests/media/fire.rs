//! Black bodies against what is known of them, and fire made of them.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::rays::{BOUNDS, noise};
use glam::Vec3;
use tyndall_core::{Aabb, Coefficients, Medium, Ray, Rgb, Spectrum};
use tyndall_media::{BlackBody, DenseGrid, Field, GridMedium, Mapped, MediumError, Phase};
use tyndall_testkit::{
    rng,
    stats::{Moments, assert_mean, check_means},
};

const FALSE_ALARM: f64 = 1e-6;

/// CIE x and y of a linear sRGB colour.
fn chromaticity(Rgb(c): Rgb) -> [f32; 2] {
    let x = Vec3::new(0.412_456_4, 0.357_576_1, 0.180_437_5).dot(c);
    let y = Vec3::new(0.212_672_9, 0.715_152_2, 0.072_175_0).dot(c);
    let z = Vec3::new(0.019_333_9, 0.119_192, 0.950_304_1).dot(c);
    [x, y].map(|v| v / (x + y + z))
}

/// The old candela: a black body at the melting point of platinum, 2041.4 K, has 6e5 cd·m⁻². And
/// 683 lm/W times the luminance of the sun's 5772 K, 1.88e9 cd·m⁻². The fit is good to 1 %.
#[test]
fn luminances_are_those_of_nature() {
    for (kelvin, candela) in [(2041.4, 6.0e5), (5772.0, 1.88e9)] {
        let luminance = 683.0 * BlackBody::absolute().luminance(kelvin);
        assert!(
            (luminance / candela - 1.0).abs() < 0.02,
            "{kelvin}: {luminance}"
        );
    }
}

/// Of the Planckian locus (Wyszecki & Stiles 1982), within what a fit of 1 % moves it.
#[test]
fn colours_lie_on_the_planckian_locus() {
    for (kelvin, x, y) in [
        (2000.0, 0.5267, 0.4133),
        (2856.0, 0.4476, 0.4074),
        (4000.0, 0.3805, 0.3768),
        (6500.0, 0.3135, 0.3237),
        (10_000.0, 0.2807, 0.2884),
        (1e5, 0.2408, 0.2349),
    ] {
        let [found_x, found_y] = chromaticity(BlackBody::absolute().colour(kelvin));
        let error = (found_x - x).abs().max((found_y - y).abs());
        assert!(error < 0.005, "{kelvin}: {found_x}, {found_y}");
    }
}

/// The luminance is kept where channels are clipped, nothing is negative, and all rise.
#[test]
fn colours_rise_and_keep_their_luminance() {
    let body = BlackBody::relative_to(1500.0).unwrap();
    assert!((body.luminance(1500.0) - 1.0).abs() < 1e-6);
    assert_eq!(body.colour(1000.0).channel(2), 0.0);
    let mut before = Rgb::default();
    for i in 0..40_000 {
        let kelvin = 100.0 * (1e4_f32.ln() * i as f32 / 4e4).exp();
        let colour = body.colour(kelvin);
        let weights = Rgb::new(0.212_672_9, 0.715_152_2, 0.072_175_0);
        let luminance = body.luminance(kelvin);
        assert!(
            ((weights * colour).sum() - luminance).abs() <= 1e-5 * luminance,
            "{kelvin}"
        );
        // Two neighbours round apart.
        let falls = before
            .zip(colour, |a, b| a * (1.0 - 1e-6) - b)
            .max_channel();
        assert!(falls <= 0.0, "{kelvin}: {before:?}, {colour:?}");
        before = colour;
    }
}

/// The table against Wien's law where it holds: d ln Y/d(1/T) is −c₂/λ for some λ that is seen.
#[test]
fn extremes_are_finite() {
    let body = BlackBody::absolute();
    for kelvin in [
        0.0,
        1e-38,
        1e-3,
        2.7,
        100.0,
        499.9,
        1e5,
        1e7,
        1e30,
        f32::MAX,
        f32::INFINITY,
    ] {
        let (colour, luminance) = (body.colour(kelvin), body.luminance(kelvin));
        assert!(
            colour.is_finite() && luminance.is_finite(),
            "{kelvin}: {colour:?}"
        );
        assert!(colour.channel(0) >= 0.0 && luminance >= 0.0);
    }
    assert_eq!(body.colour(0.0), Rgb::default());
    assert_eq!(body.luminance(f32::NAN), 0.0);
    let ratio = body.luminance(450.0) / body.luminance(460.0);
    let wavelength = 1.438_777e-2 * (1.0 / 450.0 - 1.0 / 460.0) / -ratio.ln();
    assert!((5.8e-7..7.5e-7).contains(&wavelength), "{wavelength}");
    for temperature in [0.0, -5.0, f32::NAN, 1e9] {
        let error = BlackBody::relative_to(temperature).unwrap_err();
        assert!(matches!(error, MediumError::Temperature { .. }));
    }
}

fn fire<S: Spectrum>(sigma_a: S, sigma_s: S, source: impl Field<S> + 'static) -> GridMedium<S> {
    let density = noise([25, 11, 18], &mut rng(1));
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    let medium = GridMedium::new(density, coefficients, Phase::Isotropic).unwrap();
    medium.with_source(source).unwrap()
}

fn temperature(values: Vec<f32>) -> DenseGrid {
    DenseGrid::new([values.len(), 1, 1], BOUNDS, values).unwrap()
}

/// Without scattering, an even temperature: (1 − e^{−τ}) times the colour; and with an albedo of ½
/// everywhere half of it.
#[test]
fn fire_of_one_temperature_saturates_at_its_colour() {
    let body = BlackBody::relative_to(1800.0).unwrap();
    let colour = body.colour(1800.0);
    let source = || Mapped::rising(temperature(vec![1800.0]), move |t| body.colour(t));
    let sigma_a = Rgb::new(0.1, 1.0, 10.0);
    let hot = fire(sigma_a, Rgb::default(), source());
    let half = DenseGrid::new([1; 3], BOUNDS, vec![Rgb::splat(0.5)]).unwrap();
    let dim = hot.clone().with_albedo(half).unwrap();
    let ray = Ray::new(BOUNDS.center() - 2.5 * Vec3::X, Vec3::X);
    let mut sampler = rng(2);
    let mut cases = Vec::new();
    for (medium, share) in [(&hot, 1.0), (&dim, 0.5)] {
        let depth = hot.optical_depth(&ray);
        let mut moments = [Moments::new(); 3];
        for _ in 0..100_000 {
            let emitted = medium.emitted(&ray, &mut sampler);
            (0..3).for_each(|c| moments[c].push(f64::from(emitted.channel(c))));
        }
        for (c, moments) in moments.iter().enumerate() {
            let opacity = -(-f64::from(depth.channel(c))).exp_m1();
            let expected = share * opacity * f64::from(colour.channel(c));
            cases.push(("emitted", moments.estimate(), expected));
        }
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// A grey scene, and a temperature that varies: emission is σa·source at every point.
#[test]
fn emission_follows_the_temperature() {
    let body = BlackBody::absolute();
    let grid = temperature(vec![300.0, 900.0, 2500.0, 1200.0]);
    let source = Mapped::rising(grid.clone(), move |t| body.luminance(t));
    let medium = fire(0.5_f32, 2.0, source);
    let mut glowing = 0;
    for i in 0..1000 {
        let p = BOUNDS.min + BOUNDS.size() * Vec3::new(i as f32 / 1e3, 0.37, 0.61);
        let here = medium.coefficients(p);
        let expected = here.sigma_a * body.luminance(grid.lookup(p));
        assert!((here.emission - expected).abs() <= 1e-6 * expected, "{p}");
        glowing += i32::from(here.emission > 0.0);
    }
    assert!(glowing > 300);
    // Where nothing is hot, nothing is emitted and no walk is slowed down.
    let cold = Mapped::rising(temperature(vec![0.0]), move |t| body.luminance(t));
    let ray = Ray::new(BOUNDS.center(), Vec3::X);
    assert_eq!(fire(0.5_f32, 2.0, cold).emitted(&ray, &mut rng(3)), 0.0);
}

/// A flame of a sixteenth of the box, in thin air. Cells are at most twice as large, and a collision
/// is asked for in each: a rate of 8/√3 at least. A ray along an edge crosses the flame over 1/16 and
/// so has 1/(2√3) collisions, a relative variance of 3.5, to which what else is in the cells adds
/// nothing.
#[test]
fn a_small_flame_in_thin_air_is_found() {
    const EDGE: usize = 128;
    let is_flame = |i: usize| (56..64).contains(&i);
    let glow: Vec<_> = (0..EDGE.pow(3))
        .map(|i| {
            [i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE]
                .into_iter()
                .all(is_flame)
        })
        .map(|flame| Rgb::splat(f32::from(flame)))
        .collect();
    let bounds = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };
    let density = DenseGrid::new([1; 3], bounds, vec![0.01]).unwrap();
    let air = Coefficients {
        sigma_a: Rgb::splat(1.0),
        ..Coefficients::default()
    };
    let glow = DenseGrid::new([EDGE; 3], bounds, glow).unwrap();
    let fire = GridMedium::new(density, air, Phase::Isotropic).unwrap();
    let fire = fire.with_emission(glow).unwrap();
    let ray = Ray::new(Vec3::new(0.47, 0.47, -1.0), Vec3::Z);
    let (mut seen, mut sampler) = (Moments::default(), rng(11));
    for _ in 0..20_000 {
        seen.push(f64::from(fire.emitted(&ray, &mut sampler).0.x));
    }
    let estimate = seen.estimate();
    // Of the middle, for what is before and behind it makes up for each other.
    let expected = (-0.01 * 60.0 / 128.0_f64).exp() / 16.0;
    assert_mean("flame", estimate, expected, FALSE_ALARM);
    let relative = seen.variance() / expected.powi(2);
    assert!(relative < 3.6, "{relative}");
}

/// Whatever the values, and where they differ by less than rounding.
#[test]
fn constant_fields_do_not_fall() {
    for value in [0.1, 0.8, 0.95, 1500.1, 1833.37] {
        for above in [value, f32::next_up(value), value + 1e-2] {
            let same = Mapped::rising(temperature(vec![value, above]), |t: f32| t);
            assert_eq!(Field::check(&same), Ok(()), "{value}, {above}");
        }
    }
}

#[test]
fn a_function_that_falls_is_refused() {
    let refused = |function: fn(f32) -> f32| {
        Mapped::rising(temperature(vec![1.0, 3.0]), function)
            .check()
            .unwrap_err()
    };
    let error = refused(|t| 5.0 - t);
    assert!(
        matches!(
            error,
            MediumError::Falling {
                channel: 0,
                before: 4.0,
                ..
            }
        ),
        "{error}"
    );
    for bad in [
        |_| f32::NAN,
        |t: f32| if t > 2.0 { f32::INFINITY } else { t },
        |_| -1.0,
    ] {
        assert!(matches!(refused(bad), MediumError::Falling { .. }));
    }
}
