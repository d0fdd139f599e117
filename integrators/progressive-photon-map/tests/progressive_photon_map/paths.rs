//! The same result however light paths are cut into passes.

use crate::closed_form::floor;
use crate::{FALSE_ALARM, alone, fog, measure, sphere_of_rays};
use glam::Vec3;
use tyndall_core::{Integrator, Sensor};
use tyndall_driver::{Budget, Render};
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::stats::{Estimate, check_mean};

/// Light paths in all.
const PATHS: u64 = 12_800;

/// Light by passes of so many paths. Radii are so wide that their bias is plain: 150 photons of
/// `starting_paths`.
fn light(method: ProgressivePhotonMap, paths: u64, starting_paths: u64) -> Estimate {
    let rays = sphere_of_rays(Vec3::new(0.0, 0.0, 0.7), 150);
    let host = AnalyticHost::infinite_medium(fog(1.0, 1.0, 0.3), Vec3::ZERO, 1.0, View::Rays(rays));
    let method = (method.nearest(150).paths(paths)).starting_paths(starting_paths);
    // Independent seeds: passes of other paths are other passes.
    let seeds = paths * 1_000..paths * 1_000 + 40;
    let light = measure(&host, &method, PATHS / paths, seeds)[0];
    let noise = light.relative_standard_error();
    assert!(noise < 0.02, "{noise:.4} is too noisy");
    light
}

/// Whether they agree, but for a bias.
fn compare(few: Estimate, many: Estimate, bias: f64) -> Result<(), String> {
    let difference = few.difference(&many);
    let expected = difference.mean.clamp(-bias, bias);
    check_mean("few passes − many", difference, expected, FALSE_ALARM)
}

/// That the test sees what it is about shows its last line: radii that are meant for a pass, and
/// shrink with passes, give another picture.
#[test]
fn memoryless_radii_do_not_know_passes() {
    let method = ProgressivePhotonMap::new();
    let few = light(method, 3_200, 3_200);
    let many = light(method, 200, 3_200);
    compare(few, many, 0.0).unwrap_or_else(|why| panic!("{why}"));
    compare(few, light(method, 200, 200), 0.0).expect_err("another picture");
}

/// By statistics radii follow the same law while passes are small beside the starting paths. With
/// half of them, 1,600 a pass, radii end 2 % wider than with a sixteenth of that, and their bias,
/// which is less than 30 % of the light here, is 4 % larger: 1.2 % of the light.
#[test]
fn statistics_hardly_know_passes() {
    let method = ProgressivePhotonMap::new().radii(Radii::Statistics);
    let (few, many) = (light(method, 1_600, 3_200), light(method, 100, 3_200));
    compare(few, many, 0.012 * many.mean).unwrap_or_else(|why| panic!("{why}"));
}

/// The light of one pass, the eighth.
fn eighth<H: Sensor>(host: &H, method: ProgressivePhotonMap) -> Vec<f64>
where
    ProgressivePhotonMap: Integrator<H>,
{
    let render = Render::new(host, &method).seed(3).first_pass(7);
    let film = alone().install(|| render.run(Budget::Passes(1), |_| {}));
    film.expect("a film").mean().to_vec()
}

/// A pass has the radius whose square is the mean of r₀² (1 + n/n₀)^p over its paths n, with
/// p = 2 (α − 1)/d: its light is that of the same pass with that radius given.
fn law<H: Sensor>(host: &H, power: f64)
where
    ProgressivePhotonMap: Integrator<H>,
{
    let (paths, starting_paths, radius) = (400.0_f64, 1_000.0, 0.4_f64);
    let integral = |pass: f64| (1.0 + pass * paths / starting_paths).powf(power + 1.0);
    let mean = (integral(8.0) - integral(7.0)) * starting_paths / (paths * (power + 1.0));
    let method = ProgressivePhotonMap::new().paths(400).starting_paths(1_000);
    let shrunk = eighth(host, method.radius(radius as f32));
    let given = method.radius((radius * mean.sqrt()) as f32).alpha(1.0);
    let given = eighth(host, given);
    assert!(given.iter().any(|v| *v > 0.0));
    for (a, b) in shrunk.iter().zip(&given) {
        assert!((a - b).abs() <= 1e-4 * b, "{a} is not {b}");
    }
}

#[test]
fn memoryless_radii_follow_their_law() {
    law(&floor(1.0), -1.0 / 3.0);
    let rays = View::Rays(sphere_of_rays(Vec3::new(0.0, 0.0, 0.7), 50));
    let host = AnalyticHost::infinite_medium(fog(1.0, 1.0, 0.3), Vec3::ZERO, 1.0, rays);
    law(&host, -2.0 / 7.0);
}
