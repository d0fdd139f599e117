//! The light around a street lamp in fog, pass after pass: the error falls against a closed form.
//!
//!     cargo run -p tyndall-progressive-photon-map --example converging

#![expect(clippy::print_stdout, reason = "an example speaks")]

use glam::Vec3;
use std::error::Error;
use tyndall_core::{Coefficients, Ray};
use tyndall_driver::{Budget, Render};
use tyndall_media::{Homogeneous, Phase};
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_testkit::closed_form::airlight;
use tyndall_testkit::hosts::{AnalyticHost, View};

/// Of the light that meets the fog, what is scattered: so little that nothing scatters twice.
const ALBEDO: f32 = 1e-4;

fn main() -> Result<(), Box<dyn Error>> {
    let fog = Coefficients {
        sigma_a: 1.0 - ALBEDO,
        sigma_s: ALBEDO,
        emission: 0.0,
    };
    let fog = Homogeneous::new(fog, Phase::Isotropic)?;
    let heights: Vec<f32> = (0..256).map(|i| 0.5 + 0.006 * i as f32).collect();
    let rays = (0..256).zip(&heights).map(|(i, h)| {
        let (sin, cos) = (2.4 * i as f32).sin_cos(); // each on its own side of the lamp
        Ray::new(Vec3::new(h * cos, h * sin, -1.0), Vec3::Z)
    });
    let host = AnalyticHost::infinite_medium(fog, Vec3::ZERO, 1.0, View::Rays(rays.collect()));
    let albedo = f64::from(ALBEDO);
    let closed_form = |h: &f32| airlight(albedo, 1.0, f64::from(*h), 1.0, f64::INFINITY);
    let light: Vec<f64> = heights.iter().map(closed_form).collect();
    let brightest = light[0];
    for radii in [Radii::Memoryless, Radii::Statistics] {
        let method = ProgressivePhotonMap::new()
            .paths(1_000)
            .starting_paths(1_000)
            .radii(radii);
        println!("{radii:?}\npasses  error, of the brightest ray");
        Render::new(&host, &method).run(Budget::Passes(512), |progress| {
            let film = progress.snapshot.film();
            if film.passes().is_power_of_two() {
                let squares = film.mean().iter().zip(&light).map(|(a, b)| (a - b).powi(2));
                let error = (squares.sum::<f64>() / light.len() as f64).sqrt();
                println!("{:>6}  {:.4}", film.passes(), error / brightest);
            }
        })?;
    }
    Ok(())
}
