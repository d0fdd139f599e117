//! Photon mapping against what every integrator must hold, against light in closed form, and where
//! numbers run out.
//!
//! False alarms: what is compared by statistics is a t-test at 0.27 % a test (three standard errors
//! of a normal distribution), Šidák-corrected within it. Seeds are fixed.

mod closed_form;
mod conformance;
mod extremes;
mod furnace;
mod marching;
mod once;
mod support;
mod surfaces;
