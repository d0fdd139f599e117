//! What every integrator must hold, held by the path tracer.

use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::{Path, Scattering};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};
use tyndall_testkit::integrator_conformance;

/// Fog of albedo 0.8 and σt 1.5 per unit of `scale`; it glows.
fn fog<S: Spectrum>(scale: f32, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a: S::from_channels(|i| 0.3 / scale * (1.0 + i as f32)),
        sigma_s: S::splat(1.2 / scale),
        emission: S::splat(0.2 / scale),
    };
    let phase = Phase::henyey_greenstein(g).expect("a valid mean cosine");
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}

integrator_conformance! {
    name: background_grey,
    integrator: Path::new(),
    host: |scale: f32| AnalyticHost::furnace(fog::<f32>(scale, 0.5), scale, Interface::Matched, view(scale)),
}

integrator_conformance! {
    name: background_glass,
    integrator: Path::new().max_depth(12),
    host: |scale: f32| AnalyticHost::furnace(fog::<Rgb>(scale, -0.4), scale, Interface::Dielectric(1.4), view(scale)),
}

integrator_conformance! {
    name: point_light,
    integrator: Path::new(),
    host: |scale: f32| AnalyticHost::sphere(fog::<Rgb>(scale, 0.7), scale, Interface::Matched, lamp(scale), view(scale)),
}

integrator_conformance! {
    name: single_scattering_unhittable,
    integrator: Path::with_unhittable_lights().scattering(Scattering::Single),
    host: |scale: f32| AnalyticHost::sphere(fog::<f32>(scale, 0.2), scale, Interface::Matched, lamp(scale), view(scale)),
}
