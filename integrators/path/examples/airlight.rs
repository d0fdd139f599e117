//! The glow around a street lamp in fog: single scattering against its closed form.
//!
//!     cargo run -p tyndall-path --example airlight

#![expect(clippy::print_stdout, reason = "an example speaks")]

use glam::Vec3;
use tyndall_core::{Coefficients, Ray};
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::{Path, Scattering};
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::{closed_form::airlight, measure};

fn main() -> Result<(), tyndall_media::MediumError> {
    let fog = Coefficients {
        sigma_a: 0.1,
        sigma_s: 0.5,
        emission: 0.0,
    };
    let fog = Homogeneous::new(fog, Phase::Isotropic)?;
    let heights = [0.1, 0.3, 1.0, 3.0];
    let rays = heights.map(|h| Ray::new(Vec3::new(0.0, h, -2.0), Vec3::Z));
    let host = AnalyticHost::infinite_medium(fog, Vec3::ZERO, 1.0, View::Rays(rays.to_vec()));
    let path = Path::new().scattering(Scattering::Single);
    for (h, estimate) in heights.into_iter().zip(measure(&host, &path, 10_000, 1)) {
        let expected = airlight(0.5, 0.6, f64::from(h), 2.0, f64::INFINITY);
        println!(
            "{h:>4} beside the lamp: {:.4e} ± {:.0e}, closed form {expected:.4e}",
            estimate.mean, estimate.standard_error
        );
    }
    Ok(())
}
