//! Analytic hosts, statistical tests and conformance macros for hosts and integrators of Tyndall.
//!
//! - Who writes a *host* (an adapter for a renderer) calls [`host_conformance!`] on it.
//! - Who writes an *integrator* calls [`integrator_conformance!`], then lets it [`measure`] an
//!   [`hosts::AnalyticHost`] and holds the result against [`closed_form`] by
//!   [`stats::assert_mean`]. If samples of a pass share photons, [`Run`] has errors of passes,
//!   and [`in_both_tiers!`] a short and a long test of each thing.
//! - Who writes a sampler tests it by [`stats::chi2_sphere`] or [`stats::kolmogorov_smirnov`].
//!
//! Every statistical test takes or states its false-alarm rate; tolerances come from standard
//! errors, apart from [`stats::ROUNDING`] and the bounds that a check documents.
#![forbid(unsafe_code)]

pub mod closed_form;
pub mod conformance;
mod cornell_box;
pub mod hosts;
mod measure;
mod memory;
mod passes;
mod quadrature;
mod rng;
pub mod stats;
mod tier;

pub use cornell_box::cornell_box;
pub use measure::{measure, measure_mean};
pub use memory::{Bounded, check_memory};
pub use passes::{RadianceAlong, Run};
pub use rng::{TestSampler, rng};
pub use tier::Tier;
