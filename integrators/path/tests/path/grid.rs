//! The path tracer in grids. False alarms: 0.27 % a test (three standard errors of a normal
//! distribution), Šidák-corrected within it; fixed seeds.

use glam::Vec3;
use tyndall_core::{Aabb, Coefficients, Medium, Rgb, Spectrum};
use tyndall_media::{DenseGrid, GridMedium, Homogeneous, Phase, Precision, SparseGrid, plume};
use tyndall_path::Path;
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::measure_mean;
use tyndall_testkit::stats::check_means;

const FALSE_ALARM: f64 = 0.0027;
const BOX: Aabb = Aabb {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

fn per_density(sigma_a: Rgb, sigma_s: Rgb) -> Coefficients<Rgb> {
    Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    }
}

fn view(distance: f32) -> View {
    View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -distance),
        forward: Vec3::Z,
        half_width: 0.4,
        pixels: 4,
    }
}

#[test]
fn the_furnace_is_white_in_smoke() {
    let density = plume([24, 24, 24], BOX, 3).expect("a plume");
    let scattering = per_density(Rgb::default(), Rgb::new(2.0, 9.0, 30.0));
    let phase = Phase::henyey_greenstein(0.6).expect("a valid mean cosine");
    let smoke = GridMedium::new(density, scattering, phase).expect("a medium");
    furnace(&smoke);
}

#[test]
fn the_furnace_is_white_in_sparse_smoke() {
    let density = plume([24, 24, 24], BOX, 3).expect("a plume");
    let density = SparseGrid::from_dense(&density, Precision::Half).expect("a grid");
    let scattering = per_density(Rgb::default(), Rgb::new(2.0, 9.0, 30.0));
    let phase = Phase::henyey_greenstein(0.6).expect("a valid mean cosine");
    furnace(&GridMedium::new(density, scattering, phase).expect("a medium"));
}

fn furnace<M: Medium<Spectrum = Rgb> + Clone>(smoke: &M) {
    let mut figures = Vec::new();
    for (name, interface, inside) in [
        ("matched", Interface::Matched, 1.0),
        ("glass", Interface::Dielectric(1.5), 2.25),
    ] {
        for (distance, expected) in [(2.0, 1.0), (0.3, inside)] {
            let host = AnalyticHost::furnace(smoke.clone(), 1.0, interface, view(distance));
            for (i, estimate) in measure_mean(&host, &Path::new(), 22_000, 1)
                .into_iter()
                .enumerate()
            {
                let precision = estimate.relative_standard_error();
                assert!(precision <= 0.003, "{name} {distance}: {precision:.4}");
                figures.push((format!("{name} {distance} channel {i}"), estimate, expected));
            }
        }
    }
    let cases: Vec<_> = figures
        .iter()
        .map(|(n, e, x)| (n.as_str(), *e, *x))
        .collect();
    check_means(&cases, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn a_constant_grid_is_a_homogeneous_medium() {
    let (sigma_a, sigma_s) = (Rgb::new(0.1, 0.4, 0.0), Rgb::new(0.9, 1.6, 3.0));
    let phase = Phase::henyey_greenstein(-0.5).expect("a valid mean cosine");
    let grid = DenseGrid::new([5, 4, 3], BOX, vec![2.0; 60]).expect("a grid");
    let grid = GridMedium::new(grid, per_density(sigma_a, sigma_s), phase.clone());
    let even = Homogeneous::new(per_density(sigma_a * 2.0, sigma_s * 2.0), phase);
    let light = Light::Background {
        radiance: Rgb::new(1.0, 3.0, 2.0),
        reach: 1.01,
    };
    let matched = Interface::Matched;
    let passes = 120_000;
    let grid = AnalyticHost::sphere(grid.expect("a medium"), 1.0, matched, light, view(3.0));
    let even = AnalyticHost::sphere(even.expect("a medium"), 1.0, matched, light, view(3.0));
    let grid = measure_mean(&grid, &Path::new(), passes, 1);
    let even = measure_mean(&even, &Path::new(), passes, 2);
    let differences: Vec<_> = grid
        .iter()
        .zip(&even)
        .map(|(a, b)| {
            assert!(a.relative_standard_error() < 0.003 && b.relative_standard_error() < 0.003);
            ("grid − homogeneous", a.difference(b), 0.0)
        })
        .collect();
    assert_eq!(differences.len(), Rgb::CHANNELS);
    check_means(&differences, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}

/// The same smoke, with one voxel of nothing around, in either kind of grid.
#[test]
fn sparse_smoke_is_dense_smoke() {
    let density = plume([24, 24, 24], BOX, 4).expect("a plume");
    let sparse = SparseGrid::from_dense(&density, Precision::Single).expect("a grid");
    let dense = sparse.to_dense().expect("an upright grid");
    let scattering = per_density(Rgb::new(0.5, 0.1, 1.0), Rgb::new(5.0, 10.0, 20.0));
    let phase = Phase::henyey_greenstein(0.4).expect("a valid mean cosine");
    let light = Light::Background {
        radiance: Rgb::new(1.0, 3.0, 2.0),
        reach: 1.01,
    };
    let sparse = GridMedium::new(sparse, scattering, phase.clone()).expect("a medium");
    let dense = GridMedium::new(dense, scattering, phase).expect("a medium");
    let sparse = AnalyticHost::sphere(sparse, 1.0, Interface::Matched, light, view(3.0));
    let dense = AnalyticHost::sphere(dense, 1.0, Interface::Matched, light, view(3.0));
    let sparse = measure_mean(&sparse, &Path::new(), 20_000, 1);
    let dense = measure_mean(&dense, &Path::new(), 20_000, 2);
    let differences: Vec<_> = (sparse.iter().zip(&dense))
        .map(|(a, b)| {
            assert!(a.relative_standard_error() < 0.003 && b.relative_standard_error() < 0.003);
            ("sparse − dense", a.difference(b), 0.0)
        })
        .collect();
    check_means(&differences, FALSE_ALARM).unwrap_or_else(|why| panic!("{why}"));
}
