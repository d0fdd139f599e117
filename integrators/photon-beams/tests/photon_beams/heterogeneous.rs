//! Media that are not the same everywhere.

use crate::{FALSE_ALARM, fixed, fog, phase};
use glam::Vec3;
use tyndall_core::{Aabb, Coefficients, Medium, Rgb};
use tyndall_media::{DenseGrid, GridMedium, plume};
use tyndall_path::Path;
use tyndall_photon_beams::{Estimate, Extent, PhotonBeams, Transmittance};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::stats::{Figures, extrapolated};
use tyndall_testkit::{Run, Tier, in_both_tiers, measure_mean};

const BOX: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};
const TABLE: Transmittance = Transmittance::Table { max_error: 1e-3 };
const FLIGHTS: Transmittance = Transmittance::Tracking { flights: 4 };

in_both_tiers! {
    a_constant_grid_is_a_homogeneous_medium,
    smoke_is_that_of_the_path_tracer,
}

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

/// How light and sight find their transmittance, and by which estimator they meet.
fn methods(radius: f32) -> Vec<(String, PhotonBeams)> {
    let mut methods = Vec::new();
    for (estimate, light, transmittance) in [
        (Estimate::BeamBeam1D, Extent::Long, TABLE),
        (Estimate::BeamBeam1D, Extent::Long, FLIGHTS),
        (Estimate::BeamBeam1D, Extent::Short, TABLE),
        (Estimate::BeamBeam2DRay, Extent::Long, TABLE),
        (Estimate::BeamBeam2DBeam, Extent::Short, FLIGHTS),
        (Estimate::BeamBeam3D, Extent::Long, TABLE),
        (Estimate::BeamPoint2D, Extent::Long, TABLE),
        (Estimate::PointBeam2D, Extent::Long, TABLE),
    ] {
        let method = fixed(estimate, radius).paths(600);
        let method = method.light_beams(light).transmittance(transmittance);
        methods.push((format!("{estimate} {light} {transmittance:?}"), method));
    }
    methods
}

fn a_constant_grid_is_a_homogeneous_medium(tier: Tier) {
    let (sigma_a, sigma_s) = (Rgb::new(0.1, 0.3, 0.0), Rgb::new(0.5, 0.8, 1.5));
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
        passes: tier.passes([16, 1_200]),
        samples: 1,
        seed,
    };
    let mut figures = Figures::default();
    for (name, method) in methods(0.1) {
        let expected = run(1).measure(&even, &method);
        let found = run(2).measure(&grid, &method);
        for (c, (a, b)) in expected.iter().zip(found).enumerate() {
            figures.same(format!("{name}, {c}"), *a, b, tier.precision(0.1));
        }
    }
    figures.check(FALSE_ALARM);
}

fn smoke_is_that_of_the_path_tracer(tier: Tier) {
    let density = plume([24, 24, 24], BOX, 3).expect("a plume");
    let coefficients = per_density(Rgb::new(0.5, 0.1, 0.2), Rgb::new(2.0, 3.0, 5.0));
    let smoke = GridMedium::new(density, coefficients, phase(0.4)).expect("a medium");
    let host = ball(smoke);
    let expected = measure_mean(&host, &Path::new(), tier.passes([600, 20_000]), 7);
    let run = |seed| Run {
        passes: tier.passes([16, 1_500]),
        samples: 1,
        seed,
    };
    let mut figures = Figures::default();
    let [narrow, wide] = [0.05, 0.1].map(methods);
    for ((name, narrow), (_, wide)) in narrow.into_iter().zip(wide) {
        if tier == Tier::Short && name.contains("point") {
            continue; // long to march, and noisy
        }
        let narrow = run(1).measure(&host, &narrow);
        let wide = run(2).measure(&host, &wide);
        for c in 0..3 {
            let found = extrapolated(narrow[c], wide[c], 2);
            let precision = if tier == Tier::Short { 0.15 } else { 0.02 };
            figures.same(format!("{name}, {c}"), expected[c], found, precision);
        }
    }
    figures.check(FALSE_ALARM);
}
