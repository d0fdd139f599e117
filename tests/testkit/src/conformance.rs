//! What every host and every integrator must hold, as tests in one line.
//!
//! ```
//! # use glam::Vec3;
//! # use tyndall_core::{Coefficients, Ray};
//! # use tyndall_media::{Homogeneous, Phase};
//! use tyndall_testkit::{host_conformance, hosts::{AnalyticHost, View}};
//! # fn fog() -> Homogeneous<f32> {
//! #     let c = Coefficients { sigma_a: 0.1, sigma_s: 0.5, emission: 0.0 };
//! #     Homogeneous::new(c, Phase::Isotropic).unwrap()
//! # }
//! host_conformance! {
//!     name: point_light,
//!     host: AnalyticHost::infinite_medium(
//!         fog(),
//!         Vec3::ZERO,
//!         5.0,
//!         View::Rays(vec![Ray::new(Vec3::Y, Vec3::X)]),
//!     ),
//!     power: 5.0_f32,
//! }
//! # fn main() {}
//! ```
//! makes a module `point_light` with the tests `sensor`, `geometry`, `shading`, `direct`,
//! `emission` and `power`.

mod ball;
mod direct;
mod emission;
mod geometry;
mod importance;
mod integrator;
mod probe;
mod sensor;
mod shading;

pub use ball::{lamp, view};
pub use direct::direct;
pub use emission::{emission, power};
pub use geometry::geometry;
pub use importance::importance;
pub use integrator::{determinism, finiteness, scale_invariance};
pub use sensor::sensor;
pub use shading::shading;

use tyndall_core::{EmissionPdf, Spectrum};

/// Probability that a check fails a right host or integrator by chance; shared by all the
/// statistical tests in it.
pub const FALSE_ALARM: f64 = 1e-6;

/// Relative difference allowed between two expressions for one quantity in `f32`.
const RELATIVE: f32 = 1e-3;

/// Tests of a host: one `#[test]` for each capability, in a module `name`.
///
/// - `host`: an expression, evaluated once a test.
/// - `power`: total power of its lights, a spectrum in W; adds the test that emission integrates to
///   it.
/// - `checks`: names of functions of [`conformance`](crate::conformance), for hosts that lack a
///   capability or have more. If left out, `sensor`, `geometry`, `shading`, `direct`, `emission`;
///   `importance` is for hosts whose sensor can be connected to.
///
/// Each fails a right host with probability [`FALSE_ALARM`](crate::conformance::FALSE_ALARM) at
/// the most. They take seconds at the most on a host of few surfaces. What the sensor's rays and random walks from them do
/// not reach is not tested.
#[macro_export]
macro_rules! host_conformance {
    (name: $name:ident, host: $host:expr, power: $power:expr $(,)?) => {
        $crate::host_conformance! {
            name: $name,
            host: $host,
            power: $power,
            checks: [sensor, geometry, shading, direct, emission],
        }
    };
    (name: $name:ident, host: $host:expr $(,)?) => {
        $crate::host_conformance! {
            name: $name,
            host: $host,
            checks: [sensor, geometry, shading, direct, emission],
        }
    };
    (
        name: $name:ident,
        host: $host:expr,
        $(power: $power:expr,)?
        checks: [$($check:ident),+ $(,)?] $(,)?
    ) => {
        mod $name {
            use super::*;
            $(
                #[test]
                fn $check() {
                    $crate::conformance::$check(&$host).unwrap_or_else(|why| panic!("{why}"));
                }
            )+
            $(
                #[test]
                fn power() {
                    $crate::conformance::power(&$host, $power)
                        .unwrap_or_else(|why| panic!("{why}"));
                }
            )?
        }
    };
}

/// Tests of an integrator on a host, in a module `name`: `determinism`, `finiteness`,
/// `scale_invariance`, by the functions of [`conformance`](crate::conformance).
///
/// - `integrator`: an expression.
/// - `host`: a closure from a scale s to the host with all lengths times s, all coefficients over
///   s, and lights that keep the radiance: powers times s², irradiance and radiance as they are.
///   More than 16 × 16 pixels, so that threads have something to share; none that needs rare
///   paths.
///
/// `scale_invariance` fails a right integrator with probability
/// [`FALSE_ALARM`](crate::conformance::FALSE_ALARM), the others never.
#[macro_export]
macro_rules! integrator_conformance {
    (name: $name:ident, integrator: $integrator:expr, host: $host:expr $(,)?) => {
        mod $name {
            use super::*;

            #[test]
            fn determinism() {
                $crate::conformance::determinism(&$integrator, $host)
                    .unwrap_or_else(|why| panic!("{why}"));
            }

            #[test]
            fn finiteness() {
                $crate::conformance::finiteness(&$integrator, $host)
                    .unwrap_or_else(|why| panic!("{why}"));
            }

            #[test]
            fn scale_invariance() {
                $crate::conformance::scale_invariance(&$integrator, $host)
                    .unwrap_or_else(|why| panic!("{why}"));
            }
        }
    };
}

/// Fails with a sentence unless `holds`.
fn ensure(holds: bool, sentence: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(sentence()) }
}

/// Whether two numbers differ by no more than this share; NaN and infinity do.
fn same(a: f32, b: f32, relative: f32) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs())
}

/// Whether two spectra differ by no more than this share of their largest channel.
fn same_spectrum<S: Spectrum>(a: S, b: S, relative: f32) -> bool {
    let largest = a.max_channel().max(b.max_channel());
    a.is_finite() && b.is_finite() && (a - b).map(f32::abs).max_channel() <= relative * largest
}

/// Whether both densities are the same.
fn same_emission(a: EmissionPdf, b: EmissionPdf, relative: f32) -> bool {
    same(a.pdf_a, b.pdf_a, relative) && same(a.pdf_w, b.pdf_w, relative)
}

/// Finite and not negative.
fn valid<S: Spectrum>(value: S) -> bool {
    (0..S::CHANNELS).all(|i| (0.0..f32::INFINITY).contains(&value.channel(i)))
}

fn is_unit(v: glam::Vec3) -> bool {
    (v.length_squared() - 1.0).abs() < RELATIVE
}
