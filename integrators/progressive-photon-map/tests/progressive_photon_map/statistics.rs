//! The statistics of pixels against the papers' own.

use crate::closed_form::floor;
use crate::{fog, render};
use glam::Vec3;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use tyndall_core::{
    Domain, Geometry, LightEmission, Media, Medium, PassContext, Ray, Sampler, Sensor, Shading,
    Streams,
};
use tyndall_density::{Kernel, SurfacePoint, in_scattered};
use tyndall_driver::PassStreams;
use tyndall_photons::{Emission, PhotonMaps};
use tyndall_progressive_photon_map::{Pixel, ProgressivePhotonMap, Radii};
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_walk::{ByPhotons, Event, Site, Vertex, Walk};

const PATHS: u64 = 300;
const STARTING_PATHS: u64 = 600;
const RADIUS: f64 = 0.3;
const ALPHA: f64 = 0.6;
const SEED: u64 = 5;

/// What one pass finds around the vertex of a walk of sight: the photons, and their flux times what
/// scatters it towards the sensor.
fn found<H>(host: &H, maps: &PhotonMaps<f32>, vertex: &Vertex<H>, radius: f64) -> (f64, f64)
where
    H: Geometry<Spectrum = f32> + Shading + Media,
{
    let (mut photons, mut flux) = (0.0, 0.0);
    let (center, radius) = (vertex.position, radius as f32);
    match &vertex.site {
        Site::Collision(coefficients) => {
            let medium = host.medium(vertex.medium).expect("a medium");
            let phase = medium.phase(center);
            let there = maps.in_medium(vertex.medium).expect("photons");
            for slot in 0..there.len() {
                let photon = there.get(slot);
                if photon.position.distance_squared(center) <= radius * radius {
                    let scattered = in_scattered(&phase, vertex.wo, photon.direction, photon.flux);
                    flux += f64::from(scattered / coefficients.sigma_t());
                    photons += 1.0;
                }
            }
        }
        Site::Surface(hit) => {
            let point = SurfacePoint::new(host, hit, vertex.wo);
            for map in [&maps.surfaces.caustic, &maps.surfaces.diffuse] {
                for slot in 0..map.len() {
                    let photon = map.get(slot);
                    let offset = photon.position - center;
                    if offset.length_squared() <= radius * radius && point.is_near(offset, radius) {
                        flux += f64::from(point.radiance(photon.direction, photon.flux));
                        photons += 1.0;
                    }
                }
            }
        }
    }
    (photons, flux)
}

/// Hachisuka & Jensen (2009), eq. 6–8, as they stand: with N photons kept and the flux τ, a pass that
/// finds M and φ within R makes N' = N + αM, R'ᵈ = Rᵈ (N + αM)/(N + M), τ' = (τ + φ) R'ᵈ/Rᵈ; after i
/// passes L = τ/(c Rᵈ i), the flux being divided by the light paths of its pass. The one deviation:
/// N begins as the starting paths would find it, not at 0.
fn paper<H>(host: &H, px: [u32; 2], passes: u64, dimension: i32) -> f64
where
    H: Geometry<Spectrum = f32> + Shading + Media + LightEmission + Sensor,
{
    let (mut radius, mut kept, mut tau) = (RADIUS, 0.0, 0.0);
    let cancelled = AtomicBool::new(false);
    let emission = Emission {
        paths: PATHS,
        ..Emission::default()
    };
    for pass in 0..passes {
        let streams = PassStreams::new(SEED, pass);
        let cx = PassContext::new(pass, &streams, &cancelled);
        let maps = PhotonMaps::trace::<H, ByPhotons, _>(host, &cx, emission).expect("photons");
        let index = px[1] * host.resolution()[0] + px[0];
        let mut sampler = streams.sampler(Domain::SENSOR, index.into());
        let mut walk = Walk::from_sensor(host, &host.sensor_ray(px, sampler.next()));
        let segment = walk.segment();
        let Event::Scattering(vertex) = walk.fly(segment, &mut sampler) else {
            panic!("the sensor sees nothing");
        };
        let (photons, phi) = found(host, &maps, &vertex, radius);
        tau += f64::from(walk.throughput) * phi;
        if photons > 0.0 {
            if kept == 0.0 {
                kept = photons * STARTING_PATHS as f64 / PATHS as f64;
            }
            let ratio = (kept + ALPHA * photons) / (kept + photons);
            kept += ALPHA * photons;
            radius *= ratio.powf(f64::from(dimension).recip());
            tau *= ratio;
        }
    }
    let unit = if dimension == 2 { PI } else { 4.0 / 3.0 * PI };
    tau / (unit * radius.powi(dimension) * passes as f64)
}

fn method() -> ProgressivePhotonMap {
    ProgressivePhotonMap::new()
        .radii(Radii::Statistics)
        .kernel(Kernel::Constant)
        .radius(RADIUS as f32)
        .alpha(ALPHA)
        .paths(PATHS)
        .starting_paths(STARTING_PATHS)
}

/// Equal but for rounding: 1e-4 is some hundred additions in `f32`, of which each may also have one
/// photon more or less at the rim, in 60 passes of some photons less than once.
fn agree(film: f64, paper: f64) {
    assert!(paper > 0.0, "the paper finds nothing");
    assert!((film / paper - 1.0).abs() < 1e-4, "{film} is not {paper}");
}

#[test]
fn in_a_medium_they_are_the_papers() {
    let view = View::Rays(vec![Ray::new(Vec3::new(0.5, 0.0, -1.0), Vec3::Z)]);
    let host = AnalyticHost::infinite_medium(fog(0.4, 1.6, 0.5), Vec3::ZERO, 2.0, view);
    let film = render(&host, &method(), 60, SEED);
    agree(film[0], paper(&host, [0, 0], 60, 3));
}

#[test]
fn on_a_surface_they_are_the_papers() {
    let host = floor(0.8);
    let film = render(&host, &method(), 60, SEED);
    for px in [[0, 0], [4, 3]] {
        let index = (px[1] * host.resolution()[0] + px[0]) as usize;
        agree(film[index], paper(&host, px, 60, 2));
    }
}

#[test]
fn a_pixel_takes_32_bytes() {
    assert_eq!(size_of::<Pixel>(), 32);
}
