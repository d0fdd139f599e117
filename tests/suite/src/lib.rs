//! Integrators on scenes and hosts against closed forms and against path.

/// What the README shows compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
