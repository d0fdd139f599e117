//! The density of photons at collisions is the fluence.

use super::{FALSE_ALARM, maps};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::{Coefficients, HostTypes, MediumId, Rgb, Spectrum};
use tyndall_density::Kernel;
use tyndall_media::{Homogeneous, Phase};
use tyndall_photons::{Gather, Search};
use tyndall_testkit::closed_form::point_source_fluence;
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::stats::{Moments, check_means};
use tyndall_walk::{ByPhotons, BySampling, DirectLight};

const RADIUS: f64 = 0.4;
const DISTANCE: f64 = 0.9;

/// The mean of `fluence`, a function of the distance from the source, over the ball.
fn over_the_ball(fluence: impl Fn(f64) -> f64) -> f64 {
    // Of the sphere of radius s around the source, a cap of area πs/R·(r² − (R − s)²) is in the ball.
    let steps = 200;
    let step = 2.0 * RADIUS / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|i| {
            let s = DISTANCE - RADIUS + (f64::from(i) + 0.5) * step;
            PI * s / DISTANCE * (RADIUS.powi(2) - (DISTANCE - s).powi(2)) * fluence(s) * step
        })
        .sum();
    sum / (4.0 / 3.0 * PI * RADIUS.powi(3))
}

/// Scattered radiance per unit at the middle of the ball, per channel.
fn measured<D: DirectLight<AnalyticHost<Homogeneous<Rgb>>>>(
    host: &AnalyticHost<Homogeneous<Rgb>>,
) -> [Moments; 3] {
    let mut gather = Gather::new(Search::Within(RADIUS as f32), Kernel::Constant);
    let mut found = [Moments::new(); 3];
    for pass in 0..40 {
        let maps = maps::<_, D>(host, pass, 5_000);
        assert!(maps.surfaces.is_empty());
        let middle = host_position() + DISTANCE as f32 * Vec3::new(0.6, 0.0, 0.8);
        let photons = maps.in_medium(inside(host)).expect("photons");
        let at = gather.medium(photons, middle, Vec3::X, &host.medium);
        for (i, moments) in found.iter_mut().enumerate() {
            moments.push(f64::from(at.radiance.channel(i)));
        }
    }
    found
}

fn host_position() -> Vec3 {
    Vec3::new(3.0, -1.0, 0.5)
}

/// The id of the only medium.
fn inside<H: HostTypes>(_: &H) -> MediumId {
    MediumId(1)
}

#[test]
fn of_a_point_source() {
    let sigma_t = Rgb::new(1.0, 1.4, 0.3);
    let albedo = Rgb::new(0.9, 0.5, 0.9);
    let coefficients = Coefficients {
        sigma_a: sigma_t * (Rgb::splat(1.0) - albedo),
        sigma_s: sigma_t * albedo,
        emission: Rgb::default(),
    };
    let medium = Homogeneous::new(coefficients, Phase::Isotropic).expect("a medium");
    let power = Rgb::new(2.0, 5.0, 1.0);
    let host = AnalyticHost::infinite_medium(medium, host_position(), power, View::Rays(vec![]));
    let expected = |i: usize, direct: bool| {
        let [a, s, w] = [albedo, sigma_t, power].map(|x| f64::from(x.channel(i)));
        let fluence = over_the_ball(|r| {
            let uncollided = (-s * r).exp() / (4.0 * PI * r * r);
            point_source_fluence(a, s, r) - if direct { 0.0 } else { uncollided }
        });
        w * a * s * fluence / (4.0 * PI)
    };
    let [all, scattered] = [measured::<ByPhotons>(&host), measured::<BySampling>(&host)];
    let cases: Vec<_> = (0..3)
        .flat_map(|i| {
            [
                ("all light", all[i].estimate(), expected(i, true)),
                (
                    "scattered before",
                    scattered[i].estimate(),
                    expected(i, false),
                ),
            ]
        })
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}
