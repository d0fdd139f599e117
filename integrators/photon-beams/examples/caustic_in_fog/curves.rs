//! Error against time.

use crate::reference::{self, Reference};
use crate::{Host, Method, methods, scene};
use std::error::Error;
use std::time::Duration;
use tyndall_driver::{Budget, Render};
use tyndall_photon_beams::PhotonBeams;
use tyndall_testkit::stats::{Moments, log_log_slope};

/// Of curves, and the seconds after which errors are taken: the last, and halves of it.
const SEEDS: u64 = 10;
const LONGEST: f64 = 8.0;
const TIMES: usize = 7;
/// Seconds for the reference.
const REFERENCE: f64 = 200.0;
/// What is to be reached.
const TARGET: f64 = 0.05;
/// A small picture.
const SMALL: [(&str, &str); 2] = [("film.width", "160"), ("film.height", "90")];
/// With a lamp and a hole so wide that path tracing finds the caustic too, and fog up to the lamp.
const WIDE: [(&str, &str); 8] = [
    SMALL[0],
    SMALL[1],
    ("shapes.0.max", "[2.5, 4.0, 1.2]"),
    ("shapes.1.radius", "0.8"),
    ("shapes.2.max", "[-0.6, 2.41, 1.2]"),
    ("shapes.3.min", "[0.6, 2.4, -1.2]"),
    ("shapes.4.max", "[0.6, 2.41, -0.6]"),
    ("shapes.5.min", "[-0.6, 2.4, 0.6]"),
];

/// Beams a quarter of a pixel wide at the most: what they blur is less than a pixel does.
fn arbiter() -> PhotonBeams {
    PhotonBeams::new()
        .paths(40_000)
        .beam_radius(0.005)
        .alpha(1.0)
}

/// Prints the curves.
pub(crate) fn print() -> Result<(), Box<dyn Error>> {
    let wide = scene(&WIDE)?;
    let beams = reference::render(&wide, &arbiter(), 0.25 * REFERENCE, 1_000)?;
    let path = reference::render(&wide, &tyndall_path::Path::new(), 0.25 * REFERENCE, 2_000)?;
    println!("# reference and path, wide lamp: {}", beams.compare(&path));
    let host = scene(&SMALL)?;
    let reference = reference::render(&host, &arbiter(), REFERENCE, 3_000)?;
    let [rmse, per_pixel] = reference.own_squared_errors().map(f64::sqrt);
    println!("# errors of the reference: {rmse:.4}, {per_pixel:.4}");
    println!("method,seconds,rmse,spread,per_pixel,spread");
    let mut reached: Vec<(&str, [f64; 2])> = Vec::new();
    for (name, method) in methods() {
        let curve = curve(&host, method.as_ref(), &reference)?;
        for Point { seconds, errors } in &curve {
            let [(rmse, a), (per_pixel, b)] = errors;
            println!("{name},{seconds:.3},{rmse:.5},{a:.5},{per_pixel:.5},{b:.5}");
        }
        reached.push((name, [0, 1].map(|kind| reach(name, &curve, kind))));
    }
    for (name, seconds) in &reached[1..] {
        let (best, of) = &reached[0];
        let ratios = [0, 1].map(|kind| seconds[kind] / of[kind]);
        println!(
            "# {name} take {:.1} and {:.1} times as long as {best}",
            ratios[0], ratios[1]
        );
    }
    Ok(())
}

/// What a run has after some time.
struct Run {
    seconds: f64,
    /// Of both errors.
    squares: [f64; 2],
}

/// A point of a curve: both errors, the root of their mean square over the seeds and the standard
/// deviation of one.
struct Point {
    seconds: f64,
    errors: [(f64, f64); 2],
}

fn curve(
    host: &Host,
    method: &Method,
    reference: &Reference,
) -> Result<Vec<Point>, Box<dyn Error>> {
    let mut found: Vec<Vec<Run>> = (0..TIMES).map(|_| Vec::new()).collect();
    for seed in 0..SEEDS {
        let mut next = 0;
        let budget = Budget::Time(Duration::from_secs_f64(LONGEST));
        Render::new(host, method)
            .seed(seed)
            .run(budget, |progress| {
                let seconds = progress.snapshot.elapsed().as_secs_f64();
                while next < TIMES && seconds >= LONGEST / f64::from(1 << (TIMES - 1 - next)) {
                    let squares = reference.squared_errors_of(progress.snapshot.film().mean());
                    found[next].push(Run { seconds, squares });
                    next += 1;
                }
            })?;
    }
    Ok(found.iter().map(|runs| Point::of(runs)).collect())
}

impl Point {
    fn of(runs: &[Run]) -> Self {
        let moments = |of: &dyn Fn(&Run) -> f64| runs.iter().map(of).collect();
        let seconds: Moments = moments(&|run| run.seconds);
        let error = |kind: usize| {
            let errors: Moments = moments(&|run| run.squares[kind].max(0.0).sqrt());
            let squares: Moments = moments(&|run| run.squares[kind]);
            (squares.estimate().mean.sqrt(), errors.variance().sqrt())
        };
        Self {
            seconds: seconds.estimate().mean,
            errors: [error(0), error(1)],
        }
    }
}

/// Slopes that are flatter are of errors that stay: of light that is not found.
const FALLING: f64 = -0.1;

/// Tells the slope of a curve and the seconds after which it is at the target, by the power law
/// through its latter half, beyond its end too.
fn reach(name: &str, curve: &[Point], kind: usize) -> f64 {
    let latter = &curve[TIMES / 2..];
    let points: Vec<_> = (latter.iter().map(|p| (p.seconds, p.errors[kind].0))).collect();
    let fit = log_log_slope(&points);
    let logs = |(x, y): &(f64, f64)| y.ln() - fit.slope * x.ln();
    let at_one = points.iter().map(logs).sum::<f64>() / points.len() as f64;
    let seconds = match fit.slope < FALLING {
        true => ((TARGET.ln() - at_one) / fit.slope).exp(),
        false => f64::INFINITY,
    };
    println!(
        "# {name}, {}: slope {:.2} ± {:.2}, {:.0} % after {seconds:.1} s{}",
        ["rmse", "per_pixel"][kind],
        fit.slope,
        fit.standard_error,
        100.0 * TARGET,
        if seconds > LONGEST {
            ", extrapolated"
        } else {
            ""
        },
    );
    seconds
}
