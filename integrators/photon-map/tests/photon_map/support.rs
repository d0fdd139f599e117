//! What the tests share.

use glam::Vec3;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use tyndall_core::{
    Coefficients, Frame, Integrator, MediumId, PassContext, Ray, Sampler, Sensor, SensorRay,
    Spectrum, warp,
};
use tyndall_density::Kernel;
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Estimate, Moments, check_means};

pub(crate) const KERNELS: [Kernel; 5] = [
    Kernel::Constant,
    Kernel::Epanechnikov,
    Kernel::Biweight,
    Kernel::Cone,
    Kernel::Gaussian,
];

pub(crate) fn medium<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    Homogeneous::new(coefficients, phase(g)).expect("valid coefficients")
}

pub(crate) fn phase(g: f32) -> Phase {
    match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).expect("a valid mean cosine"),
    }
}

/// What each integrator estimates, by channel: all on the same photons, with `rays` rays a pass. A
/// map is one sample, however many rays look at it.
pub(crate) fn estimate<H, I>(
    host: &H,
    integrators: &[I],
    passes: u64,
    rays: u32,
    mut ray: impl FnMut(&mut dyn FnMut() -> f32) -> SensorRay<H::Spectrum>,
) -> Vec<Vec<Estimate>>
where
    H: Sensor,
    I: Integrator<H, Pixel = ()>,
{
    let channels = H::Spectrum::CHANNELS;
    let mut moments = vec![vec![Moments::new(); channels]; integrators.len()];
    for_passes(host, integrators, passes, rays, &mut ray, |means| {
        for (moments, means) in moments.iter_mut().zip(means) {
            for (moments, mean) in moments.iter_mut().zip(means) {
                moments.push(*mean);
            }
        }
    });
    let estimates = |m: Vec<Moments>| m.iter().map(Moments::estimate).collect();
    moments.into_iter().map(estimates).collect()
}

/// As [`estimate`], of an error ∝ r: what two integrators, the second of twice the radius of the
/// first, say of the radius 0.
pub(crate) fn extrapolate<H, I>(
    host: &H,
    integrators: &[I; 2],
    passes: u64,
    rays: u32,
    mut ray: impl FnMut(&mut dyn FnMut() -> f32) -> SensorRay<H::Spectrum>,
) -> Vec<Estimate>
where
    H: Sensor,
    I: Integrator<H, Pixel = ()>,
{
    let mut moments = vec![Moments::new(); H::Spectrum::CHANNELS];
    for_passes(host, integrators, passes, rays, &mut ray, |means| {
        for (channel, moments) in moments.iter_mut().enumerate() {
            moments.push(2.0 * means[0][channel] - means[1][channel]);
        }
    });
    moments.iter().map(Moments::estimate).collect()
}

/// Calls `then` with the mean of the rays of each pass, by integrator and channel.
fn for_passes<H, I>(
    host: &H,
    integrators: &[I],
    passes: u64,
    rays: u32,
    ray: &mut impl FnMut(&mut dyn FnMut() -> f32) -> SensorRay<H::Spectrum>,
    mut then: impl FnMut(&[Vec<f64>]),
) where
    H: Sensor,
    I: Integrator<H, Pixel = ()>,
{
    for pass in 0..passes {
        let mean = |integrator: &I| {
            let maps = with_context(pass, |cx| integrator.begin_pass(host, cx, None));
            let maps = maps.expect("photons");
            let mut sampler = rng(pass + 1);
            let mut mean = vec![0.0; H::Spectrum::CHANNELS];
            for _ in 0..rays {
                let ray = ray(&mut || sampler.next_1d());
                let radiance = integrator.estimate(host, &maps, &mut (), &ray, &mut sampler);
                for (channel, mean) in mean.iter_mut().enumerate() {
                    *mean += f64::from((ray.weight * radiance).channel(channel)) / f64::from(rays);
                }
            }
            mean
        };
        then(&integrators.iter().map(mean).collect::<Vec<_>>());
    }
}

/// The difference of two estimates, moved to where the second is expected.
pub(crate) fn moved(a: Estimate, b: Estimate, to: f64) -> Estimate {
    let difference = a.difference(&b);
    Estimate {
        mean: difference.mean + to,
        ..difference
    }
}

/// A ray through space, turned to a random side: it starts at (`x`, 0, `z`) and looked along z.
pub(crate) fn turned<S: Spectrum>(
    x: f32,
    z: f32,
    medium: MediumId,
    u: &mut dyn FnMut() -> f32,
) -> SensorRay<S> {
    let direction = warp::uniform_sphere([u(), u()]);
    let beside = Frame::around(direction).to_world(Vec3::X);
    SensorRay::new(Ray::new(x * beside + z * direction, direction), medium)
}

/// The rays of the sensor's first pixel.
pub(crate) fn sensor<H: Sensor>(
    host: &H,
) -> impl FnMut(&mut dyn FnMut() -> f32) -> SensorRay<H::Spectrum> {
    |u| host.sensor_ray([0, 0], [u(), u(), u(), u()])
}

/// Named figures, all tested together: t-tests at 0.27 %, Šidák-corrected, and none less precise
/// than asked for.
pub(crate) struct Figures {
    precision: f64,
    figures: Vec<(String, Estimate, f64)>,
}

impl Figures {
    pub(crate) fn within(precision: f64) -> Self {
        Self {
            precision,
            figures: Vec::new(),
        }
    }

    pub(crate) fn add(&mut self, name: impl Into<String>, estimate: Estimate, expected: f64) {
        self.figures.push((name.into(), estimate, expected));
    }

    /// The figures of the channels.
    pub(crate) fn add_channels(
        &mut self,
        name: &str,
        estimates: &[Estimate],
        expected: impl Fn(usize) -> f64,
    ) {
        for (channel, estimate) in estimates.iter().enumerate() {
            let name = format!("{name}, channel {channel}");
            self.add(name, *estimate, expected(channel));
        }
    }

    pub(crate) fn check(self) {
        let cases: Vec<_> = self
            .figures
            .iter()
            .map(|(name, estimate, expected)| (name.as_str(), *estimate, *expected))
            .collect();
        if let Err(why) = check_means(&cases, 0.0027) {
            panic!("{why}");
        }
        for (name, estimate, expected) in cases {
            let error = estimate.standard_error / expected.abs();
            assert!(error <= self.precision, "{name}: {error:.4} is too noisy");
        }
    }
}

/// ∫ f over \[a, b\] by the midpoint rule.
pub(crate) fn integrate(a: f64, b: f64, points: u32, f: impl Fn(f64) -> f64) -> f64 {
    let step = (b - a) / f64::from(points);
    let middles = (0..points).map(|i| a + (f64::from(i) + 0.5) * step);
    step * middles.map(f).sum::<f64>()
}

/// f over \[a, b\] from a table, linear between its `cells` + 1 points: for what is slow.
pub(crate) fn tabulated(a: f64, b: f64, cells: u32, f: impl Fn(f64) -> f64) -> impl Fn(f64) -> f64 {
    let step = (b - a) / f64::from(cells);
    let table: Vec<f64> = (0..=cells).map(|i| f(a + f64::from(i) * step)).collect();
    move |x| {
        let place = ((x - a) / step).clamp(0.0, f64::from(cells) * (1.0 - 1e-9));
        let (i, part) = (place as usize, place.fract());
        table[i] + part * (table[i + 1] - table[i])
    }
}

/// The mean of f(distance) over a kernel of so many dimensions, which are 2 or 3.
pub(crate) fn kernel_mean(
    kernel: Kernel,
    radius: f64,
    dimensions: u8,
    f: impl Fn(f64) -> f64,
) -> f64 {
    integrate(0.0, radius, 200, |distance| {
        let (squared, radius) = ((distance * distance) as f32, radius as f32);
        let density = match dimensions {
            2 => 2.0 * PI * distance * f64::from(kernel.weight_2d(squared, radius)),
            _ => 4.0 * PI * distance * distance * f64::from(kernel.weight_3d(squared, radius)),
        };
        density * f(distance)
    })
}

/// The mean of f, a function of the distance from the origin and 0 beyond `end`, over the kernel's
/// ball around a point at `distance` from the origin.
pub(crate) fn blurred(
    kernel: Kernel,
    radius: f64,
    distance: f64,
    end: f64,
    f: impl Fn(f64) -> f64,
) -> f64 {
    let within = |x| if x < end { f(x) } else { 0.0 };
    kernel_mean(kernel, radius, 3, |rho| {
        if distance * rho < 1e-9 {
            return within(distance.max(rho));
        }
        // Over a shell, uniform in μ: R² = d² + ρ² + 2 d ρ μ, dμ = R dR/(d ρ).
        let (near, far) = ((distance - rho).abs(), (distance + rho).min(end));
        if near >= far {
            return 0.0;
        }
        integrate(near, far, 24, |x| x * f(x)) / (2.0 * distance * rho)
    })
}

/// A context for one pass.
pub(crate) fn with_context<T>(
    pass: u64,
    then: impl FnOnce(&PassContext<'_, PassStreams>) -> T,
) -> T {
    let (streams, cancelled) = (PassStreams::new(3, pass), AtomicBool::new(false));
    then(&PassContext::new(pass, &streams, &cancelled))
}
