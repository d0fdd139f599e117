//! The media, their phase functions and the grids that fill them.

mod atmosphere;
mod fire;
mod grid;
mod homogeneous;
mod overlap;
mod phase;
mod procedural;
mod sparse;
mod sparse_extremes;
mod sparse_faces;
mod sparse_faults;
mod sparse_medium;
mod tracking;
mod support {
    pub(crate) mod rays;
    pub(crate) mod sparse;
}
