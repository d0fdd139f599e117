//! How many pieces a beam is split into.
//!
//! A box around the segment l·d has the surface of a cube of edge l·√((|dx dy| + |dy dz| + |dz dx|)/3):
//! none for a beam along an axis, which needs no pieces. The boxes of k pieces have together a k-th of
//! the surface, and so much fewer rays meet them. Of all ways to make so many pieces of some beams,
//! that where all have the same edge leaves the least surface. One edge for all is found such that there
//! are [`PIECES`] a beam; but pieces shorter than [`SHORTEST`] radii would be met two at a time.

use super::{Beam, BeamShape};
use rayon::prelude::*;

/// Pieces a beam, on the mean, at most. Rays through 10⁵ beams take 0.6 (directions at random) and
/// 0.3 (a bundle) of their time through whole ones. With 8, it is the same for 10⁴ beams, 0.8 to 0.9
/// for 10⁵ and 0.7 to 0.85 for 10⁶, but builds take twice as long, and memory is 1.8 times as much.
const PIECES: u64 = 4;
/// Edge of a piece in radii: with a half or twice as much, rays are no faster.
const SHORTEST: f32 = 5.0;

/// Beams and their pieces; those that cannot be met have none.
pub(super) fn into_pieces(shapes: &[BeamShape]) -> Vec<Beam> {
    let edge = edge(shapes);
    let beam = |&shape: &BeamShape| Beam {
        shape,
        pieces: pieces(&shape, edge),
    };
    shapes.par_iter().map(beam).collect()
}

/// The smallest edge, of eight to the octave, that leaves few enough pieces.
fn edge(shapes: &[BeamShape]) -> f32 {
    // The first bits of floats count the eighths of octaves.
    let edge = |eighths: u32| f32::from_bits(eighths << 20);
    let fits = |edge: f32| {
        let count = |shape| u64::from(pieces(shape, edge));
        shapes.par_iter().map(count).sum::<u64>() <= PIECES * shapes.len() as u64
    };
    let (mut small, mut large) = (0, f32::MAX.to_bits() >> 20);
    while large - small > 1 {
        let middle = small.midpoint(large);
        if fits(edge(middle)) {
            large = middle;
        } else {
            small = middle;
        }
    }
    edge(large)
}

fn pieces(shape: &BeamShape, edge: f32) -> u16 {
    if !shape.has_volume() {
        return 0;
    }
    let d = shape.direction.abs();
    let of_beam = shape.length * ((d.x * d.y + d.y * d.z + d.z * d.x) / 3.0).sqrt();
    let count = of_beam / edge.max(SHORTEST * shape.largest());
    count.ceil().clamp(1.0, f32::from(u16::MAX)) as u16
}
