//! Methods that gather photons against the path tracer, on every kind of scene.
//!
//! With radius r an estimate has a bias b(r), which falls with the radius: linearly near edges and
//! boundaries, quadratically elsewhere. In both cases |b(r/2)| ≤ |b(r) − b(r/2)|, which is measured.
//! The estimate with r/2 must lie within that of the path tracer's, and within the standard errors
//! of the three estimates: means of the quarters of the image in every channel, over passes, for
//! photons make the pixels of a pass depend on each other.
//!
//! False alarms: 1e-3 a scene and method, Šidák-corrected within it; fixed seeds.

use std::path::Path as FilePath;
use tyndall_beam_radiance::{BeamRadiance, Blur};
use tyndall_core::{AnyIntegrator, Rgb, Sensor};
use tyndall_driver::{Budget, PassStreams, Render};
use tyndall_path::Path;
use tyndall_photon_map::PhotonMap;
use tyndall_progressive_photon_map::ProgressivePhotonMap;
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::stats::{Estimate, Moments, check_mean, sidak};

const FALSE_ALARM: f64 = 1e-3;
/// Quarters × channels.
const FIGURES: usize = 12;
/// In scenes of side 2.
const RADIUS: f32 = 0.16;
const PATHS: u64 = 3000;
const PASSES: u64 = 64;
const REFERENCE: u64 = 1500;

type Method = Box<dyn AnyIntegrator<Scene<Rgb>, PassStreams>>;

fn scene(name: &str) -> Scene<Rgb> {
    let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let file = SceneFile::load(FilePath::new(&path), &[]);
    let scene = file.and_then(|file| file.build());
    scene.unwrap_or_else(|why| panic!("{why}"))
}

/// The means of the quarters of the image, channel by channel.
fn measure(scene: &Scene<Rgb>, method: &Method, passes: u64, seed: u64) -> Vec<Estimate> {
    let [width, height] = scene.resolution().map(|n| n as usize);
    let mut earlier = [0.0; FIGURES];
    let mut figures = [Moments::new(); FIGURES];
    let film = Render::new(scene, method.as_ref())
        .seed(seed)
        .run(Budget::Passes(passes), |progress| {
            let film = progress.snapshot.film();
            let mut sums = [0.0; FIGURES];
            for (i, value) in film.mean().iter().enumerate() {
                let (x, y) = (i / 3 % width, i / 3 / width);
                let quarter = usize::from(2 * x >= width) + 2 * usize::from(2 * y >= height);
                sums[3 * quarter + i % 3] += value * film.passes() as f64;
            }
            for i in 0..FIGURES {
                figures[i].push((sums[i] - earlier[i]) / (width * height / 4) as f64);
            }
            earlier = sums;
        })
        .expect("a film");
    assert_eq!(film.non_finite(), 0);
    figures.iter().map(Moments::estimate).collect()
}

fn agree(name: &str) {
    let scene = scene(name);
    let reference = measure(&scene, &(Box::new(Path::new()) as Method), REFERENCE, 1);
    let methods: [(&str, fn(f32) -> Method); 6] = [
        ("photon_map", |r| {
            Box::new(PhotonMap::new().paths(PATHS).radius(r))
        }),
        ("photon_map, lights sampled, final gathering", |r| {
            let map = PhotonMap::sampling_lights().paths(PATHS).radius(r);
            Box::new(map.final_gather(2))
        }),
        ("progressive_photon_map", |r| {
            let map = ProgressivePhotonMap::new().paths(PATHS).radius(r);
            Box::new(map.max_radius(r).alpha(1.0))
        }),
        ("progressive_photon_map, lights sampled", |r| {
            let map = ProgressivePhotonMap::sampling_lights().paths(PATHS);
            Box::new(map.radius(r).max_radius(r).alpha(1.0))
        }),
        ("beam_radiance", |r| {
            let beams = BeamRadiance::new().paths(PATHS).radius(r);
            Box::new(beams.surface_radius(r).alpha(1.0))
        }),
        ("beam_radiance, lights sampled, balls", |r| {
            let beams = BeamRadiance::sampling_lights().paths(PATHS).radius(r);
            Box::new(beams.surface_radius(r).alpha(1.0).blur(Blur::Ball))
        }),
    ];
    for (seed, (method, with_radius)) in (2..).zip(methods) {
        let wide = measure(&scene, &with_radius(RADIUS), PASSES, 2 * seed);
        let narrow = measure(&scene, &with_radius(0.5 * RADIUS), PASSES, 2 * seed + 1);
        for i in 0..FIGURES {
            let difference = narrow[i].difference(&reference[i]);
            let bias = wide[i].difference(&narrow[i]);
            // b(r/2) is between 0 and b(r) − b(r/2): what is nearest in there is tested.
            let nearest = difference
                .mean
                .clamp(bias.mean.min(0.0), bias.mean.max(0.0));
            let either = Estimate {
                standard_error: difference.standard_error.hypot(bias.standard_error),
                ..difference
            };
            if i == 4 { eprintln!("DBG {name} {method}: diff {:+.3} bias {:+.3} se diff {:.3} bias {:.3} ref {:.4}", difference.mean/reference[i].mean, bias.mean/reference[i].mean, difference.standard_error/reference[i].mean, bias.standard_error/reference[i].mean, reference[i].standard_error/reference[i].mean); }
            let name = format!("{name} by {method}, figure {i} of {:?}", reference[i]);
            check_mean(&name, either, nearest, sidak(FALSE_ALARM, FIGURES))
                .unwrap_or_else(|why| panic!("{why}"));
        }
    }
}

#[test]
fn fog_box() {
    agree("fog_box");
}

#[test]
fn anisotropic_fog_box() {
    agree("anisotropic_fog_box");
}

#[test]
fn chromatic_fog() {
    agree("chromatic_fog");
}

#[test]
fn glass_ball() {
    agree("glass_ball");
}

#[test]
fn murky_water() {
    agree("murky_water");
}

#[test]
fn several_lights() {
    agree("several_lights");
}

#[test]
fn smoke() {
    agree("smoke");
}
