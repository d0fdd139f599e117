//! Gathering along whole rays against marching along them, on the same photons: error against time.
//!
//!     cargo run --example beams_against_marching -p tyndall-beam-radiance
//!
//! A point light in fog, seen along rays that are long against the distance from the light: the
//! paper's case for beams (Jarosz et al. 2008). The fog scatters so rarely that the airlight in
//! closed form is the truth. Times are of one core; errors are relative, root of the mean square over
//! rays and maps.
#![allow(clippy::print_stdout)]

use glam::Vec3;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use tyndall_beam_radiance::{BeamRadiance, Blur};
use tyndall_core::{Coefficients, Integrator, PassContext, Ray, Sampler, Sensor};
use tyndall_density::{Dimension, Kernel};
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_photons::{Emission, Gather, Neighbours, PhotonMaps, Search};
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::rng;
use tyndall_walk::ByPhotons;

type Host = AnalyticHost<Homogeneous<f32>>;

const PATHS: u64 = 30_000;
const MAPS: u64 = 4;
const SIGMA_T: f32 = 0.5;
const SIGMA_S: f32 = SIGMA_T * 1e-4;
/// Where rays start before the light, and where marching ends.
const BEFORE: f32 = 10.0;
const END: f32 = 40.0;
const RAYS: usize = 64;

/// Distance of a ray from the light.
fn height(ray: usize) -> f32 {
    0.3 + 1.2 * ray as f32 / RAYS as f32
}

fn host() -> Host {
    let coefficients = Coefficients {
        sigma_a: SIGMA_T - SIGMA_S,
        sigma_s: SIGMA_S,
        emission: 0.0,
    };
    let fog = Homogeneous::new(coefficients, Phase::Isotropic).expect("valid coefficients");
    let around = |i: usize| {
        let (sin, cos) = (i as f32 * 2.4).sin_cos();
        Ray::new(height(i) * Vec3::new(0.0, sin, cos), Vec3::X)
    };
    let view = View::Rays((0..RAYS).map(around).collect());
    AnalyticHost::infinite_medium(fog, BEFORE * Vec3::X, 1.0, view)
}

fn truth(ray: usize) -> f64 {
    airlight(
        SIGMA_S.into(),
        SIGMA_T.into(),
        height(ray).into(),
        BEFORE.into(),
        f64::INFINITY,
    )
}

/// Sums over rays: seconds, and squared relative errors.
#[derive(Clone, Copy, Default)]
struct Sums {
    seconds: f64,
    squares: f64,
}

impl Sums {
    fn add(&mut self, mut estimate: impl FnMut(usize) -> f32) {
        let start = Instant::now();
        let values: Vec<f32> = (0..RAYS).map(&mut estimate).collect();
        self.seconds += start.elapsed().as_secs_f64();
        for (ray, value) in values.into_iter().enumerate() {
            self.squares += (f64::from(value) / truth(ray) - 1.0).powi(2);
        }
    }

    fn print(self, name: &str) {
        let rays = (MAPS as usize * RAYS) as f64;
        println!(
            "{name:<28} {:>10.1} µs a ray {:>8.2} % error",
            1e6 * self.seconds / rays,
            100.0 * (self.squares / rays).sqrt()
        );
    }
}

/// Marches in even steps, jittered.
fn march(
    maps: &PhotonMaps<f32>,
    host: &Host,
    ray: &Ray,
    (gather, steps): (&mut Gather, u32),
    sampler: &mut impl Sampler,
) -> f32 {
    let step = END / steps as f32;
    let shift = sampler.next_1d();
    let [(_, photons)] = &maps.volume[..] else {
        panic!("one medium");
    };
    let at = |i: u32| {
        let t = (i as f32 + shift) * step;
        let (p, wo) = (ray.at(t), -ray.direction);
        let gathered = gather.medium(photons, p, wo, &host.medium);
        gathered.radiance * (-SIGMA_T * t).exp() * step
    };
    (0..steps).map(at).sum()
}

fn main() {
    let host = host();
    let steps: Vec<u32> = (4..=11).map(|i| 1 << i).collect();
    let mut marched = vec![[Sums::default(); 2]; steps.len()];
    let beams = [
        ("discs", BeamRadiance::new()),
        ("balls", BeamRadiance::new().blur(Blur::Ball)),
    ];
    let mut beam_sums = [Sums::default(); 2];
    for seed in 0..MAPS {
        let (streams, running) = (PassStreams::new(seed, 0), AtomicBool::new(false));
        let cx = PassContext::new(0, &streams, &running);
        let mut sampler = rng(seed);
        let mut ray = |i: usize| host.sensor_ray([i as u32, 0], sampler.next());
        let rays: Vec<_> = (0..RAYS).map(&mut ray).collect();
        for ((_, method), sums) in beams.iter().zip(&mut beam_sums) {
            let method = method.paths(PATHS);
            let pass = method.begin_pass(&host, &cx, None).expect("a pass");
            sums.add(|i| method.estimate(&host, &pass, &mut (), &rays[i], &mut sampler));
        }
        let emission = Emission {
            paths: PATHS,
            ..Emission::default()
        };
        let maps = PhotonMaps::trace::<_, ByPhotons, _>(&host, &cx, emission).expect("photons");
        for (&steps, sums) in steps.iter().zip(&mut marched) {
            for (photons, sums) in [30.0, 100.0].into_iter().zip(sums) {
                let search = Search::Nearest(Neighbours {
                    photons,
                    dimension: Dimension::Three,
                    max_radius: f32::INFINITY,
                });
                let mut gather = Gather::new(search, Kernel::Epanechnikov);
                let mut one = |i: usize| {
                    march(
                        &maps,
                        &host,
                        &rays[i].ray,
                        (&mut gather, steps),
                        &mut sampler,
                    )
                };
                sums.add(&mut one);
            }
        }
    }
    println!("{PATHS} light paths, {RAYS} rays, {MAPS} maps");
    for ((name, _), sums) in beams.iter().zip(beam_sums) {
        sums.print(&format!("beams, {name}"));
    }
    for (steps, sums) in steps.iter().zip(marched) {
        for (count, sums) in [30, 100].into_iter().zip(sums) {
            sums.print(&format!("{steps} steps, {count} nearest"));
        }
    }
}
