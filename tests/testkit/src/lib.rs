//! Analytic hosts, statistical tests and conformance macros for hosts and integrators of Tyndall.
