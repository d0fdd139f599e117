//! All estimators against the path tracer.
//!
//! With radius r an estimate has a bias b(r), which falls linearly near boundaries and quadratically
//! elsewhere: of b(r) − b(r/2), between a third and all is left at r/2.

use crate::{FALSE_ALARM, Run, fog};
use tyndall_core::Rgb;
use tyndall_path::Path;
use tyndall_photon_beams::{Estimate, Extent, PhotonBeams};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};
use tyndall_testkit::stats::{check_mean, sidak};

/// Estimators and extents of light and of sight.
const WAYS: [(Estimate, Extent, Extent); 13] = [
    (Estimate::PointPoint3D, Extent::Long, Extent::Long),
    (Estimate::PointBeam2D, Extent::Long, Extent::Long),
    (Estimate::PointBeam3D, Extent::Long, Extent::Long),
    (Estimate::BeamPoint2D, Extent::Long, Extent::Long),
    (Estimate::BeamPoint3D, Extent::Long, Extent::Long),
    (Estimate::BeamPoint3D, Extent::Short, Extent::Long),
    (Estimate::BeamBeam1D, Extent::Long, Extent::Long),
    (Estimate::BeamBeam1D, Extent::Short, Extent::Long),
    (Estimate::BeamBeam1D, Extent::Long, Extent::Short),
    (Estimate::BeamBeam1D, Extent::Short, Extent::Short),
    (Estimate::BeamBeam2DRay, Extent::Long, Extent::Long),
    (Estimate::BeamBeam2DBeam, Extent::Long, Extent::Long),
    (Estimate::BeamBeam3D, Extent::Long, Extent::Long),
];

#[test]
fn all_estimators_agree_with_the_path_tracer() {
    let medium = fog(Rgb::new(0.1, 0.3, 0.05), Rgb::new(1.0, 0.5, 2.0), 0.5);
    let host = AnalyticHost::sphere(medium, 1.0, Interface::Matched, lamp(1.0), view(1.0));
    let run = |passes, samples, seed| Run {
        passes,
        samples,
        seed,
    };
    let path = run(200, 40, 1).measure(&host, &Path::new());
    for (seed, (estimate, light, sight)) in (2..).zip(WAYS) {
        let [wide, narrow] = [0.12, 0.06].map(|radius| {
            let method = PhotonBeams::new().paths(1000).alpha(1.0);
            let method = method.beam_radius(radius).radius(radius);
            let method = method.light_beams(light).sight_beams(sight);
            run(400, 4, seed).measure(&host, &method.estimator(estimate))
        });
        for (c, path) in path.iter().enumerate() {
            let difference = narrow[c].difference(path);
            let gone = wide[c].difference(&narrow[c]);
            let shares = [gone.mean / 3.0, gone.mean];
            let nearest = difference
                .mean
                .clamp(shares[0].min(shares[1]), shares[0].max(shares[1]));
            let mut either = difference;
            either.standard_error += gone.standard_error;
            // Or it would test nothing: the largest error is that of single photons.
            let found = either.standard_error / path.mean;
            assert!(
                found < 0.08,
                "{estimate}, channel {c}: {found} is too noisy"
            );
            let name = format!("{estimate}, light {light}, sight {sight}, channel {c}");
            check_mean(&name, either, nearest, sidak(FALSE_ALARM, 3 * WAYS.len()))
                .unwrap_or_else(|why| panic!("{why}"));
        }
    }
}
