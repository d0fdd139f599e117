//! What every integrator must hold.

use crate::support::phase;
use glam::Vec3;
use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::Homogeneous;
use tyndall_photon_map::{Kernel, PhotonMap};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
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

fn view(scale: f32) -> View {
    View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -3.0 * scale),
        forward: Vec3::Z,
        half_width: 0.4,
        pixels: 17,
    }
}

/// A light whose radiance does not depend on the scale: flux grows with the area.
fn lamp<S: Spectrum>(scale: f32) -> Light<S> {
    Light::Point {
        position: Vec3::new(0.5, 2.0, 0.3) * scale,
        power: S::splat(30.0 * scale * scale),
    }
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
    integrator: PhotonMap::new().paths(1500).nearest(20),
    host: |scale: f32| AnalyticHost::furnace(fog::<f32>(scale, 0.5), scale, Interface::Matched, view(scale)),
}

integrator_conformance! {
    name: by_photons_through_glass,
    integrator: PhotonMap::new().paths(1500).nearest(30).kernel(Kernel::Gaussian).step(0.3),
    host: |scale: f32| AnalyticHost::sphere(fog::<Rgb>(scale, -0.4), scale, Interface::Dielectric(1.4), beam(scale), view(scale)),
}

integrator_conformance! {
    name: sampling_lights_rgb,
    integrator: PhotonMap::sampling_lights().paths(3000).nearest(20).kernel(Kernel::Cone),
    host: |scale: f32| AnalyticHost::sphere(fog::<Rgb>(scale, 0.7), scale, Interface::Matched, lamp(scale), view(scale)),
}

integrator_conformance! {
    name: sampling_lights_grey,
    integrator: PhotonMap::sampling_lights().paths(1500).min_steps(3),
    host: |scale: f32| AnalyticHost::sphere(fog::<f32>(scale, -0.9), scale, Interface::Matched, beam(scale), view(scale)),
}
