//! Widths that are not the same for all beams.

use crate::closed_form::{Row, long, outwards};
use crate::{FALSE_ALARM, fixed, fog};
use glam::Vec3;
use tyndall_core::{Ray, Rgb};
use tyndall_photon_beams::{Estimate, Kernel};
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, Interface, View};
use tyndall_testkit::stats::{Figures, extrapolated};
use tyndall_testkit::{Run, Tier, in_both_tiers};

in_both_tiers! {
    rows_of_a_laser,
    airlight_of_a_point_light,
    the_furnace_is_white,
}

fn run(tier: Tier, passes: [u64; 2], seed: u64) -> Run {
    Run {
        passes: tier.passes(passes),
        samples: 1,
        seed,
    }
}

/// In 1D no radius leaves a bias.
fn rows_of_a_laser(tier: Tier) {
    let mut figures = Figures::default();
    let row = Row::at_degrees(60.0);
    let method = fixed(Estimate::BeamBeam1D, 0.2).paths(100);
    let method = method.starting_paths(100).kernel(Kernel::Constant);
    for (seed, method) in [
        // A path's own disc has a tenth of the laser's radius, 0.005: so wide, at the least and at
        // the most.
        (1, method.beam_differentials(15.0)),
        (2, method.beam_differentials(1e-3)),
        (3, method.beam_differentials(1e3)),
        (4, method.beam_nearest(8)),
    ] {
        let what = (&method, Estimate::BeamBeam1D, 0.2);
        row.measure(
            &mut figures,
            what,
            run(tier, [24, 600], seed),
            long(tier, 0.03),
        );
    }
    figures.check(FALSE_ALARM);
}

/// Beams that fan out: twice as wide, they have four times the bias.
fn airlight_of_a_point_light(tier: Tier) {
    let (sigma_t, rarely) = (0.6_f32, 1e-4);
    let medium = fog(sigma_t * (1.0 - rarely), sigma_t * rarely, 0.0);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let host =
        AnalyticHost::infinite_medium(medium, Vec3::new(0.5, 1.0, 0.0), 1.0, View::Rays(vec![ray]));
    let sigma_s = f64::from(sigma_t * rarely);
    let expected = airlight(sigma_s, f64::from(sigma_t), 1.0, 0.5, f64::INFINITY);
    let mut figures = Figures::default();
    // A path's own disc has a radius of 2v/√1000: here 0.05 at a distance of 1.
    let method = fixed(Estimate::BeamBeam1D, 1e3).paths(1_000);
    let method = method.starting_paths(1_000);
    let mean = |wider: f32, seed| {
        let method = method.beam_differentials(0.8 * wider);
        let method = method.beam_radius(0.4 * wider);
        run(tier, [24, 1_000], seed).measure(&host, &method)[0]
    };
    let without = extrapolated(mean(1.0, 1), mean(2.0, 2), 2);
    figures.add("differentials", without, expected, long(tier, 0.06));
    let mean = |wider: f32, seed| {
        let method = method.beam_nearest((8.0 * wider.powi(3)) as usize);
        let method = method.beam_radius(0.3 * wider);
        run(tier, [24, 1_000], seed).measure(&host, &method)[0]
    };
    let without = extrapolated(mean(1.0, 1), mean(2.0, 2), 2);
    figures.add("nearest", without, expected, long(tier, 0.06));
    figures.check(FALSE_ALARM);
}

/// Of light that comes through a ball of glass, focused inside of it, and of light from everywhere.
fn the_furnace_is_white(tier: Tier) {
    let mut figures = Figures::default();
    let method = fixed(Estimate::BeamBeam1D, 0.05).kernel(Kernel::Constant);
    let method = method.paths(1_000).starting_paths(1_000);
    for (interface, white) in [
        (Interface::Matched, 1.0),
        (Interface::Dielectric(1.5), 2.25),
    ] {
        let medium = fog(Rgb::default(), Rgb::new(0.5, 1.0, 2.0), 0.5);
        let host = AnalyticHost::furnace(medium, 1.0, interface, outwards());
        for (name, method) in [
            ("differentials", method.beam_differentials(0.5)),
            ("nearest", method.beam_nearest(4)),
        ] {
            let found = run(tier, [20, 600], 1).measure(&host, &method);
            for (c, mean) in found.into_iter().enumerate() {
                let name = format!("{name} {interface:?} channel {c}");
                figures.add(name, mean, white, long(tier, 0.08));
            }
        }
    }
    figures.check(FALSE_ALARM);
}
