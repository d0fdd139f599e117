//! The same result however light paths are cut into passes.

use crate::{FALSE_ALARM, fog, measure, sphere_of_rays};
use glam::Vec3;
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::stats::{Estimate, check_mean};

/// Light paths in all.
const PATHS: u64 = 12_800;

/// Light by few large passes and by sixteen times as many small ones. The radii are so wide that
/// their bias is plain: 150 photons of 3,200 paths.
fn two_ways(method: ProgressivePhotonMap, paths: u64) -> [Estimate; 2] {
    let rays = sphere_of_rays(Vec3::new(0.0, 0.0, 0.7), 60);
    let host = AnalyticHost::infinite_medium(fog(0.6, 1.4, 0.3), Vec3::ZERO, 1.0, View::Rays(rays));
    [paths, paths / 16].map(|paths| {
        let method = method.nearest(150).starting_paths(3_200).paths(paths);
        // Independent seeds, for the passes are not the same.
        let seeds = paths * 1_000..paths * 1_000 + 40;
        measure(&host, &method, PATHS / paths, seeds)[0]
    })
}

fn agree([few, many]: [Estimate; 2], bias: f64) {
    for estimate in [few, many] {
        let noise = estimate.relative_standard_error();
        assert!(noise < 0.015, "{noise:.4} is too noisy");
    }
    let difference = few.difference(&many);
    let expected = difference.mean.clamp(-bias, bias);
    check_mean("few − many", difference, expected, FALSE_ALARM)
        .unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn memoryless_radii_do_not_know_passes() {
    agree(two_ways(ProgressivePhotonMap::new(), 3_200), 0.0);
}

/// By statistics radii follow the same law while passes are small beside the starting paths. With
/// half of them, 1,600 a pass, radii end 2 % wider than with a sixteenth of that, and their bias,
/// which is less than 30 % of the light here, is 4 % larger: 1.2 % of the light.
#[test]
fn statistics_hardly_know_passes() {
    let method = ProgressivePhotonMap::new().radii(Radii::Statistics);
    let ways = two_ways(method, 1_600);
    agree(ways, 0.012 * ways[1].mean);
}

/// Radii of a pass that knew nothing of the paths before it would be found out.
#[test]
fn a_radius_that_depends_on_passes_is_seen() {
    let by_passes = |paths: u64| {
        let rays = sphere_of_rays(Vec3::new(0.0, 0.0, 0.7), 60);
        let host =
            AnalyticHost::infinite_medium(fog(0.6, 1.4, 0.3), Vec3::ZERO, 1.0, View::Rays(rays));
        // The photons of a radius and its shrinking are meant for one pass, not for paths.
        let method = ProgressivePhotonMap::new().nearest(150);
        let method = method.starting_paths(paths).paths(paths);
        measure(&host, &method, PATHS / paths, paths..paths + 40)[0]
    };
    let difference = by_passes(3_200).difference(&by_passes(200));
    check_mean("few − many", difference, 0.0, FALSE_ALARM).expect_err("this is to be seen");
}
