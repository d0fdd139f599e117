//! Media in the same place: their sum, against closed forms and quadrature.
//!
//! Each statistical test has a fixed seed and a false-alarm rate of `FALSE_ALARM`.

use crate::support::rays::{BOUNDS, awkward_rays, noise, point, ray};
use glam::Vec3;
use std::ops::ControlFlow;
use std::sync::Arc;
use tyndall_core::{
    Coefficients, Majorant, Medium, PhaseFunction, Ray, Rgb, Sampler, Spectrum, warp,
};
use tyndall_media::{
    AnyMedium, AnyPhase, Atmosphere, Field, GridMedium, Homogeneous, MediumError, Overlap, Phase,
    Procedural,
};
use tyndall_testkit::{
    rng,
    stats::{Estimate, Moments, check_means, chi2_sphere, kolmogorov_smirnov},
};

const FALSE_ALARM: f64 = 1e-6;
const IMPORTANCE: Rgb = Rgb::new(0.2, 1.0, 0.3);

fn coefficients<S: Spectrum>(sigma_a: S, sigma_s: S, emission: S) -> Coefficients<S> {
    Coefficients {
        sigma_a,
        sigma_s,
        emission,
    }
}

fn fog<S: Spectrum>(coefficients: Coefficients<S>, phase: Phase) -> AnyMedium<S> {
    AnyMedium::Homogeneous(Homogeneous::new(coefficients, phase).unwrap())
}

fn forward() -> Phase {
    Phase::henyey_greenstein(0.7).unwrap()
}

/// A red fog, a blue haze that thins out, and a chromatic smoke that glows, of which each covers
/// what the others leave clear.
struct Mist {
    fog: Coefficients<Rgb>,
    haze: Atmosphere<Rgb>,
    smoke: GridMedium<Rgb>,
}

fn mist(sampler: &mut impl Sampler) -> Mist {
    let fog = coefficients(
        Rgb::new(0.1, 0.0, 0.0),
        Rgb::new(0.3, 0.1, 0.0),
        Rgb::default(),
    );
    let blue = coefficients(
        Rgb::default(),
        Rgb::new(0.0, 0.1, 1.5),
        Rgb::new(0.1, 0.2, 0.3),
    );
    let haze = Atmosphere::new(
        BOUNDS.min,
        Vec3::Y,
        0.8,
        blue,
        Phase::Rayleigh(tyndall_media::Rayleigh),
    );
    let dark = coefficients(
        Rgb::new(0.5, 0.2, 1.0),
        Rgb::new(2.0, 0.2, 0.0),
        Rgb::new(3.0, 2.0, 1.0),
    );
    let smoke = GridMedium::new(noise([25, 11, 18], sampler), dark, forward());
    Mist {
        fog,
        haze: haze.unwrap(),
        smoke: smoke.unwrap(),
    }
}

impl Mist {
    fn overlap(&self) -> Overlap<Rgb> {
        let fog = fog(self.fog, Phase::Isotropic);
        let smoke = AnyMedium::Grid(Arc::new(self.smoke.clone()));
        Overlap::new(vec![smoke, fog, AnyMedium::Atmosphere(self.haze.clone())]).unwrap()
    }

    /// Optical depths, exact but for rounding.
    fn depth(&self, ray: &Ray) -> Rgb {
        let haze = self.haze.transmittance(ray, &mut rng(0));
        let fog = self.fog.sigma_t() * ray.t_max;
        fog + haze.map(|t| -t.ln()) + self.smoke.optical_depth(ray)
    }
}

/// Through the box along +x, entering after 1.
fn across() -> Ray {
    Ray::new(BOUNDS.center() - 2.5 * Vec3::X, Vec3::X).up_to(4.5)
}

#[test]
fn homogeneous_media_add_to_a_homogeneous_medium() {
    let a = coefficients(
        Rgb::new(0.1, 0.0, 1.0),
        Rgb::new(0.0, 1.0, 2.0),
        Rgb::new(1.0, 0.0, 2.0),
    );
    let b = coefficients(
        Rgb::new(0.2, 0.5, 0.0),
        Rgb::new(2.0, 0.0, 0.1),
        Rgb::new(0.0, 3.0, 1.0),
    );
    let sum = coefficients(
        a.sigma_a + b.sigma_a,
        a.sigma_s + b.sigma_s,
        a.emission + b.emission,
    );
    let one = Homogeneous::new(sum, Phase::Isotropic).unwrap();
    let both = Overlap::new(vec![fog(a, Phase::Isotropic), fog(b, Phase::Isotropic)]).unwrap();
    assert_eq!(both.homogeneous(), Some(sum));
    let (ray, mut sampler) = (across().up_to(0.9), rng(1));
    let near = |a: f32, b: f32| assert!((a / b - 1.0).abs() < 1e-5, "{a}, {b}");
    for t in [0.0, 0.2, 0.8] {
        let pdf_t = both.pdf_free_flight(&ray, t, IMPORTANCE);
        near(pdf_t, one.pdf_free_flight(&ray, t, IMPORTANCE));
    }
    near(
        both.pmf_passing(&ray, IMPORTANCE),
        one.pmf_passing(&ray, IMPORTANCE),
    );
    let transmitted = one.transmittance(&ray, &mut sampler);
    let same = both.transmittance(&ray, &mut sampler);
    let emitted = one.emitted(&ray, &mut sampler);
    let mut glow = [Moments::new(); 3];
    for _ in 0..200_000 {
        let emitted = both.emitted(&ray, &mut sampler);
        (0..3).for_each(|c| glow[c].push(f64::from(emitted.channel(c))));
    }
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for (c, glow) in glow.iter().enumerate() {
        near(same.channel(c), transmitted.channel(c));
        cases.push(("emitted", glow.estimate(), emitted.channel(c).into()));
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

#[test]
fn transmittance_is_the_product() {
    let mut sampler = rng(2);
    let mist = mist(&mut sampler);
    let overlap = mist.overlap();
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for ray in (0..20)
        .map(|_| ray(&mut sampler).up_to(2.0))
        .collect::<Vec<_>>()
    {
        let depth = mist.depth(&ray);
        let mut moments = [Moments::new(); 3];
        for _ in 0..10_000 {
            let transmittance = overlap.transmittance(&ray, &mut sampler);
            (0..3).for_each(|c| moments[c].push(f64::from(transmittance.channel(c))));
        }
        let clear = (0..3).filter(|&c| depth.channel(c) < 4.0);
        cases.extend(clear.map(|c| {
            let expected = (-f64::from(depth.channel(c))).exp();
            ("transmittance", moments[c].estimate(), expected)
        }));
    }
    assert!(cases.len() > 40);
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// Per channel: the weight of collisions before x has mean 1 − Tr(x), that of passing Tr(t_max),
/// and weight·albedo that of ∫ σs·Tr; Σ importance·weight is Σ importance whatever happens.
#[test]
fn free_flights_are_unbiased_in_every_channel() {
    let mut sampler = rng(3);
    let mist = mist(&mut sampler);
    let overlap = mist.overlap();
    let mut cases: Vec<(&str, Estimate, f64)> = Vec::new();
    for importance in [Rgb::splat(1.0), IMPORTANCE] {
        let (mut before, mut passed) = ([Moments::new(); 3], [Moments::new(); 3]);
        let mut scattered = [Moments::new(); 3];
        for _ in 0..200_000 {
            let flight = overlap.sample_free_flight(&across(), importance, &mut sampler);
            let conserved = (importance * flight.weight).sum() / importance.sum();
            assert!((conserved - 1.0).abs() < 1e-5, "{flight:?}");
            let t = flight.collision.map(|collision| collision.t);
            if let Some(collision) = flight.collision {
                let here = overlap.coefficients(across().at(collision.t)).sigma_t();
                let error = collision.coefficients.sigma_t() - here;
                assert!(error.map(f32::abs).max_channel() < 1e-5, "{flight:?}");
            }
            let albedo = flight
                .collision
                .map(|c| c.coefficients.albedo())
                .unwrap_or_default();
            for c in 0..3 {
                let weight = f64::from(flight.weight.channel(c));
                let early = t.is_some_and(|t| t < 1.8);
                before[c].push(if early { weight } else { 0.0 });
                passed[c].push(if t.is_none() { weight } else { 0.0 });
                scattered[c].push(weight * f64::from(albedo.channel(c)));
            }
        }
        let near = mist.depth(&across().up_to(1.8));
        let whole = mist.depth(&across());
        let seen = quadrature(&mist, &overlap, &across(), |c| c.sigma_s);
        for c in 0..3 {
            let through = |tau: Rgb| (-f64::from(tau.channel(c))).exp();
            cases.push(("before", before[c].estimate(), 1.0 - through(near)));
            cases.push(("passed", passed[c].estimate(), through(whole)));
            cases.push(("scattered", scattered[c].estimate(), seen[c]));
        }
    }
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// ∫ Tr·(what `of` takes) dt along a ray, by the midpoint rule: 1e-6 of it is lost to the steps,
/// 2e-5 to the face of the box.
fn quadrature(
    mist: &Mist,
    overlap: &Overlap<Rgb>,
    ray: &Ray,
    of: impl Fn(Coefficients<Rgb>) -> Rgb,
) -> [f64; 3] {
    const STEPS: usize = 20_000;
    let mut sums = [0.0; 3];
    for i in 0..STEPS {
        let t = ray.t_max * (i as f32 + 0.5) / STEPS as f32;
        let depth = mist.depth(&ray.up_to(t));
        let here = of(overlap.coefficients(ray.at(t)));
        for (c, sum) in sums.iter_mut().enumerate() {
            *sum += f64::from(here.channel(c)) * (-f64::from(depth.channel(c))).exp();
        }
    }
    sums.map(|sum| sum * f64::from(ray.t_max) / STEPS as f64)
}

/// Fire in smoke and in a haze that glows too, each seen through the other and through fog.
#[test]
fn emission_is_seen_through_all() {
    let mut sampler = rng(4);
    let mist = mist(&mut sampler);
    let overlap = mist.overlap();
    let mut moments = [Moments::new(); 3];
    for _ in 0..200_000 {
        let emitted = overlap.emitted(&across(), &mut sampler);
        (0..3).for_each(|c| moments[c].push(f64::from(emitted.channel(c))));
    }
    let expected = quadrature(&mist, &overlap, &across(), |c| c.emission);
    let cases = [0, 1, 2].map(|c| ("emitted", moments[c].estimate(), expected[c]));
    check_means(&cases, FALSE_ALARM).unwrap();
}

/// The density of distances is Σ pmf·σt·Tr, hence their distribution Σ pmf·(1 − Tr).
#[test]
fn distances_follow_the_mixture_of_channels() {
    const STEPS: usize = 6000;
    let mut sampler = rng(5);
    let mist = mist(&mut sampler);
    let overlap = mist.overlap();
    let pmf = [0.2, 1.0, 0.3].map(|x| x / 1.5);
    let mut t: Vec<f64> = (0..100_000)
        .filter_map(|_| {
            let flight = overlap.sample_free_flight(&across(), IMPORTANCE, &mut sampler);
            flight.collision.map(|collision| f64::from(collision.t))
        })
        .collect();
    let cdf: Vec<f64> = (0..=STEPS)
        .map(|i| {
            let depth = mist.depth(&across().up_to(4.5 * i as f32 / STEPS as f32));
            let each = (0..3).map(|c| pmf[c] * -(-f64::from(depth.channel(c))).exp_m1());
            each.sum()
        })
        .collect();
    let collided = t.len() as f64 / 1e5;
    // Binomial: 5 standard deviations, false alarm 6e-7.
    let deviation = (collided * (1.0 - collided) / 1e5).sqrt();
    assert!(
        (collided - cdf[STEPS]).abs() < 5.0 * deviation,
        "{collided}"
    );
    let lookup = |t: f64| {
        let x = t / 4.5 * STEPS as f64;
        let i = (x as usize).min(STEPS - 1);
        (cdf[i] + (x - i as f64) * (cdf[i + 1] - cdf[i])) / cdf[STEPS]
    };
    kolmogorov_smirnov(&mut t, lookup, FALSE_ALARM).unwrap();
}

/// Grey media: 3 parts of forward scattering to 1 of isotropic, by what each scatters.
#[test]
fn phase_functions_mix_by_what_is_scattered() {
    let scatter = |sigma_s, phase| fog(coefficients(7.0 / sigma_s, sigma_s, 0.0), phase);
    let pair = vec![scatter(3.0_f32, forward()), scatter(1.0, Phase::Isotropic)];
    let dark = fog(
        coefficients(2.0, 0.0, 0.0),
        Phase::henyey_greenstein(-0.9).unwrap(),
    );
    let both = Overlap::new(pair.clone()).unwrap();
    let nested = Overlap::new(vec![dark.clone(), AnyMedium::Overlap(both.clone())]).unwrap();
    let one = Overlap::new(vec![dark.clone(), pair[0].clone()]).unwrap();
    assert!(matches!(one.phase(Vec3::ZERO), AnyPhase::One(_)));
    let none = Overlap::new(vec![dark]).unwrap();
    assert!((none.phase(Vec3::ZERO).eval(Vec3::X, Vec3::Y) * 12.566_371 - 1.0).abs() < 1e-6);
    let mut sampler = rng(6);
    let wo = warp::uniform_sphere(sampler.next());
    for medium in [both, nested] {
        let phase = medium.phase(Vec3::ZERO);
        assert!((phase.mean_cosine() - 0.75 * 0.7).abs() < 1e-6);
        for _ in 0..1000 {
            let wi = warp::uniform_sphere(sampler.next());
            let expected = 0.75 * forward().eval(wo, wi) + 0.25 * Phase::Isotropic.eval(wo, wi);
            assert!((phase.eval(wo, wi) / expected - 1.0).abs() < 1e-5);
        }
        let sample = |u| Some(phase.sample(wo, u).wi);
        chi2_sphere(sample, |wi| phase.pdf_w(wo, wi), 50_000, FALSE_ALARM).unwrap();
    }
}

/// Of a red and a blue medium with lobes of their own: σs·phase, the mean over the channels, is
/// exact in every direction.
#[test]
fn coloured_phase_functions_mix_to_the_right_mean() {
    let mut sampler = rng(7);
    let mist = mist(&mut sampler);
    let overlap = mist.overlap();
    let parts = [
        fog(mist.fog, Phase::Isotropic),
        AnyMedium::Atmosphere(mist.haze.clone()),
        AnyMedium::Grid(Arc::new(mist.smoke.clone())),
    ];
    for _ in 0..1000 {
        let p = point(&mut sampler);
        let [wo, wi] = [(); 2].map(|()| warp::uniform_sphere(sampler.next()));
        let scattered = |medium: &AnyMedium<Rgb>| {
            medium.coefficients(p).sigma_s.mean() * medium.phase(p).eval(wo, wi)
        };
        let expected: f32 = parts.iter().map(scattered).sum();
        let mixed = overlap.coefficients(p).sigma_s.mean() * overlap.phase(p).eval(wo, wi);
        assert!((mixed / expected - 1.0).abs() < 1e-5, "{mixed}, {expected}");
    }
}

#[test]
fn majorants_add() {
    let mut sampler = rng(8);
    let overlap = mist(&mut sampler).overlap();
    let random = (0..300).map(|_| ray(&mut sampler)).collect::<Vec<_>>();
    for ray in random.into_iter().chain(awkward_rays([25, 11, 18])) {
        let mut end = 0.0;
        overlap.majorants(&ray, |stretch| {
            let Majorant {
                t_min,
                t_max,
                sigma_bar,
            } = stretch;
            // The fog is everywhere.
            assert!(
                end == t_min && t_min < t_max && t_max <= ray.t_max,
                "{ray:?}: {stretch:?}"
            );
            end = t_max;
            for i in 0..5 {
                let t = t_min + (t_max - t_min).min(40.0) * (i as f32 + 0.5) / 5.0;
                let sigma_t = overlap.coefficients(ray.at(t)).sigma_t().max_channel();
                assert!(
                    sigma_t <= sigma_bar * (1.0 + 1e-5),
                    "{ray:?}, {t}: {sigma_t}"
                );
            }
            ControlFlow::Continue(())
        });
        assert!(end == ray.t_max, "{ray:?}: {end}");
        let mut visits = 0;
        overlap.majorants(&ray, |_| {
            visits += 1;
            ControlFlow::Break(())
        });
        assert_eq!(visits, i32::from(ray.t_max > 0.0));
    }
}

/// Media of 0 to 1e6 over each other, in balls, grids and everywhere; importances that are black or
/// 1e76 apart.
#[test]
fn extremes_are_finite() {
    let mut sampler = rng(9);
    let levels = [0.0, 1e-6, 1.0, 1e6];
    let mut rays = awkward_rays([5, 5, 5]);
    rays.extend((0..50).map(|_| ray(&mut sampler)));
    for i in 0..64 {
        let [a, b, c] = [i % 4, i / 4 % 4, i / 16].map(|i| levels[i]);
        let thin = coefficients(Rgb::new(a, b, c), Rgb::new(c, a, b), Rgb::new(a, b, c));
        let haze = Atmosphere::new(BOUNDS.center(), Vec3::Z, 1e-3 + a, thin, forward()).unwrap();
        let ball: Arc<dyn Field<f32>> = Arc::new(Procedural::new(BOUNDS, 1.0, |_| 1.0).unwrap());
        let grey = coefficients(Rgb::splat(a), Rgb::splat(b), Rgb::splat(c));
        let ball = GridMedium::new(ball, grey, Phase::Isotropic).unwrap();
        let parts = vec![
            AnyMedium::Field(Arc::new(ball)),
            fog(thin, Phase::Isotropic),
            AnyMedium::Atmosphere(haze),
        ];
        let overlap = AnyMedium::Overlap(Overlap::new(parts).unwrap());
        for ray in &rays {
            check_finite(&overlap, ray, &mut sampler);
        }
    }
}

fn check_finite(medium: &AnyMedium<Rgb>, ray: &Ray, sampler: &mut impl Sampler) {
    for importance in [Rgb::default(), Rgb::splat(1.0), Rgb::new(1e-38, 0.0, 1e38)] {
        let flight = medium.sample_free_flight(ray, importance, sampler);
        assert!(
            flight.weight.is_finite(),
            "{ray:?}, {importance:?}: {flight:?}"
        );
        let t = flight.collision.map_or(0.0, |collision| collision.t);
        assert!(
            t.is_finite() && (0.0..=ray.t_max).contains(&t),
            "{ray:?}: {flight:?}"
        );
        let pdf_t = medium.pdf_free_flight(ray, t, importance);
        let passing = medium.pmf_passing(ray, importance);
        assert!(pdf_t.is_finite() && pdf_t >= 0.0, "{ray:?}, {t}: {pdf_t}");
        assert!((0.0..=1.000_001).contains(&passing), "{ray:?}: {passing}");
        let phase = medium.phase(ray.at(t.min(1.0)));
        let sample = phase.sample(-ray.direction, sampler.next());
        assert!(
            sample.pdf_w.is_finite() && sample.wi.is_normalized(),
            "{sample:?}"
        );
    }
    let transmittance = medium.transmittance(ray, sampler);
    let emitted = medium.emitted(ray, sampler);
    assert!(
        transmittance.is_finite() && !emitted.max_channel().is_nan(),
        "{emitted:?}"
    );
}

#[test]
fn wrong_media_are_named() {
    assert_eq!(
        Overlap::<f32>::new(Vec::new()).unwrap_err(),
        MediumError::NoMedia
    );
    let huge = fog(coefficients(2e38_f32, 0.0, 0.0), Phase::Isotropic);
    let error = Overlap::new(vec![huge.clone(), huge]).unwrap_err();
    assert!(
        matches!(
            error,
            MediumError::Coefficient {
                field: "sigma_a",
                ..
            }
        ),
        "{error}"
    );
}
