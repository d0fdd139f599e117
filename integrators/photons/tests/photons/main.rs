//! Photon maps and what is gathered of them. False alarms: 1e-4 a test, fixed seeds.

mod fluence;
mod lost;
mod reach;
mod search;
mod surfaces;

use std::sync::atomic::AtomicBool;
use tyndall_core::{Geometry, LightEmission, Media, PassContext, Shading};
use tyndall_driver::PassStreams;
use tyndall_photons::{Emission, PhotonMaps};
use tyndall_walk::DirectLight;

const FALSE_ALARM: f64 = 1e-4;

/// The photons of a pass of so many paths.
fn maps<H, D>(host: &H, pass: u64, paths: u64) -> PhotonMaps<H::Spectrum>
where
    H: Geometry + Shading + Media + LightEmission,
    D: DirectLight<H>,
{
    let (streams, running) = (PassStreams::new(1, pass), AtomicBool::new(false));
    let cx = PassContext::new(pass, &streams, &running);
    let emission = Emission {
        paths,
        ..Emission::default()
    };
    PhotonMaps::trace::<H, D, _>(host, &cx, emission).expect("photons")
}
