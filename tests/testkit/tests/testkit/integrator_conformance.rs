//! A right integrator passes the conformance checks; each defect is found by its check.

use glam::Vec3;
use std::sync::atomic::{AtomicU32, Ordering};
use tyndall_core::{
    Coefficients, HostTypes, Integrator, PassContext, PassError, Rgb, Sampler, SensorRay, Spectrum,
    Streams,
};
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::Path;
use tyndall_testkit::hosts::{AnalyticHost, Interface, View};
use tyndall_testkit::{conformance, integrator_conformance};

type Furnace<S> = AnalyticHost<Homogeneous<S>>;

/// A ball of fog of radius `scale` whose coefficients fit the radius `thinned`.
fn ball<S: Spectrum>(scale: f32, thinned: f32) -> Furnace<S> {
    let coefficients = Coefficients {
        sigma_a: S::splat(0.1 / thinned),
        sigma_s: S::splat(0.7 / thinned),
        emission: S::default(),
    };
    let phase = Phase::henyey_greenstein(0.5).unwrap();
    let medium = Homogeneous::new(coefficients, phase).unwrap();
    let view = View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -3.0 * scale),
        forward: Vec3::Z,
        half_width: 0.5,
        pixels: 20,
    };
    AnalyticHost::furnace(medium, scale, Interface::Matched, view)
}

integrator_conformance! {
    name: path_in_fog,
    integrator: Path::new(),
    host: |scale: f32| ball::<Rgb>(scale, scale),
}

/// An integrator that knows the ray and one random number.
struct Stub<F>(F);

impl<H: HostTypes, F: Fn(&SensorRay<H::Spectrum>, f32) -> H::Spectrum + Sync> Integrator<H>
    for Stub<F>
{
    type Pass = ();
    type Pixel = ();

    fn begin_pass<R: Streams>(
        &self,
        _: &H,
        _: &PassContext<'_, R>,
        _: Option<()>,
    ) -> Result<(), PassError> {
        Ok(())
    }

    fn estimate(
        &self,
        _: &H,
        (): &(),
        (): &mut (),
        ray: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        (self.0)(ray, sampler.next_1d())
    }
}

fn fog(scale: f32) -> Furnace<f32> {
    ball(scale, scale)
}

#[test]
fn a_shared_counter_is_found() {
    let counter = AtomicU32::new(0);
    let stub = Stub(|_: &SensorRay<f32>, _| counter.fetch_add(1, Ordering::Relaxed) as f32);
    let why = conformance::determinism(&stub, fog).unwrap_err();
    assert!(why.contains("on one thread"), "{why}");
}

#[test]
fn a_rare_nan_is_found() {
    let stub = Stub(|_: &SensorRay<f32>, u| if u < 1e-3 { f32::NAN } else { u });
    let why = conformance::finiteness(&stub, fog).unwrap_err();
    assert!(why.contains("not finite"), "{why}");
    let black = Stub(|_: &SensorRay<f32>, _| 0.0);
    let why = conformance::finiteness(&black, fog).unwrap_err();
    assert!(why.contains("black"), "{why}");
}

/// An absolute length in the integrator.
#[test]
fn an_absolute_length_is_found() {
    let stub = Stub(|ray: &SensorRay<f32>, u| u * (1.0 - (-ray.ray.origin.length()).exp()));
    let why = conformance::scale_invariance(&stub, fog).unwrap_err();
    assert!(why.contains("scale 0.001"), "{why}");
}

/// The same in the host: a coefficient that does not follow the scale.
#[test]
fn a_coefficient_left_as_it_is_is_found() {
    let host = |scale| ball::<f32>(scale, 1.0);
    conformance::scale_invariance(&Path::new(), host).unwrap_err();
}
