//! All estimators against each other and against the path tracer.

use crate::{Run, fog};
use tyndall_core::Rgb;
use tyndall_path::Path;
use tyndall_photon_beams::{Estimate, Extent, PhotonBeams};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};

#[test]
fn yard() {
    let medium = fog(Rgb::new(0.1, 0.3, 0.05), Rgb::new(1.0, 0.5, 2.0), 0.5);
    let host = AnalyticHost::sphere(medium, 1.0, Interface::Matched, lamp(1.0), view(1.0));
    let run = Run {
        passes: 1000,
        samples: 40,
        seed: 1,
    };
    let path = run.measure(&host, &Path::new());
    eprintln!("path {path:?}");
    for radius in [0.03, 0.01] {
        for estimate in Estimate::ALL {
            for (light, sight) in [
                (Extent::Long, Extent::Long),
                (Extent::Short, Extent::Long),
                (Extent::Long, Extent::Short),
            ] {
                if !estimate.takes_beams()
                    || light == Extent::Short
                    || radius < 0.02
                    || sight == Extent::Short
                {
                    continue;
                }

                let method = PhotonBeams::new()
                    .paths(1000)
                    .beam_radius(radius)
                    .radius(radius)
                    .estimator(estimate)
                    .light_beams(light)
                    .sight_beams(sight)
                    .alpha(1.0);
                let start = std::time::Instant::now();
                let found = Run {
                    passes: 2000,
                    samples: 4,
                    seed: 2,
                }
                .measure(&host, &method);
                let rows: Vec<_> = found
                    .iter()
                    .zip(&path)
                    .map(|(f, p)| {
                        let d = f.difference(p);
                        format!("{:+.4} ± {:.4}", d.mean / p.mean, d.standard_error / p.mean)
                    })
                    .collect();
                eprintln!(
                    "{estimate} {light} {sight}: {rows:?} {:.1?}",
                    start.elapsed()
                );
            }
        }
    }
}
