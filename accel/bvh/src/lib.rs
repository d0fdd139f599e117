//! A bounding volume hierarchy for any bounded primitive met by rays, and photon discs and photon
//! beams on it.
//!
//! [`Discs`] answers the question of the beam radiance estimate: which photons' discs, turned to
//! face a ray, does it pass through ([`Discs::along`]), or which spheres does it enter
//! ([`Discs::chords`])? Each is visited once, in no particular order, with the place and the
//! squared distance at which the ray passes its centre.
//!
//! ```
//! use glam::Vec3;
//! use tyndall_bvh::{Discs, Quality};
//! use tyndall_core::Ray;
//! let discs = Discs::build(&[Vec3::ZERO, Vec3::X], &[0.5, 0.1], Quality::Fast)?;
//! let ray = Ray::new(Vec3::new(0.3, 0.0, -2.0), Vec3::Z);
//! let mut hits = Vec::new();
//! discs.along(&ray, |slot, t, d2| hits.push((discs.order()[slot], t, d2)));
//! assert_eq!(hits, [(0, 2.0, 0.3 * 0.3)]);
//! // The sphere around the first is left at 2.4, that around the second not met.
//! discs.chords(&ray.up_to(1.8), |slot, t, d2| hits.push((discs.order()[slot], t, d2)));
//! assert_eq!(hits[1..], [(0, 2.0, 0.3 * 0.3)]);
//! # Ok::<(), tyndall_bvh::BuildError>(())
//! ```
//!
//! [`Beams`] answers that of photon beams: which of them, cylinders or cones, does a ray or a point
//! come near ([`Beams::near`], [`Beams::around`])? Long beams are in [`Piece`]s, each of them shown
//! once. What is met is for the caller to decide, on the whole beam and in `f64`; [`Piece::holds`]
//! makes it be met once.
//!
//! # Other primitives
//! [`Bvh`] holds boxes only: it is built from the [`Aabb`](tyndall_core::Aabb) of every primitive,
//! gives back an order, and shows a ray the slots of that order that it may meet, by leaves of
//! [`LEAF`]. A kind of primitive adds what is in the slots: blocks of [`LANES`] side by side, a
//! screen that says which blocks of a leaf are worth a test, and the test ([`Bvh::meet`]).
//!
//! # Promised
//! - Coordinates and radii up to 1e18 each, and radii of 1e-18 or more besides 0. What is beyond
//!   1e18 is an error. The squares of smaller radii lose digits; below 2.6e-23 they are 0, and such
//!   discs are never met.
//! - Of discs, distances from and along the ray are right to 1e-6 of the distance w to its origin,
//!   wherever the scene lies: a rim as near to the ray as that may be met or not. All else is exact, in
//!   both qualities, for rays along axes and in faces too. (With u = 2⁻²⁴, a difference of places
//!   is right to u·w, its scalar product to 3u·w, the part across to 2u·w, and the root of the
//!   sum of its squares, held against a square of the radius, to 2u·w more. A direction as
//!   `normalize` gives it is of length 1 to 4u, which adds 8u·w: 16u = 9.6e-7 in all.)
//! - No piece of a beam is missed that comes as near to a ray, or to a point, as its largest radius
//!   r, to the last bit: at any angle, parallel too, at any place, and in the node boxes, which are
//!   rounded to the outside. For this, r grows by how far the grid of its leaf is off, by a sixteenth
//!   of the largest of its block, by 1e-18 and by 3e-6 (50u) of the distance to the start of the
//!   piece, of twice its length, of 2r, and of twice the size of its leaf; so near, pieces may be
//!   shown in vain. Coordinates of both ends and radii are up to 1e18.
//! - The pieces of a beam hold each of its distances once, to the bit.
//!
//!   Why 50u is enough: with w the distance from the origin of the ray to the start of a piece of
//!   length l, in a leaf of size a. Points of the grid are whole numbers times a step: to u·a, the
//!   piece to u·l; subtracting origins adds u(2w + a), subtracting the parts along the ray 2u(w + l):
//!   so much the places are off. The parts along are off too, by 3u, and the direction has length 1
//!   to 4u, so that what is left is across the ray to 11u(w + l) only, and Pythagoras off by as much.
//!   That the two lines are nearly parallel does no harm: the place on the piece is sought with the
//!   vectors as they came out, whose distance depends on that place by its own sine, 8u·l + 3u·r in
//!   all. The way back from the ray to the piece, which matters at the ends of the ray, is off by
//!   30u·w + 18u·l. Together 45u·w, 42u·l, 2u·a and 10u·r; and w, not known when the piece is stored,
//!   is at most l and r more than its part along the ray. Most pieces are
//!   ruled out by their lines before, in whole numbers, 27,000 for the radius of a ball around their
//!   leaf, which lose 2e-4 of it. The moment of a ray about the centre of the ball, w away, is off by
//!   12u·w, and what of it is more than the radius is cut off: of a ray that does pass through, 21u·w.
//!   50u·w are allowed.
//! - The same tree on any number of threads.
//!
//! # Cost
//! Build: O(n log n). Subtrees grow in parallel, but the partitions of the top levels are serial:
//! the first passes over all primitives bound what threads gain. A ray: what it meets, and its
//! overlap with boxes besides; where radii are those of k neighbours, the discs met grow with the
//! cube root of their number. Memory: 23 bytes a disc, 24 in [`Quality::High`] (16 the disc, 4 its
//! order, the rest spheres and nodes).
//!
//! Beams: 44 bytes a beam (its shape) and 33 to 36 a piece (12 its line, 8 its ends, 4 its beam, 4
//! its part of it, the rest leaves, of 40 pieces on the mean, and nodes), with 12 pieces a beam at
//! most on the mean. Space is cut where rays are then shown the fewest pieces, beams with it, as in Stich,
//! Friedrich & Dietrich 2009: bundles along an axis are parted without a cut, and what is much larger
//! than the rest gets a leaf of its own. Where beams get thinner as they get more, so that a ray meets
//! the same number, its time grows with less than their number (README).
//!
//! # References
//! - Jarosz, Zwicker & Jensen 2008, "The beam radiance estimate for volumetric photon mapping".
//! - Wald 2007, "On fast construction of SAH-based bounding volume hierarchies": bins.
//! - Wald, Benthin & Boulos 2008, "Getting rid of packets": wide nodes.
//! - Stich, Friedrich & Dietrich 2009, "Spatial splits in bounding volume hierarchies": cuts. Here
//!   they are halves of boxes, and of a number that each subtree is given its share of.
//! - Jarosz, Nowrouzezahrai, Sadeghi & Jensen 2011, "A comprehensive theory of volumetric radiance
//!   estimation using photon points and beams": beams, split for tight bounds.
//! - Ericson 2005, "Real-time collision detection", 5.1.9: closest points of segments.
//! - Ize 2013, "Robust BVH ray traversal": rounding of distances to planes.
#![forbid(unsafe_code)]

use glam::Vec3;

mod beams;
mod builder;
mod bvh;
mod discs;
mod error;
mod meet;
mod node;
mod tree;
mod values;

pub use beams::{BeamShape, Beams, Piece};
pub use builder::Quality;
pub use bvh::Bvh;
pub use discs::Discs;
pub use error::{BrokenTree, BuildError};
pub use meet::Met;
pub use values::Values;
/// Eight values side by side; blocks of other primitives are made of them.
pub use wide::f32x8;

/// Primitives of a block, blocks of a leaf, and children of a node.
pub const LANES: usize = 8;
/// Slots of a leaf: eight blocks of eight.
pub const LEAF: usize = LANES * LANES;
/// Largest coordinate and radius: squares of differences stay finite, in boxes around spheres too.
const LIMIT: f32 = 1e18;

/// Whether coordinates are numbers up to [`LIMIT`].
fn is_within(v: Vec3) -> bool {
    v.abs().cmple(Vec3::splat(LIMIT)).all()
}
