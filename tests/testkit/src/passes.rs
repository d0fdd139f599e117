//! Integrators whose samples of a pass share what it prepared: photons, beams, virtual lights.

use crate::stats::{Estimate, Moments};
use crate::{TestSampler, rng};
use std::sync::atomic::AtomicBool;
use tyndall_core::{HostTypes, Integrator, PassContext, Sampler, Sensor, SensorRay, Spectrum};
use tyndall_driver::PassStreams;

/// What an integrator sees of a host: its passes, and in each so many samples a pixel.
///
/// Without a driver, on the thread of the test. What is independent is a pass, for its samples share
/// what it prepared: errors are those of the means of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The passes.
    pub passes: u64,
    /// Samples a pixel, in every pass.
    pub samples: u32,
    /// Methods that draw the same random numbers prepare the same from the same seed.
    pub seed: u64,
}

/// The radiance along a ray.
pub type RadianceAlong<'a, H> = dyn Fn(&SensorRay<<H as HostTypes>::Spectrum>, &mut TestSampler) -> <H as HostTypes>::Spectrum
    + 'a;

impl Run {
    /// The mean over all pixels, per channel.
    ///
    /// # Panics
    /// As [`Run::pass`].
    pub fn measure<H: Sensor, I: Integrator<H>>(self, host: &H, integrator: &I) -> Vec<Estimate> {
        let estimate = |channel: Vec<f64>| channel.into_iter().collect::<Moments>().estimate();
        let channels = self.means(host, integrator).into_iter();
        channels.map(estimate).collect()
    }

    /// The means over all pixels, pass by pass, per channel: of methods that share their photons,
    /// differences pass by pass have less noise than differences of means.
    ///
    /// # Panics
    /// As [`Run::pass`].
    pub fn means<H: Sensor, I: Integrator<H>>(self, host: &H, integrator: &I) -> Vec<Vec<f64>> {
        let mut means = vec![Vec::new(); H::Spectrum::CHANNELS];
        for pass in 0..self.passes {
            let image = self.image(host, integrator, pass);
            for (c, means) in means.iter_mut().enumerate() {
                let sum: f64 = image.iter().map(|s| f64::from(s.channel(c))).sum();
                means.push(sum / image.len() as f64);
            }
        }
        means
    }

    /// The pixels of one pass.
    ///
    /// # Panics
    /// As [`Run::pass`].
    pub fn image<H: Sensor, I: Integrator<H>>(
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
    ///
    /// # Panics
    /// If the integrator refuses the pass, or a sample is not finite.
    pub fn pass<H: Sensor, I: Integrator<H>, T>(
        self,
        host: &H,
        integrator: &I,
        pass: u64,
        look: impl FnOnce(&RadianceAlong<'_, H>, &mut TestSampler) -> T,
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
