//! Progressive photon mapping against closed forms, the path tracer and itself.
//!
//! False alarms: 0.27 % a test (three standard errors of a normal distribution), Šidák-corrected
//! within it, unless a test says otherwise; the seeds are fixed. What a test allows for bias is
//! derived where it is used.

mod closed_form;
mod conformance;
mod extremes;
mod paths;
mod slope;
mod state;
mod statistics;

use glam::Vec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tyndall_core::{AnyIntegrator, Coefficients, Ray, Sensor, Spectrum};
use tyndall_driver::{Budget, PassStreams, Render};
use tyndall_media::{Homogeneous, Phase};
use tyndall_testkit::stats::{Estimate, Moments};

const FALSE_ALARM: f64 = 0.0027;

fn fog<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let phase = match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).expect("a valid mean cosine"),
    };
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}

/// Rays from `origin`, spread evenly over the sphere by Fibonacci's spiral.
fn sphere_of_rays(origin: Vec3, count: usize) -> Vec<Ray> {
    let golden = std::f32::consts::PI * (3.0 - 5.0f32.sqrt());
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
            let (sin, cos) = (golden * i as f32).sin_cos();
            let r = (1.0 - z * z).sqrt();
            Ray::new(origin, Vec3::new(r * cos, r * sin, z).normalize())
        })
        .collect()
}

/// Every value of the film after `passes` passes, on this thread alone.
fn render<H: Sensor>(
    host: &H,
    integrator: &dyn AnyIntegrator<H, PassStreams>,
    passes: u64,
    seed: u64,
) -> Vec<f64> {
    let film = alone().install(|| {
        Render::new(host, integrator)
            .seed(seed)
            .run(Budget::Passes(passes), |_| {})
    });
    let film = film.expect("the render succeeds");
    assert_eq!(film.non_finite(), 0, "samples are not finite");
    film.mean().to_vec()
}

fn alone() -> ThreadPool {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a pool of one thread")
}

/// The mean over pixels per channel, of independent renders: pixels share photons, seeds share
/// nothing.
fn measure<H: Sensor>(
    host: &H,
    integrator: &dyn AnyIntegrator<H, PassStreams>,
    passes: u64,
    seeds: std::ops::Range<u64>,
) -> Vec<Estimate> {
    let channels = H::Spectrum::CHANNELS;
    let mut moments = vec![Moments::new(); channels];
    for seed in seeds {
        let film = render(host, integrator, passes, seed);
        let pixels = (film.len() / channels) as f64;
        for (channel, moments) in moments.iter_mut().enumerate() {
            let sum: f64 = film.iter().skip(channel).step_by(channels).sum();
            moments.push(sum / pixels);
        }
    }
    moments.iter().map(Moments::estimate).collect()
}
