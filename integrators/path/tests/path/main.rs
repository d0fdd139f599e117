//! The path tracer against closed forms, and at the edges of what it takes.

mod closed_form;
mod conformance;
mod extremes;
mod grid;
mod overlap;
