//! Methods that gather photons against the path tracer, on every kind of scene.
//!
//! With radius r an estimate has a bias b(r), which falls with the radius: linearly near edges and
//! boundaries, quadratically elsewhere. In the first case b(r/2) = b(r) − b(r/2), in the other a
//! third of it. So the difference of the estimate with r/2 from the path tracer's must lie between a
//! third and the whole of its difference from that with r, but for the standard errors of the three:
//! means of the image (in the long tier of its quarters) in every channel, over passes, for photons
//! make the pixels of a pass depend on each other. Where radii are not given, other shares are left:
//! [`Mode::left`].
//!
//! Every mode is tried on the scenes where it can go wrong, every method on all of them.
//!
//! What is allowed altogether is bounded: 40 % of a figure in the short tier, which sees what is lost
//! or counted twice, and a quarter in the long one.
//! False alarms: 1e-3 a scene and method, Šidák-corrected within it; fixed seeds.

use crate::modes::*;
use std::path::Path as FilePath;
use tyndall_core::{Rgb, Sensor};
use tyndall_driver::{Budget, Render};
use tyndall_path::Path;
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::stats::{Estimate, Moments, check_mean, sidak};

const FALSE_ALARM: f64 = 1e-3;

/// How much a comparison costs.
#[derive(Clone, Copy)]
struct Effort {
    /// Light paths a pass.
    paths: u64,
    passes: u64,
    /// Passes of the path tracer.
    reference: u64,
    /// Parts of the image along either side: a figure each, in every channel.
    parts: usize,
    /// Share of a figure that the test may allow.
    allowed: f64,
}

const SHORT: Effort = Effort {
    paths: 4_000,
    passes: 64,
    reference: 1_500,
    parts: 1,
    allowed: 0.4,
};
const LONG: Effort = Effort {
    paths: 16_000,
    passes: 400,
    reference: 30_000,
    parts: 2,
    allowed: 0.25,
};

fn scene(name: &str) -> Scene<Rgb> {
    let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let file = SceneFile::load(FilePath::new(&path), &[]);
    let scene = file.and_then(|file| file.build());
    scene.unwrap_or_else(|why| panic!("{why}"))
}

/// The means of the parts of the image, channel by channel.
fn measure(
    scene: &Scene<Rgb>,
    method: &Method,
    parts: usize,
    (passes, seed): (u64, u64),
) -> Vec<Estimate> {
    let [width, height] = scene.resolution().map(|n| n as usize);
    let count = 3 * parts * parts;
    let mut earlier = vec![0.0; count];
    let mut figures = vec![Moments::new(); count];
    let film = Render::new(scene, method.as_ref())
        .seed(seed)
        .run(Budget::Passes(passes), |progress| {
            let film = progress.snapshot.film();
            let mut sums = vec![0.0; count];
            for (i, value) in film.mean().iter().enumerate() {
                let (x, y) = (i / 3 % width, i / 3 / width);
                let part = x * parts / width + y * parts / height * parts;
                sums[3 * part + i % 3] += value * film.passes() as f64;
            }
            for i in 0..count {
                figures[i].push(
                    (sums[i] - earlier[i]) * (parts * parts) as f64 / (width * height) as f64,
                );
            }
            earlier = sums;
        })
        .expect("a film");
    assert_eq!(film.non_finite(), 0);
    figures.iter().map(Moments::estimate).collect()
}

/// # Errors
/// A line for every figure that disagrees.
fn agree(name: &str, modes: &[Mode], effort: Effort) -> Result<(), String> {
    let scene = scene(name);
    let mut wrong = Vec::new();
    let Effort {
        paths,
        passes,
        parts,
        ..
    } = effort;
    let path: Method = Box::new(Path::new());
    let reference = measure(&scene, &path, parts, (effort.reference, 1));
    for (seed, mode) in (2..).zip(modes) {
        let at_scale = |scale, seed| {
            let method = (mode.at_scale)(scale, paths);
            measure(&scene, &method, parts, (passes, seed))
        };
        let wide = at_scale(mode.scale, 2 * seed);
        let narrow = at_scale(0.5 * mode.scale, 2 * seed + 1);
        for i in 0..reference.len() {
            let difference = narrow[i].difference(&reference[i]);
            let gone = wide[i].difference(&narrow[i]);
            let [a, b] = mode.left.map(|share| share * gone.mean);
            let (least, most) = (a.min(b), a.max(b));
            let nearest = difference.mean.clamp(least, most);
            // The narrow estimate is in both, and the share that is left may be more than one.
            let either = Estimate {
                standard_error: difference.standard_error + mode.left[1] * gone.standard_error,
                ..difference
            };
            let name = format!("{name} by {}, figure {i} of {:?}", mode.name, reference[i]);
            let allowed = most - least + 4.0 * either.standard_error;
            if allowed > effort.allowed * reference[i].mean {
                wrong.push(format!("{name}: {allowed} would be allowed"));
            }
            wrong.extend(
                check_mean(&name, either, nearest, sidak(FALSE_ALARM, reference.len())).err(),
            );
        }
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(wrong.join("\n"))
}

/// A short test and a long one of every scene.
macro_rules! scenes {
    ($($name:ident: [$($mode:expr),+ $(,)?]),+ $(,)?) => {
        $(
            #[test]
            fn $name() -> Result<(), String> {
                agree(stringify!($name), &[$($mode),+], SHORT)
            }
        )+

        mod in_detail {
            use super::*;
            $(
                #[test]
                #[ignore = "long: cargo test -p tyndall-suite in_detail -- --ignored"]
                fn $name() -> Result<(), String> {
                    agree(stringify!($name), &[$($mode),+], LONG)
                }
            )+
        }
    };
}

scenes! {
    fog_box: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS,
        MAP_NEAREST, BEAMS_NEAREST, BEAMS1D,
    ],
    anisotropic_fog_box: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS,
        BEAMS1D, BEAMS2D_SAMPLED,
    ],
    chromatic_fog: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS,
        BEAMS1D,
    ],
    glass_ball: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS,
        MAP_FINAL, MAP_NEAREST, BEAMS1D, BEAMS_DIFFERENTIALS,
    ],
    murky_water: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS.fine(),
        MAP_SAMPLED, BEAMS1D,
    ],
    several_lights: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS,
        STATISTICS_SAMPLED, BEAMS1D, BEAMS2D_SAMPLED, BEAMS_NEAREST_ENDS,
    ],
    smoke: [
        MAP, MAP_SAMPLED_FINAL, PROGRESSIVE, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS,
        BEAMS_TRACKING, BEAMS_TRACKING_BALLS, BEAMS1D, BEAMS2D_SAMPLED, BEAMS_DIFFERENTIALS,
    ],
    glossy: [MAP, MAP_FINAL, PROGRESSIVE_SAMPLED, BEAMS, BEAMS_SAMPLED_BALLS, BEAMS1D],
    small_balls: [MAP_SAMPLED.curved(), STATISTICS.curved(), BEAMS.curved(), BEAMS1D.curved()],
    lens: [MAP_FINAL, STATISTICS, BEAMS_SAMPLED_BALLS, BEAMS1D, BEAMS_DIFFERENTIALS],
    sun_and_sky: [MAP_SAMPLED, PROGRESSIVE, BEAMS, BEAMS_SAMPLED_BALLS, BEAMS1D],
}
