//! What every integrator must hold, held by progressive photon mapping.

use tyndall_core::{Coefficients, Rgb, Spectrum};
use tyndall_media::{Homogeneous, Phase};
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};
use tyndall_testkit::integrator_conformance;

/// Fog of albedo 0.8 and σt 1.5 per unit of `scale`; it glows.
fn glow<S: Spectrum>(scale: f32, g: f32) -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a: S::from_channels(|i| 0.3 / scale * (1.0 + i as f32)),
        sigma_s: S::splat(1.2 / scale),
        emission: S::splat(0.2 / scale),
    };
    let phase = Phase::henyey_greenstein(g).expect("a valid mean cosine");
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}

integrator_conformance! {
    name: background_by_photons,
    integrator: ProgressivePhotonMap::new().paths(2_000),
    host: |scale: f32| AnalyticHost::furnace(glow::<f32>(scale, 0.5), scale, Interface::Matched, view(scale)),
}

integrator_conformance! {
    name: glass_by_statistics,
    integrator: ProgressivePhotonMap::new().paths(2_000).radii(Radii::Statistics),
    host: |scale: f32| AnalyticHost::furnace(glow::<Rgb>(scale, -0.4), scale, Interface::Dielectric(1.4), view(scale)),
}

integrator_conformance! {
    name: point_light_sampled,
    integrator: ProgressivePhotonMap::sampling_lights().paths(2_000),
    host: |scale: f32| AnalyticHost::sphere(glow::<Rgb>(scale, 0.7), scale, Interface::Matched, lamp(scale), view(scale)),
}

integrator_conformance! {
    name: point_light_sampled_by_statistics,
    integrator: ProgressivePhotonMap::sampling_lights().paths(2_000).radii(Radii::Statistics),
    host: |scale: f32| AnalyticHost::sphere(glow::<f32>(scale, 0.2), scale, Interface::Matched, lamp(scale), view(scale)),
}
