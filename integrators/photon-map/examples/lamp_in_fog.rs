//! Light around a lamp in fog, scattered any number of times: photons against the closed form.
//!
//!     cargo run -p tyndall-photon-map --example lamp_in_fog

#![expect(clippy::print_stdout, reason = "an example speaks")]

use glam::Vec3;
use std::f64::consts::PI;
use tyndall_core::Coefficients;
use tyndall_media::{Homogeneous, Phase};
use tyndall_photon_map::PhotonMap;
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::{closed_form::point_source_fluence, measure};

fn main() -> Result<(), tyndall_media::MediumError> {
    let fog = Coefficients {
        sigma_a: 0.1,
        sigma_s: 0.9,
        emission: 0.0,
    };
    let fog = Homogeneous::new(fog, Phase::Isotropic)?;
    for distance in [0.1_f32, 0.3, 1.0, 3.0] {
        let view = View::Fluence {
            position: Vec3::new(0.0, 0.0, distance),
        };
        let host = AnalyticHost::infinite_medium(fog.clone(), Vec3::ZERO, 1.0, view);
        let map = PhotonMap::new().paths(1000).nearest(20);
        let estimate = measure(&host, &map, 2000, 1)[0];
        let far = f64::from(distance);
        let unscattered = (-far).exp() / (4.0 * PI * far * far);
        let expected = point_source_fluence(0.9, 1.0, far) - unscattered;
        println!(
            "{distance:>3} from the lamp: {:.4} ± {:.4}, closed form {expected:.4}",
            estimate.mean, estimate.standard_error
        );
    }
    Ok(())
}
