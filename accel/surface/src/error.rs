//! What is wrong with a list of shapes.

use thiserror::Error;

/// Why surfaces could not be built. `shape` is the index in the list of shapes.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A vector or a number of the shape is NaN, infinite or beyond 1e18.
    #[error("shape {shape}: {field} {index} is not finite or larger than 1e18; correct it")]
    NotFinite {
        /// The shape.
        shape: usize,
        /// The field of the shape.
        field: &'static str,
        /// Which element of the field, 0 if it has but one.
        index: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error(
        "shape {shape}: triangle {triangle} refers to vertex {vertex}, but there are {vertices}; \
         indices start at 0"
    )]
    Index {
        /// The shape.
        shape: usize,
        /// The triangle.
        triangle: usize,
        /// Its faulty index.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A vertex attribute is neither empty nor one a vertex.
    #[error("shape {shape}: {found} {field} for {vertices} vertices; give one each, or none")]
    Attribute {
        /// The shape.
        shape: usize,
        /// The attribute.
        field: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        vertices: usize,
    },
    /// A radius is zero or negative.
    #[error("shape {shape}: the radius is {radius}; make it positive or leave the shape out")]
    Radius {
        /// The shape.
        shape: usize,
        /// Its radius.
        radius: f32,
    },
    /// A quad has no area.
    #[error("shape {shape}: edge_u and edge_v must be neither zero nor parallel")]
    Edges {
        /// The shape.
        shape: usize,
    },
    /// A disc has no normal.
    #[error("shape {shape}: the normal is zero; any length but zero will do")]
    Normal {
        /// The shape.
        shape: usize,
    },
    /// The transformation of an instance has no inverse.
    #[error(
        "shape {shape}: to_world flattens the mesh (determinant {determinant:e}); make its axes \
         independent and its scales other than zero, or leave the instance out"
    )]
    Flat {
        /// The shape.
        shape: usize,
        /// Determinant of the linear part.
        determinant: f64,
    },
    /// An instance puts its mesh beyond 1e18, or is so flat that its own box reaches as far in the
    /// coordinates of the mesh.
    #[error(
        "shape {shape}: to_world takes the mesh beyond 1e18, or its inverse the box around the \
         instance; correct its scale and translation"
    )]
    Range {
        /// The shape.
        shape: usize,
    },
    /// More primitives than 32 bits can count.
    #[error("{primitives} primitives; split the scene, 4294967295 is the limit")]
    TooMany {
        /// How many there are.
        primitives: usize,
    },
    /// Embree gave up.
    #[cfg(feature = "embree")]
    #[error("Embree: {message}")]
    Embree {
        /// In its own words.
        message: String,
    },
}
