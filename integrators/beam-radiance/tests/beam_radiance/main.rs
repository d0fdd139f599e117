//! The beam radiance estimate. Statistical tests have fixed seeds and fail a right integrator with
//! probability [`FALSE_ALARM`] each.

mod closed_form;
mod conformance;
mod extremes;
mod heterogeneous;
mod progressive;
mod surfaces;

use std::sync::atomic::AtomicBool;
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{
    Coefficients, HostTypes, Integrator, PassContext, Sampler, Sensor, SensorRay, Spectrum,
};
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_testkit::stats::{Estimate, Moments, check_means};
use tyndall_testkit::{TestSampler, rng};

const FALSE_ALARM: f64 = 1e-4;

/// How long a test may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tier {
    /// With every change: it sees what is lost or counted twice.
    Short,
    /// By hand: standard errors of 1 % at the most.
    Long,
}

impl Tier {
    fn passes(self, [short, long]: [u64; 2]) -> u64 {
        match self {
            Self::Short => short,
            Self::Long => long,
        }
    }

    /// The relative standard error that is asked for.
    fn precision(self, short: f64) -> f64 {
        match self {
            Self::Short => short,
            Self::Long => 0.01,
        }
    }
}

/// A short test and a long one of each of these functions of a tier.
macro_rules! in_both_tiers {
    ($($name:ident),+ $(,)?) => {
        mod in_short {
            $(
                #[test]
                fn $name() {
                    super::$name($crate::Tier::Short);
                }
            )+
        }

        mod in_detail {
            $(
                #[test]
                #[ignore = "long: cargo test -p tyndall-beam-radiance in_detail -- --ignored"]
                fn $name() {
                    super::$name($crate::Tier::Long);
                }
            )+
        }
    };
}
use in_both_tiers;

/// What an integrator sees of a host: its passes, and in each so many samples a pixel.
#[derive(Clone, Copy)]
struct Run {
    passes: u64,
    samples: u32,
    seed: u64,
}

impl Run {
    /// The mean over all pixels, per channel. What is independent is a pass: its samples share
    /// their photons.
    fn measure<H: Sensor, I: Integrator<H>>(self, host: &H, integrator: &I) -> Vec<Estimate> {
        let mut moments = vec![Moments::new(); H::Spectrum::CHANNELS];
        for pass in 0..self.passes {
            let mean = self.image(host, integrator, pass);
            for (c, moments) in moments.iter_mut().enumerate() {
                let sum: f64 = mean.iter().map(|s| f64::from(s.channel(c))).sum();
                moments.push(sum / mean.len() as f64);
            }
        }
        moments.iter().map(Moments::estimate).collect()
    }

    /// The pixels of one pass.
    fn image<H: Sensor, I: Integrator<H>>(
        self,
        host: &H,
        integrator: &I,
        pass: u64,
    ) -> Vec<H::Spectrum> {
        let [width, height] = host.resolution();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        self.pass(host, integrator, pass, |estimate, sampler| {
            let pixel = |px| {
                let sample = |_| {
                    let ray = host.sensor_ray(px, sampler.next());
                    estimate(&ray, sampler) * ray.weight
                };
                let sum: H::Spectrum = (0..self.samples).map(sample).sum();
                sum / self.samples as f32
            };
            pixels.map(pixel).collect()
        })
    }

    /// What `look` makes of one pass.
    fn pass<H: Sensor, I: Integrator<H>, T>(
        self,
        host: &H,
        integrator: &I,
        pass: u64,
        look: impl FnOnce(&Estimator<'_, H>, &mut TestSampler) -> T,
    ) -> T {
        let (streams, running) = (PassStreams::new(self.seed, pass), AtomicBool::new(false));
        let cx = PassContext::new(pass, &streams, &running);
        let prepared = integrator.begin_pass(host, &cx, None).expect("a pass");
        let mut sampler = rng(self.seed << 32 | pass);
        let estimate = |ray: &SensorRay<H::Spectrum>, sampler: &mut TestSampler| {
            let radiance =
                integrator.estimate(host, &prepared, &mut Default::default(), ray, sampler);
            assert!(radiance.is_finite(), "{radiance:?} along {ray:?}");
            radiance
        };
        look(&estimate, &mut sampler)
    }
}

/// The radiance along a ray.
type Estimator<'a, H> = dyn Fn(&SensorRay<<H as HostTypes>::Spectrum>, &mut TestSampler) -> <H as HostTypes>::Spectrum
    + 'a;

/// Radii that do not shrink: what is expected is known.
fn fixed(radius: f32) -> BeamRadiance {
    BeamRadiance::new().radius(radius).alpha(1.0)
}

fn fog<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    Homogeneous::new(coefficients, phase(g)).expect("valid coefficients")
}

fn phase(g: f32) -> Phase {
    match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).expect("a valid mean cosine"),
    }
}

/// Named figures, all tested together.
#[derive(Default)]
struct Figures(Vec<(String, Estimate, f64)>);

impl Figures {
    /// Of a relative standard error no larger than `precision`, or it would test nothing.
    #[track_caller]
    fn add(&mut self, name: impl Into<String>, estimate: Estimate, expected: f64, precision: f64) {
        let name = name.into();
        let found = estimate.relative_standard_error();
        assert!(found <= precision, "{name}: {found:.4} is too noisy");
        self.0.push((name, estimate, expected));
    }

    /// Two estimates of one thing.
    #[track_caller]
    fn same(&mut self, name: impl Into<String>, a: Estimate, b: Estimate, precision: f64) {
        let name = name.into();
        for found in [a, b].map(|e| e.relative_standard_error()) {
            assert!(found <= precision, "{name}: {found:.4} is too noisy");
        }
        self.0
            .push((format!("{name}: {a:?} − {b:?}"), a.difference(&b), 0.0));
    }

    #[track_caller]
    fn check(self) {
        let cases: Vec<_> = self
            .0
            .iter()
            .map(|(n, e, x)| (n.as_str(), *e, *x))
            .collect();
        check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
    }
}

/// An estimate, times a factor.
fn scaled(estimate: Estimate, factor: f64) -> Estimate {
    Estimate {
        mean: factor * estimate.mean,
        standard_error: factor.abs() * estimate.standard_error,
        ..estimate
    }
}

/// What is left of two estimates, one of them at twice the radius, without a bias ∝ r^`order`.
fn extrapolated(small: Estimate, large: Estimate, order: i32) -> Estimate {
    let ratio = 2.0_f64.powi(order);
    let share = 1.0 / (ratio - 1.0);
    scaled(small, ratio * share).difference(&scaled(large, share))
}
