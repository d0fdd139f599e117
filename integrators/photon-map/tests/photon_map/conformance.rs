//! What every integrator must hold.
//!
//! Pixels of a pass share its photons, and `scale_invariance` takes them for independent: so the
//! noise of the march, one point a segment, is several times that of 3000 light paths.

use crate::support::phase;
use glam::Vec3;
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::Homogeneous;
use tyndall_photon_map::{Kernel, PhotonMap};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light};
use tyndall_testkit::integrator_conformance;

/// Fog of σt 1.5 and more per unit of `scale`; it glows.
fn fog<S: Spectrum>(scale: f32, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a: S::from_channels(|i| 0.3 / scale * (1.0 + i as f32)),
        sigma_s: S::splat(1.2 / scale),
        emission: S::splat(0.2 / scale),
    };
    Homogeneous::new(coefficients, phase(g)).expect("valid coefficients")
}

fn beam<S: Spectrum>(scale: f32) -> Light<S> {
    Light::Beam {
        center: Vec3::new(0.0, 2.0, 0.0) * scale,
        direction: Vec3::NEG_Y,
        radius: 0.4 * scale,
        irradiance: S::splat(3.0),
    }
}

integrator_conformance! {
    name: by_photons_grey,
    integrator: PhotonMap::new().paths(3000).nearest(20).step(4.0).min_steps(1),
    host: |scale: f32| AnalyticHost::furnace(fog::<f32>(scale, 0.5), scale, Interface::Matched, view(scale)),
}

integrator_conformance! {
    name: by_photons_through_glass,
    integrator: PhotonMap::new().paths(3000).nearest(30).kernel(Kernel::Gaussian).step(4.0).min_steps(1),
    host: |scale: f32| AnalyticHost::sphere(fog::<Rgb>(scale, -0.4), scale, Interface::Dielectric(1.4), beam(scale), view(scale)),
}

integrator_conformance! {
    name: sampling_lights_rgb,
    integrator: PhotonMap::sampling_lights().paths(3000).nearest(20).kernel(Kernel::Cone).step(4.0).min_steps(1),
    host: |scale: f32| AnalyticHost::sphere(fog::<Rgb>(scale, 0.7), scale, Interface::Matched, lamp(scale), view(scale)),
}

integrator_conformance! {
    name: sampling_lights_grey,
    integrator: PhotonMap::sampling_lights().paths(3000).nearest(100).step(4.0).min_steps(1),
    host: |scale: f32| AnalyticHost::sphere(fog::<f32>(scale, -0.9), scale, Interface::Matched, beam(scale), view(scale)),
}
