//! Photon beams. Statistical tests have fixed seeds and fail a right integrator with probability
//! [`FALSE_ALARM`] each.

mod agreement;

use std::sync::atomic::AtomicBool;
use tyndall_core::{Coefficients, Integrator, PassContext, Sampler, Sensor, Spectrum};
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Estimate, Moments};

const FALSE_ALARM: f64 = 1e-4;

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
        let [width, height] = host.resolution();
        for pass in 0..self.passes {
            let (streams, running) = (PassStreams::new(self.seed, pass), AtomicBool::new(false));
            let cx = PassContext::new(pass, &streams, &running);
            let prepared = integrator.begin_pass(host, &cx, None).expect("a pass");
            let mut sampler = rng(self.seed << 32 | pass);
            let mut sum = H::Spectrum::default();
            for y in 0..height {
                for x in 0..width {
                    for _ in 0..self.samples {
                        let ray = host.sensor_ray([x, y], sampler.next());
                        let pixel = &mut Default::default();
                        let found = Integrator::estimate(
                            integrator,
                            host,
                            &prepared,
                            pixel,
                            &ray,
                            &mut sampler,
                        );
                        assert!(found.is_finite(), "{found:?} along {ray:?}");
                        sum += found * ray.weight;
                    }
                }
            }
            let mean = sum / (width * height * self.samples) as f32;
            for (c, moments) in moments.iter_mut().enumerate() {
                moments.push(f64::from(mean.channel(c)));
            }
        }
        moments.iter().map(Moments::estimate).collect()
    }
}

fn fog<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    let phase = match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).expect("a valid mean cosine"),
    };
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}
