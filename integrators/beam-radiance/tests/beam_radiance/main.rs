//! The beam radiance estimate. Statistical tests have fixed seeds and fail a right integrator with
//! probability [`FALSE_ALARM`] each.

mod closed_form;
mod conformance;
mod extremes;
mod heterogeneous;
mod progressive;
mod surfaces;

use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{Coefficients, Spectrum};
use tyndall_media::{Homogeneous, Phase};

const FALSE_ALARM: f64 = 1e-4;

/// Radii that do not shrink: what is expected is known.
fn fixed(radius: f32) -> BeamRadiance {
    BeamRadiance::new().radius(radius).alpha(1.0)
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
