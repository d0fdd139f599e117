//! Density estimation against closed forms and quadrature.

mod kernel;
mod medium;
mod schedule;
mod statistics;
mod surface;
