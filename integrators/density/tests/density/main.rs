//! Density estimation against closed forms and quadrature.

mod exponential;
mod kernel;
mod lines;
mod medium;
mod schedule;
mod statistics;
mod surface;
