//! Media that are not the same everywhere.

use crate::{FALSE_ALARM, fixed, fog, phase};
use glam::Vec3;
use tyndall_beam_radiance::{BeamRadiance, Blur, Transmittance};
use tyndall_core::{Aabb, Coefficients, Medium, Rgb};
use tyndall_media::{DenseGrid, GridMedium, plume};
use tyndall_path::Path;
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::measure_mean;
use tyndall_testkit::stats::{Figures, extrapolated};
use tyndall_testkit::{Run, Tier, in_both_tiers};

const BOX: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};
const TABLE: Transmittance = Transmittance::Table { max_error: 1e-3 };
const FLIGHTS: Transmittance = Transmittance::Tracking { flights: 4 };

fn per_density(sigma_a: Rgb, sigma_s: Rgb) -> Coefficients<Rgb> {
    Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    }
}

fn ball<M: Medium<Spectrum = Rgb>>(medium: M) -> AnalyticHost<M> {
    let direction = Vec3::new(-0.3, -1.0, 0.4).normalize();
    let light = Light::Beam {
        center: -2.0 * direction,
        direction,
        radius: 0.7,
        irradiance: Rgb::new(1.0, 2.0, 3.0),
    };
    let view = View::Pinhole {
        eye: Vec3::new(0.2, 0.1, -2.0),
        forward: Vec3::Z,
        half_width: 0.3,
        pixels: 8,
    };
    AnalyticHost::sphere(medium, 1.0, Interface::Matched, light, view)
}

in_both_tiers! { a_constant_grid_is_a_homogeneous_medium }

fn a_constant_grid_is_a_homogeneous_medium(tier: Tier) {
    let (sigma_a, sigma_s) = (Rgb::new(0.1, 0.4, 0.0), Rgb::new(0.9, 1.6, 3.0));
    // Larger than the ball, so that it is constant to its boundary.
    let bounds = Aabb {
        min: BOX.min * 1.5,
        max: BOX.max * 1.5,
    };
    let grid = DenseGrid::new([5, 4, 3], bounds, vec![2.0; 60]).expect("a grid");
    let grid = GridMedium::new(grid, per_density(sigma_a, sigma_s), phase(-0.5));
    let grid = ball(grid.expect("a medium"));
    let even = ball(fog(sigma_a * 2.0, sigma_s * 2.0, -0.5));
    let run = |seed| Run {
        passes: tier.passes([80, 1_600]),
        samples: 1,
        seed,
    };
    let mut figures = Figures::default();
    for blur in [Blur::Disc, Blur::Ball] {
        let method = fixed(0.1).paths(2_000).blur(blur);
        let expected = run(1).measure(&even, &method);
        for (seed, transmittance) in [(2, TABLE), (3, FLIGHTS)] {
            let found = run(seed).measure(&grid, &method.transmittance(transmittance));
            for (c, (a, b)) in expected.iter().zip(found).enumerate() {
                figures.same(
                    format!("{blur:?} {transmittance:?} {c}"),
                    *a,
                    b,
                    tier.precision(0.04),
                );
            }
        }
    }
    figures.check(FALSE_ALARM);
}

#[test]
fn smoke_is_that_of_the_path_tracer() {
    let density = plume([24, 24, 24], BOX, 3).expect("a plume");
    let coefficients = per_density(Rgb::new(0.5, 0.1, 0.2), Rgb::new(2.0, 5.0, 9.0));
    let smoke = GridMedium::new(density, coefficients, phase(0.4)).expect("a medium");
    let host = ball(smoke);
    let expected = measure_mean(&host, &Path::new(), 1_500, 7);
    let mut figures = Figures::default();
    for (blur, transmittance) in [(Blur::Disc, TABLE), (Blur::Ball, FLIGHTS)] {
        let method = |r: f32| {
            fixed(r)
                .paths(6_000)
                .blur(blur)
                .transmittance(transmittance)
        };
        let run = |seed| Run {
            passes: 40,
            samples: 1,
            seed,
        };
        let small = run(1).measure(&host, &method(0.04));
        let large = run(2).measure(&host, &method(0.08));
        for c in 0..3 {
            let found = extrapolated(small[c], large[c], 2);
            figures.same(
                format!("{blur:?} {transmittance:?} {c}"),
                expected[c],
                found,
                0.06,
            );
        }
    }
    figures.check(FALSE_ALARM);
}

#[test]
fn the_error_of_tables_is_reported() {
    use std::sync::atomic::AtomicBool;
    use tyndall_core::{Integrator, PassContext, Sensor};
    let density = plume([24, 24, 24], BOX, 3).expect("a plume");
    let coefficients = per_density(Rgb::default(), Rgb::new(2.0, 5.0, 9.0));
    let host = ball(GridMedium::new(density, coefficients, phase(0.0)).expect("a medium"));
    let reported = |max_error: f32| {
        let method = BeamRadiance::new().paths(2_000);
        let method = method.transmittance(Transmittance::Table { max_error });
        let streams = tyndall_driver::PassStreams::new(1, 0);
        let running = AtomicBool::new(false);
        let cx = PassContext::new(0, &streams, &running);
        let pass = method.begin_pass(&host, &cx, None).expect("a pass");
        assert_eq!(pass.transmittance_error(), 0.0);
        let mut sampler = tyndall_testkit::rng(1);
        for px in 0..8 {
            let ray = host.sensor_ray([px, px], [0.5; 4]);
            method.estimate(&host, &pass, &mut (), &ray, &mut sampler);
        }
        pass.transmittance_error()
    };
    let [coarse, fine] = [1e-2, 1e-4].map(reported);
    assert!(coarse > 1e-4 && coarse <= 1e-2, "{coarse}");
    assert!(fine > 0.0 && fine <= 1e-4, "{fine}");
}
