//! What passes leave to the next, and renders in parts.

use crate::closed_form::floor;
use crate::{alone, fog};
use glam::Vec3;
use tyndall_core::{Integrator, Sensor, StateError};
use tyndall_driver::{Budget, Film, Render, Snapshot};
use tyndall_media::Homogeneous;
use tyndall_progressive_photon_map::{Pixel, ProgressivePhotonMap, Radii};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};

type Host = AnalyticHost<Homogeneous<f32>>;

fn ball() -> Host {
    let light = Light::Point {
        position: Vec3::new(0.5, 2.0, 0.3),
        power: 30.0,
    };
    let view = View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -3.0),
        forward: Vec3::Z,
        half_width: 0.4,
        pixels: 18,
    };
    AnalyticHost::sphere(fog(0.2, 1.5, 0.3), 1.0, Interface::Matched, light, view)
}

fn method(radii: Radii) -> ProgressivePhotonMap {
    ProgressivePhotonMap::new().paths(500).radii(radii)
}

/// Through bytes, as between two processes.
fn carried(snapshot: &Snapshot<f32>) -> Snapshot<f32> {
    let bytes = postcard::to_stdvec(snapshot).expect("bytes");
    postcard::from_bytes(&bytes).expect("a snapshot")
}

fn resumes_exactly<H: Sensor<Spectrum = f32>>(host: &H, method: &ProgressivePhotonMap)
where
    ProgressivePhotonMap: Integrator<H>,
{
    alone().install(|| {
        let render = || Render::new(host, method).seed(3);
        let whole: Film<f32> = render().run(Budget::Passes(9), |_| {}).expect("a film");
        assert!(whole.mean().iter().any(|v| *v > 0.0));
        for passes in [1, 4] {
            let part = render()
                .advance(Budget::Passes(passes), |_| {})
                .expect("a part");
            let resumed = render()
                .resume(carried(&part))
                .run(Budget::Passes(9), |_| {});
            assert!(resumed.expect("a film") == whole, "{passes} passes");
        }
    });
}

#[test]
fn a_resumed_render_has_the_bits_of_one_that_was_not() {
    for radii in [Radii::Memoryless, Radii::Statistics] {
        resumes_exactly(&ball(), &method(radii));
        resumes_exactly(&floor(1.0), &method(radii));
    }
}

/// The last passes without the first are the same passes: merged, they are the whole but for
/// rounding.
#[test]
fn memoryless_passes_run_anywhere() {
    let (host, method) = (ball(), method(Radii::Memoryless));
    let run = |from, passes| {
        let render = Render::new(&host, &method).seed(3).first_pass(from);
        let film = alone().install(|| render.run(Budget::Passes(passes), |_| {}));
        film.expect("a film")
    };
    let whole = run(0, 7);
    let mut merged = run(4, 3);
    merged.merge(&run(0, 4)).expect("the same size");
    for (a, b) in merged.mean().iter().zip(whole.mean()) {
        assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} is not {b}");
    }
}

#[test]
fn a_damaged_memory_is_refused() {
    let method = method(Radii::Statistics);
    let restore = |mut bytes: &[u8]| Integrator::<Host>::restore_pixel(&method, &mut bytes);
    let mut saved = Vec::new();
    let mut pixel = Pixel::default();
    (pixel.media.radius, pixel.media.count) = (0.25, 7.5);
    Integrator::<Host>::save_pixel(&method, &pixel, &mut saved).expect("bytes");
    assert_eq!(restore(&saved), Ok(pixel));
    assert_eq!(restore(&saved[..31]), Err(StateError::Corrupt));
    for wrong in [f64::NAN, f64::INFINITY, -1.0] {
        saved[8..16].copy_from_slice(&wrong.to_le_bytes());
        assert_eq!(restore(&saved), Err(StateError::Corrupt));
    }
}

#[test]
fn photons_of_a_pass_are_bounded() {
    use tyndall_core::PassError;
    use tyndall_driver::RenderError;
    let host = ball();
    let method = method(Radii::Memoryless).max_bytes(1_000);
    let refused = Render::new(&host, &method).run(Budget::Passes(1), |_| {});
    match refused {
        Err(RenderError::Pass(PassError::Memory { needed, allowed })) => {
            assert!(needed > allowed && allowed == 1_000);
        }
        other => panic!("{other:?}"),
    }
}
