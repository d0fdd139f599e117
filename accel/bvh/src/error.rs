//! What is wrong with primitives, and with trees.

use thiserror::Error;

/// Why a tree could not be built. `index` is that of the primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate, of a box or a centre, is NaN, infinite or beyond ±1e18.
    #[error("primitive {index}: a coordinate is not finite or beyond 1e18; correct it")]
    NotFinite {
        /// The primitive.
        index: usize,
    },
    /// A box holds no point.
    #[error("primitive {index}: its box is empty; leave the primitive out")]
    Empty {
        /// The primitive.
        index: usize,
    },
    /// A radius is negative, NaN, infinite or beyond 1e18, or limits of radii leave none.
    #[error("primitive {index}: its radius is negative, not finite or beyond 1e18; correct it")]
    Radius {
        /// The primitive.
        index: usize,
    },
    /// The length of a direction is not 1 to 1e-3.
    #[error("primitive {index}: its direction is not of unit length; normalize it")]
    Direction {
        /// The primitive.
        index: usize,
    },
    /// A length is negative, NaN or infinite, or ends beyond ±1e18.
    #[error("primitive {index}: its length is negative, not finite or ends beyond 1e18; clip it")]
    Length {
        /// The primitive.
        index: usize,
    },
    /// One radius a centre is needed.
    #[error("{radii} radii for {centers} centres; give one each")]
    Lengths {
        /// Centres given.
        centers: usize,
        /// Radii given.
        radii: usize,
    },
    /// Slots are counted in 32 bits.
    #[error(
        "{count} primitives, but a tree holds no more than {}; trace fewer",
        u32::MAX
    )]
    TooMany {
        /// Primitives given.
        count: usize,
    },
}

/// How a tree is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BrokenTree {
    /// A child is no node behind its parent and no leaf, or has been met before.
    #[error("node {node}: child {lane} does not exist, or has two parents")]
    Child {
        /// The node.
        node: usize,
        /// The child.
        lane: usize,
    },
    /// Nodes or leaves have no parent.
    #[error("{count} nodes or leaves have no parent")]
    Unreachable {
        /// How many.
        count: usize,
    },
    /// A box does not hold what it should.
    #[error("node {node}: the box of child {lane} does not hold what is below it")]
    Outside {
        /// The node.
        node: usize,
        /// The child.
        lane: usize,
    },
    /// The capsule of a slot, or that around its block, does not hold the piece.
    #[error("slot {slot}: the capsules of the slot and of its block do not hold the piece")]
    Capsule {
        /// The slot.
        slot: usize,
    },
    /// A piece of a beam is in no slot, or in two.
    #[error("beam {beam}: its pieces are not in one slot each")]
    Piece {
        /// The beam.
        beam: usize,
    },
    /// A sphere of a leaf does not hold a disc.
    #[error("slot {slot}: the sphere around its block does not hold the disc")]
    Sphere {
        /// The slot.
        slot: usize,
    },
}
