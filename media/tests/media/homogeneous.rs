//! The closed forms of homogeneous media, and their extremes.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use glam::Vec3;
use tyndall_core::{Coefficients, Medium, Ray, Rgb, Sampler, Spectrum};
use tyndall_media::{Homogeneous, MediumError, Phase};
use tyndall_testkit::{
    rng,
    stats::{Estimate, Moments, check_means, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;

fn medium<S: Spectrum>(sigma_a: S, sigma_s: S, emission: S) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission,
    };
    Homogeneous::new(coefficients, Phase::Isotropic).unwrap()
}

/// Extinctions 0.05, 1 and 5.
fn chromatic() -> Homogeneous<Rgb> {
    let (sigma_a, sigma_s) = (Rgb::new(0.04, 0.0, 1.0), Rgb::new(0.01, 1.0, 4.0));
    medium(sigma_a, sigma_s, Rgb::default())
}

const SIGMA_T: [f64; 3] = [0.05, 1.0, 5.0];
const IMPORTANCE: Rgb = Rgb::new(0.2, 1.0, 0.3);

fn ray() -> Ray {
    Ray::new(Vec3::new(3.0, -1.0, 2.0), Vec3::NEG_Y)
}

#[test]
fn distances_are_exponential() {
    let medium = medium(0.5, 2.0, 0.0);
    let mut sampler = rng(1);
    let mut t: Vec<f64> = (0..200_000)
        .map(|_| {
            let flight = medium.sample_free_flight(&ray(), 1.0, &mut sampler);
            assert!((flight.weight - 1.0).abs() < 1e-6);
            f64::from(flight.collision.unwrap().t)
        })
        .collect();
    kolmogorov_smirnov(&mut t, |t| -(-2.5 * t).exp_m1(), FALSE_ALARM).unwrap();
}

/// Light passes a ray of length s with probability Σ pmf·e^{−σt·s}.
#[test]
fn light_passes_as_often_as_it_says() {
    let mut sampler = rng(3);
    let passing = ray().up_to(0.7);
    let coloured = chromatic();
    let passed: Moments = (0..200_000)
        .map(|_| coloured.sample_free_flight(&passing, IMPORTANCE, &mut sampler))
        .map(|flight| f64::from(u8::from(flight.collision.is_none())))
        .collect();
    let pmf = [0.2, 1.0, 0.3].map(|x| x / 1.5);
    let expected: f64 = (0..3).map(|c| pmf[c] * (-0.7 * SIGMA_T[c]).exp()).sum();
    let stated = f64::from(coloured.pmf_passing(&passing, IMPORTANCE));
    assert!(
        (stated - expected).abs() < 1e-6,
        "{stated} against {expected}"
    );
    check_means(&[("passing", passed.estimate(), expected)], FALSE_ALARM).unwrap();
}

/// Numbers of 24 bits alone would reach from 6e-8 to 16.6 mean free paths, and 0.
#[test]
fn the_shortest_and_the_longest_flights_are_finer_than_a_number() {
    struct Script(std::vec::IntoIter<f32>);
    impl Sampler for Script {
        fn next_1d(&mut self) -> f32 {
            self.0.next().unwrap()
        }
    }
    let medium = medium(0.0, 1.0, 0.0);
    let last = 1.0 - f32::EPSILON / 2.0;
    for (numbers, expected) in [
        (vec![0.0, 0.5], 2.0_f64.powi(-25)),
        (vec![last, 0.5], 25.0 * 2.0_f64.ln()),
        (vec![0.25], -(0.75_f64.ln())),
    ] {
        let mut script = Script(numbers.into_iter());
        let flight = medium.sample_free_flight(&ray(), 1.0, &mut script);
        let t = f64::from(flight.collision.unwrap().t);
        assert!((t / expected - 1.0).abs() < 1e-6, "{t} for {expected}");
    }
}

/// Distances follow Σ pmf·(1 − e^{−σt·t}), and `pdf_free_flight` is its derivative.
#[test]
fn distances_follow_the_mixture_of_channels() {
    let medium = chromatic();
    let pmf = [0.2, 1.0, 0.3].map(|x| x / 1.5);
    let cdf = |t: f64| -> f64 { (0..3).map(|c| pmf[c] * -(-SIGMA_T[c] * t).exp_m1()).sum() };
    let mut sampler = rng(2);
    let mut t: Vec<f64> = (0..200_000)
        .map(|_| {
            let flight = medium.sample_free_flight(&ray(), IMPORTANCE, &mut sampler);
            f64::from(flight.collision.unwrap().t)
        })
        .collect();
    kolmogorov_smirnov(&mut t, cdf, FALSE_ALARM).unwrap();
    for t in [0.0, 0.01, 0.3, 2.0, 40.0] {
        let pdf_t = f64::from(medium.pdf_free_flight(&ray(), t, IMPORTANCE));
        let expected: f64 = (0..3)
            .map(|c| pmf[c] * SIGMA_T[c] * (-SIGMA_T[c] * f64::from(t)).exp())
            .sum();
        assert!(
            (pdf_t / expected - 1.0).abs() < 1e-5,
            "{t}: {pdf_t} for {expected}"
        );
    }
    assert_eq!(
        medium.pdf_free_flight(&ray().up_to(1.0), 1.5, IMPORTANCE),
        0.0
    );
}

/// Per channel: the weight of collisions before x has mean 1 − Tr(x), that of passing Tr(t_max);
/// and Σ importance·weight is Σ importance whatever happens.
#[test]
fn weights_are_unbiased_in_every_channel() {
    let medium = chromatic();
    let (x, t_max) = (0.4_f32, 1.5_f32);
    let mut sampler = rng(3);
    let (mut before, mut passed) = ([Moments::new(); 3], [Moments::new(); 3]);
    for _ in 0..400_000 {
        let flight = medium.sample_free_flight(&ray().up_to(t_max), IMPORTANCE, &mut sampler);
        let conserved = (IMPORTANCE * flight.weight).sum();
        assert!(
            (conserved / IMPORTANCE.sum() - 1.0).abs() < 1e-5,
            "{flight:?}"
        );
        for c in 0..3 {
            let weight = f64::from(flight.weight.channel(c));
            let early = flight.collision.is_some_and(|collision| collision.t < x);
            before[c].push(if early { weight } else { 0.0 });
            passed[c].push(if flight.collision.is_none() {
                weight
            } else {
                0.0
            });
        }
    }
    let transmittance = |c: usize, t: f32| (-SIGMA_T[c] * f64::from(t)).exp();
    let cases: Vec<(&str, Estimate, f64)> = (0..3)
        .flat_map(|c| {
            [
                ("before", before[c].estimate(), 1.0 - transmittance(c, x)),
                ("passed", passed[c].estimate(), transmittance(c, t_max)),
            ]
        })
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap();
}

#[test]
fn a_channel_that_does_not_interact_passes() {
    let medium = medium(Rgb::default(), Rgb::new(0.0, 2.0, 0.0), Rgb::default());
    let mut sampler = rng(4);
    let mut collisions = 0;
    for _ in 0..10_000 {
        let flight = medium.sample_free_flight(&ray(), Rgb::splat(1.0), &mut sampler);
        match flight.collision {
            Some(_) => {
                collisions += 1;
                assert!((flight.weight.channel(1) - 3.0).abs() < 1e-6);
                assert_eq!(flight.weight * Rgb::new(1.0, 0.0, 1.0), Rgb::default());
            }
            None => assert_eq!(flight.weight, Rgb::new(1.5, 0.0, 1.5)),
        }
    }
    // Binomial of probability 1/3: 5 standard deviations, false alarm 6e-7.
    assert!((f64::from(collisions) - 3333.3).abs() < 5.0 * 47.2);
}

/// ∫₀ˢ e^{−σt·t} dt against its closed form in `f64`, over 12 decades of optical depth.
#[test]
fn emission_is_right_for_thin_and_thick() {
    for sigma_t in [0.0, 1e-6, 1e-3, 1.0, 40.0, 1e6] {
        for s in [1e-6, 1e-3, 1.0, 1e3, 1e6, f32::INFINITY] {
            let medium = medium(sigma_t, 0.0, 3.0);
            let emitted = f64::from(medium.emitted(&ray().up_to(s), &mut rng(0)));
            let (sigma_t, s) = (f64::from(sigma_t), f64::from(s));
            let expected = match sigma_t {
                0.0 => 3.0 * s,
                _ => -3.0 * (-sigma_t * s).exp_m1() / sigma_t,
            };
            let near = emitted == expected || (emitted / expected - 1.0).abs() < 1e-6;
            assert!(near, "{sigma_t}, {s}: {emitted} for {expected}");
        }
    }
}

/// Fire of source function 1: emission = σa, radiance 1 − e^{−τ}.
#[test]
fn fire_saturates_at_its_source_function() {
    let sigma_a = Rgb::new(0.1, 1.0, 10.0);
    let fire = medium(sigma_a, Rgb::default(), sigma_a);
    let emitted = fire.emitted(&ray().up_to(0.7), &mut rng(0));
    for c in 0..3 {
        let expected = -(-0.7 * f64::from(sigma_a.channel(c))).exp_m1();
        assert!((f64::from(emitted.channel(c)) / expected - 1.0).abs() < 1e-6);
    }
}

#[test]
fn extremes_are_finite() {
    let mut sampler = rng(5);
    let levels = [0.0, 1e-38, 1e-6, 1.0, 1e6];
    let importances = [
        Rgb::default(),
        Rgb::splat(1.0),
        Rgb::new(1.0, 0.0, 0.0),
        Rgb::new(1e-38, 1.0, 1e38),
        Rgb::new(1e-40, 1.0, 0.0),
        Rgb::splat(f32::MAX),
    ];
    for sigma in (0..125).map(|i| Rgb::new(levels[i % 5], levels[i / 5 % 5], levels[i / 25])) {
        for t_max in [0.0, 1e-6, 1.0, 1e6, f32::INFINITY] {
            let medium = medium(Rgb::default(), sigma, Rgb::default());
            let ray = ray().up_to(t_max);
            let transmittance = medium.transmittance(&ray, &mut sampler);
            assert!(transmittance.is_finite() && transmittance.max_channel() <= 1.0);
            for importance in importances {
                for _ in 0..20 {
                    check_flight(&medium, &ray, importance, &mut sampler);
                }
            }
        }
    }
}

fn check_flight(medium: &Homogeneous<Rgb>, ray: &Ray, importance: Rgb, sampler: &mut impl Sampler) {
    let flight = medium.sample_free_flight(ray, importance, sampler);
    let context = || format!("{medium:?}, {ray:?}, {importance:?}: {flight:?}");
    assert!(flight.weight.is_finite(), "{}", context());
    let t = flight.collision.map_or(0.0, |collision| collision.t);
    assert!(
        t.is_finite() && (0.0..=ray.t_max).contains(&t),
        "{}",
        context()
    );
    let pdf_t = medium.pdf_free_flight(ray, t, importance);
    assert!(pdf_t.is_finite() && pdf_t >= 0.0, "{}", context());
    let collided = flight.collision.is_some();
    assert!(!collided || pdf_t > 0.0 || medium.transmittance(&ray.up_to(t), sampler).is_black());
    // Conserved, importance taken relative to its largest; black counts alike.
    let largest = importance.max_channel();
    let relative = if largest > 0.0 {
        importance / largest
    } else {
        Rgb::splat(1.0)
    };
    let conserved = (relative * flight.weight).sum() / relative.sum();
    assert!((conserved - 1.0).abs() < 1e-4, "{conserved}: {}", context());
}

#[test]
fn wrong_coefficients_are_named() {
    let new = |sigma_a, sigma_s, emission| {
        let coefficients = Coefficients {
            sigma_a,
            sigma_s,
            emission,
        };
        Homogeneous::new(coefficients, Phase::Isotropic).unwrap_err()
    };
    let error = new(Rgb::default(), Rgb::new(1.0, -0.5, 0.0), Rgb::default());
    let expected = MediumError::Coefficient {
        field: "sigma_s",
        channel: 1,
        value: -0.5,
    };
    assert_eq!(error, expected);
    assert!(
        error
            .to_string()
            .starts_with("`sigma_s` of channel 1 is -0.5")
    );
    for bad in [f32::NAN, f32::INFINITY] {
        let error = new(Rgb::default(), Rgb::default(), Rgb::splat(bad));
        assert!(matches!(
            error,
            MediumError::Coefficient {
                field: "emission",
                channel: 0,
                ..
            }
        ));
    }
    let huge = Rgb::splat(3e38);
    assert!(matches!(
        new(huge, huge, Rgb::default()),
        MediumError::Coefficient { .. }
    ));
}
