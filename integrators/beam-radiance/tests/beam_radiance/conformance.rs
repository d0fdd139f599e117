//! What every integrator must hold.
//!
//! The test of scales takes pixels for independent; here they share photons. In the scenes chosen
//! most of the noise is of other origin.

use crate::fog;
use tyndall_beam_radiance::{BeamRadiance, Blur};
use tyndall_core::{Rgb, Spectrum};
use tyndall_media::Homogeneous;
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};
use tyndall_testkit::integrator_conformance;

fn haze<S: Spectrum>(scale: f32, g: f32) -> Homogeneous<S> {
    let sigma_a = S::from_channels(|i| 0.3 / scale * (1.0 + i as f32));
    fog(sigma_a, S::splat(1.2 / scale), g)
}

integrator_conformance! {
    name: discs,
    integrator: BeamRadiance::new().paths(3_000),
    host: |scale: f32| AnalyticHost::furnace(haze::<Rgb>(scale, 0.5), scale, Interface::Matched, view(scale)),
}

integrator_conformance! {
    name: balls_behind_glass,
    integrator: BeamRadiance::new().paths(3_000).blur(Blur::Ball),
    host: |scale: f32| AnalyticHost::furnace(haze::<f32>(scale, -0.3), scale, Interface::Dielectric(1.4), view(scale)),
}

integrator_conformance! {
    name: lights_sampled,
    integrator: BeamRadiance::sampling_lights().paths(3_000),
    host: |scale: f32| AnalyticHost::sphere(haze::<Rgb>(scale, 0.7), scale, Interface::Matched, lamp(scale), view(scale)),
}
