//! One suite that every backend passes.

mod edge_cases;
mod errors;
mod hits;
mod instances;
mod leave;
mod random;
mod reference;
mod sampling;
mod scenes;
mod surface;
mod watertight;

use tyndall_surface::{Backend, Shape, Surfaces};

const BACKENDS: &[Backend] = &[
    Backend::Embedded,
    #[cfg(feature = "embree")]
    Backend::Embree,
];

/// The shapes under every backend.
fn built(shapes: &[Shape]) -> impl Iterator<Item = (Backend, Surfaces)> {
    BACKENDS.iter().map(move |&backend| {
        let surfaces = Surfaces::build(shapes.to_vec(), backend);
        (backend, surfaces.expect("the shapes are valid"))
    })
}
