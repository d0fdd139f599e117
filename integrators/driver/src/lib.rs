//! Passes, film, budget and progress for integrators, on all cores.
