//! Photon beams. Statistical tests have fixed seeds and fail a right integrator with probability
//! [`FALSE_ALARM`] each.

mod agreement;
mod bias;
mod closed_form;
mod conformance;
mod extremes;
mod heterogeneous;
mod progressive;
mod widths;

use tyndall_core::{Coefficients, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_photon_beams::{Estimate, PhotonBeams};

const FALSE_ALARM: f64 = 1e-4;

/// Radii that do not shrink, the same for beams and for photons: what is expected is known.
fn fixed(estimate: Estimate, radius: f32) -> PhotonBeams {
    PhotonBeams::new()
        .estimator(estimate)
        .beam_radius(radius)
        .radius(radius)
        .surface_radius(radius)
        .alpha(1.0)
}

fn fog<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    Homogeneous::new(coefficients, phase(g)).expect("valid coefficients")
}

fn phase(g: f32) -> Phase {
    match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).expect("a valid mean cosine"),
    }
}
