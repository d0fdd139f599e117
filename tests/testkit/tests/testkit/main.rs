//! Closed forms, hosts, statistical tests and conformance checks: the right pass, each defect is found.

mod closed_form;
mod host_conformance;
mod hosts;
mod integrator_conformance;
mod statistics;
