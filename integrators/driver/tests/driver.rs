//! Streams, film, budgets. False alarms: 1e-3 a statistical test, fixed seeds.

#[path = "support/blank.rs"]
mod blank;

use blank::Blank;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tyndall_core::{
    Domain, Integrator, PassContext, PassError, Rgb, Sampler, SensorRay, Spectrum, Splat, Streams,
};
use tyndall_driver::{Budget, Film, PassStreams, Render, RenderError};
use tyndall_testkit::stats::{kolmogorov_smirnov, sidak};

/// Random numbers, a splat in every corner, and a defect now and then.
#[derive(Default)]
struct Noise {
    splats: Vec<Splat<Rgb>>,
    defects: bool,
    cancel_in_pass: Option<u64>,
    cancelled: AtomicBool,
}

impl Integrator<Blank> for Noise {
    type Pass = (u64, Vec<Splat<Rgb>>);
    type Pixel = u64;

    fn begin_pass<R: Streams>(
        &self,
        _: &Blank,
        cx: &PassContext<'_, R>,
        previous: Option<Self::Pass>,
    ) -> Result<Self::Pass, PassError> {
        assert_eq!(
            previous.map(|p| p.0 + 1),
            cx.pass.checked_sub(1).map(|p| p + 1)
        );
        if self.cancel_in_pass == Some(cx.pass) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        Ok((cx.pass, self.splats.clone()))
    }

    fn estimate(
        &self,
        _: &Blank,
        pass: &Self::Pass,
        pixel: &mut u64,
        _: &SensorRay<Rgb>,
        sampler: &mut impl Sampler,
    ) -> Rgb {
        assert_eq!(*pixel, pass.0, "a pixel remembers every pass");
        *pixel += 1;
        let [r, g, b] = sampler.next();
        let defect = self.defects && r < 0.1;
        Rgb::new(r, g, if defect { f32::NAN } else { b })
    }

    fn splats<'p>(&self, pass: &'p Self::Pass) -> &'p [Splat<Rgb>] {
        &pass.1
    }
}

/// No light at all.
struct Black;

impl Integrator<Blank> for Black {
    type Pass = ();
    type Pixel = ();

    fn begin_pass<R: Streams>(
        &self,
        _: &Blank,
        _: &PassContext<'_, R>,
        _: Option<()>,
    ) -> Result<(), PassError> {
        Ok(())
    }

    fn estimate(
        &self,
        _: &Blank,
        (): &(),
        (): &mut (),
        _: &SensorRay<Rgb>,
        _: &mut impl Sampler,
    ) -> Rgb {
        Rgb::default()
    }
}

fn run(host: &Blank, noise: &Noise, budget: Budget) -> Result<Film<Rgb>, RenderError> {
    Render::new(host, noise)
        .seed(5)
        .cancelled_by(&noise.cancelled)
        .run(budget, |_| {})
}

#[test]
fn the_film_is_the_same_to_the_bit_on_any_number_of_threads() {
    let render = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool")
            .install(|| run(&Blank([37, 41]), &Noise::default(), Budget::Passes(5)))
            .expect("a film")
    };
    let one = render(1);
    assert!(one == render(2) && one == render(7));
}

#[test]
fn the_mean_is_weighted_by_the_sensor_and_its_variance_is_that_of_the_samples() {
    let passes = 400;
    let film = run(&Blank([20, 3]), &Noise::default(), Budget::Passes(passes)).expect("a film");
    assert_eq!((film.passes(), film.resolution()), (passes, [20, 3]));
    // A uniform number times w: mean w/2, variance w²/12. 60 pixels of a channel in one test each.
    for (channel, weight) in [1.0, 2.0, 0.5].into_iter().enumerate() {
        let of_channel = || film.mean().iter().skip(channel).step_by(3);
        let mean = of_channel().sum::<f64>() / 60.0;
        let error = weight / (12.0 * 60.0 * passes as f64).sqrt();
        assert!((mean - 0.5 * weight).abs() < 3.9 * error, "{mean}"); // 1e-4 a channel
        let variance = film
            .variance_of_mean()
            .skip(channel)
            .step_by(3)
            .sum::<f64>()
            / 60.0;
        let expected = weight * weight / 12.0 / passes as f64;
        // The variance of a sample variance of n uniform numbers is 0.8/n of its square.
        let spread = (0.8 / (60.0 * passes as f64)).sqrt();
        assert!(
            (variance / expected - 1.0).abs() < 3.9 * spread,
            "{variance}"
        );
    }
}

#[test]
fn splats_land_in_their_pixels_and_beside_the_film_nowhere() {
    let value = Rgb::new(100.0, 0.0, 0.0);
    let at = |x, y| Splat {
        raster: [x, y],
        value,
    };
    let noise = Noise {
        splats: vec![
            at(0.0, 0.0),
            at(36.9, 0.5),
            at(20.5, 17.5),
            at(36.9999, 40.9999),
            at(37.0, 0.0),
            at(-0.1, 3.0),
            at(f32::NAN, 3.0),
            Splat {
                raster: [5.0, 5.0],
                value: Rgb::splat(f32::INFINITY),
            },
        ],
        ..Noise::default()
    };
    let film = run(&Blank([37, 41]), &noise, Budget::Passes(3)).expect("a film");
    let hit: HashSet<usize> = (0..37 * 41)
        .filter(|i| film.mean()[3 * i] >= 100.0)
        .collect();
    assert_eq!(hit, HashSet::from([0, 36, 17 * 37 + 20, 40 * 37 + 36]));
    assert_eq!(film.non_finite(), 3, "one splat in each of three passes");
}

#[test]
fn defects_are_counted_and_do_not_spread() {
    let noise = Noise {
        defects: true,
        ..Noise::default()
    };
    let film = run(&Blank([64, 64]), &noise, Budget::Passes(10)).expect("a film");
    let share = film.non_finite() as f64 / (64.0 * 64.0 * 10.0);
    let error = (0.1 * 0.9 / (64.0_f64 * 64.0 * 10.0)).sqrt();
    assert!((share - 0.1).abs() < 3.3 * error, "{share}"); // 1e-3
    assert!(film.mean().iter().all(|v| v.is_finite()));
}

#[test]
fn budgets_are_kept() {
    let (host, noise) = (Blank([8, 8]), Noise::default());
    let film = run(&host, &noise, Budget::RelativeError(0.02)).expect("a film");
    assert!(film.passes() >= Budget::FEWEST_FOR_ERROR && film.relative_error() <= 0.02);
    let start = std::time::Instant::now();
    run(&host, &noise, Budget::Time(Duration::from_millis(20))).expect("a film");
    assert!(start.elapsed() >= Duration::from_millis(20));
    let black = Render::new(&host, &Black)
        .run(Budget::RelativeError(0.1), |_| {})
        .expect("a film");
    assert_eq!(
        black.passes(),
        Budget::FEWEST_FOR_ERROR,
        "an image without light ends"
    );
    for nothing in [
        Budget::Passes(0),
        Budget::Time(Duration::ZERO),
        Budget::RelativeError(f64::NAN),
    ] {
        assert_eq!(run(&host, &noise, nothing), Err(RenderError::EmptyBudget));
    }
    let nowhere = run(&Blank([0, 8]), &noise, Budget::Passes(1));
    assert_eq!(nowhere, Err(RenderError::EmptySensor));
}

#[test]
fn a_cancelled_pass_is_dropped_whole_but_the_first_is_kept() {
    for (cancel_in_pass, passes) in [(0, 1), (1, 1), (3, 3)] {
        let noise = Noise {
            cancel_in_pass: Some(cancel_in_pass),
            ..Noise::default()
        };
        let film = run(&Blank([40, 40]), &noise, Budget::Passes(9)).expect("a film");
        assert_eq!(film.passes(), passes);
    }
}

#[test]
fn streams_of_different_names_are_independent() {
    let mut firsts = HashSet::new();
    let mut numbers = Vec::new();
    for seed in 0..8 {
        for pass in 0..8 {
            let streams = PassStreams::new(seed, pass);
            for domain in [Domain::SENSOR, Domain::LIGHT, Domain::STRUCTURE] {
                for index in 0..64 {
                    let mut sampler = streams.sampler(domain, index);
                    let name: [f32; 4] = sampler.next();
                    firsts.insert(name.map(f32::to_bits));
                    numbers.extend(name.map(f64::from));
                }
            }
        }
    }
    assert_eq!(firsts.len(), 8 * 8 * 3 * 64);
    let false_alarm = sidak(1e-3, 2);
    kolmogorov_smirnov(&mut numbers.clone(), |x| x, false_alarm).expect("uniform");
    // The first numbers of neighbouring streams must not follow each other.
    let mut steps: Vec<f64> = numbers
        .chunks_exact(8)
        .map(|pair| (pair[4] - pair[0]).rem_euclid(1.0))
        .collect();
    kolmogorov_smirnov(&mut steps, |x| x, false_alarm).expect("uniform steps");
}
