//! Photon beams: cones in pieces, and which of them a ray or a point comes near.

mod batch;
mod cut;
mod leaf;
mod lines;
mod segment;
mod shape;

use crate::tree::Tree;
use crate::{BrokenTree, BuildError, LANES};
use batch::{Batch, Pieces};
use fearless_simd::{Level, Simd, dispatch};
use glam::Vec3;
use leaf::{Leaf, Line, Part, Slot};
use lines::{Ball, Lines};
use rayon::prelude::*;
use segment::Segment;
pub use shape::{BeamShape, Piece};
use tyndall_core::{Aabb, Ray};

/// Beams, long ones in pieces, so that rays and points find those which they come near.
///
/// [`Beams::near`] proposes; what is met, the caller decides on the whole [`Beams::beam`], and by
/// [`Piece::holds`], so that every place of a beam is met once.
///
/// ```
/// use glam::Vec3;
/// use tyndall_bvh::{BeamShape, Beams};
/// use tyndall_core::Ray;
/// let laser = BeamShape {
///     origin: Vec3::ZERO,
///     direction: Vec3::new(0.48, 0.6, 0.64),
///     length: 10.0,
///     radii: [0.1, 0.2],
///     limits: BeamShape::UNLIMITED,
/// };
/// let beams = Beams::build(&[laser])?;
/// let place = laser.at(4.0).as_vec3();
/// let mut met = 0;
/// beams.near(&Ray::new(place - Vec3::X, Vec3::X), |piece| met += usize::from(piece.holds(4.0)));
/// beams.around(place, |piece| met += usize::from(piece.holds(4.0)));
/// assert_eq!(met, 2);
/// beams.near(&Ray::new(place + 0.5 * Vec3::Z, Vec3::X), |_| panic!("not met"));
/// # Ok::<(), tyndall_bvh::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Beams {
    tree: Tree,
    leaves: Vec<Leaf>,
    slots: Vec<Slot>,
    /// Of the same pieces, in blocks.
    lines: Vec<Lines>,
    shapes: Vec<BeamShape>,
}

/// Where pieces of a beam may start and end: so many steps of the same length.
const STEPS: u16 = u16::MAX;

/// A distance in steps.
#[inline]
fn bound(shape: &BeamShape, steps: u16) -> f32 {
    shape.length * (f32::from(steps) / f32::from(STEPS))
}

/// A piece of a beam, from one step to another.
fn segment(shape: &BeamShape, steps: [u16; 2]) -> Segment {
    let [start, end] = steps.map(|steps| f64::from(bound(shape, steps)));
    Segment {
        ends: [start, end].map(|v| shape.at(v)),
        radius: shape.radius(start).max(shape.radius(end)),
        direction: shape.direction.as_dvec3().normalize(),
    }
}

impl Beams {
    /// Splits beams into pieces and builds a tree over them. Beams of no length and of radius 0
    /// are never met.
    ///
    /// # Errors
    /// A coordinate of an end or a radius is not finite or beyond 1e18, a length or a limit of radii
    /// is negative, the smallest radius is larger than the largest, the length of a direction is
    /// farther than 1e-3 from 1, or there are more than 2²⁷ beams.
    pub fn build(shapes: &[BeamShape]) -> Result<Self, BuildError> {
        if shapes.len() > 1 << 27 {
            let count = shapes.len();
            return Err(BuildError::TooMany { count });
        }
        let fault = |(index, shape): (usize, &BeamShape)| shape.fault(index);
        if let Some(fault) = shapes.par_iter().enumerate().find_map_first(fault) {
            return Err(fault);
        }
        let mut grown = cut::grow(shapes);
        grown.nodes.shrink_to_fit();
        grown.leaves.shrink_to_fit();
        grown.slots.shrink_to_fit();
        grown.lines.shrink_to_fit();
        Ok(Self {
            tree: Tree { nodes: grown.nodes },
            leaves: grown.leaves,
            slots: grown.slots,
            lines: grown.lines,
            shapes: shapes.to_vec(),
        })
    }

    /// Calls `visit` once for every piece that the ray comes as near in `[0, t_max]` as the largest
    /// radius of the piece, and for a few that it does not, in no particular order.
    #[inline]
    pub fn near(&self, ray: &Ray, mut visit: impl FnMut(Piece)) {
        self.slots_near(ray, &mut |slots| {
            for &slot in slots {
                visit(self.piece(slot as usize));
            }
        });
    }

    /// Calls `visit` with the slots of those pieces, some at a time.
    fn slots_near(&self, ray: &Ray, visit: &mut dyn FnMut(&[u32])) {
        dispatch!(Level::new(), simd => self.slots_near_by(simd, ray, visit));
    }

    #[inline(always)] // into code for the level of the machine
    fn slots_near_by<S: Simd>(&self, simd: S, ray: &Ray, visit: &mut dyn FnMut(&[u32])) {
        let line = Line::new(simd, ray);
        let mut batch = Batch::new();
        let pieces = Pieces {
            leaves: &self.leaves,
            slots: &self.slots,
            lines: &self.lines,
        };
        self.tree.traverse(
            ray,
            #[inline(always)]
            |leaf| {
                batch.push(pieces, leaf, &line);
                if batch.is_full() {
                    visit(batch.run(pieces, &line));
                }
            },
        );
        visit(batch.run(pieces, &line));
    }

    /// As [`Beams::near`], for a point.
    #[inline]
    pub fn around(&self, point: Vec3, visit: impl FnMut(Piece)) {
        self.near(&Ray::new(point, Vec3::Z).up_to(0.0), visit);
    }

    #[inline]
    fn piece(&self, slot: usize) -> Piece {
        let Part { beam, numbers } = self.slots[slot].part;
        let shape = &self.shapes[beam as usize];
        let [start, end] = numbers.map(|number| bound(shape, number));
        Piece {
            beam: beam as usize,
            start,
            end,
        }
    }

    /// All pieces, in no particular order.
    pub fn pieces(&self) -> impl Iterator<Item = Piece> {
        let slots = self.leaves.iter().flat_map(Leaf::slots);
        slots.map(|slot| self.piece(slot))
    }

    /// A beam, by its index as given to [`Beams::build`].
    ///
    /// # Panics
    /// There is no such beam.
    #[inline]
    pub fn beam(&self, index: usize) -> &BeamShape {
        &self.shapes[index]
    }

    /// Beams, those that are never met included.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Bytes of nodes, pieces and beams.
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.slots.as_slice())
            + size_of_val(self.lines.as_slice())
            + size_of_val(self.shapes.as_slice())
    }

    /// As [`Bvh::validate`](crate::Bvh::validate); the pieces of a beam hold each of its distances
    /// once, and what is tested for a piece holds it.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), BrokenTree> {
        let slots = || self.leaves.iter().flat_map(Leaf::slots);
        let mut parts: Vec<_> = slots().map(|slot| self.slots[slot].part).collect();
        parts.sort_unstable_by_key(|part| (part.beam, part.numbers));
        let mut rest = parts.as_slice();
        for (beam, shape) in self.shapes.iter().enumerate() {
            let count = rest
                .iter()
                .take_while(|part| part.beam as usize == beam)
                .count();
            let (of_beam, others) = rest.split_at(count);
            rest = others;
            let mut ends = of_beam.iter().map(|part| part.numbers);
            let end = ends.try_fold(0, |at, [start, end]| {
                (at == start && start < end).then_some(end)
            });
            let whole = if shape.has_volume() { STEPS } else { 0 };
            if end != Some(whole) {
                return Err(BrokenTree::Piece { beam });
            }
        }
        if let Some(part) = rest.first() {
            return Err(BrokenTree::Piece {
                beam: part.beam as usize,
            });
        }
        for leaf in &self.leaves {
            let segments: Vec<_> = leaf.slots().map(|slot| self.segment(slot)).collect();
            let mut lines = leaf.blocks().zip(segments.chunks(LANES));
            let screened = leaf.ball == Ball::around(&segments)
                && lines.all(|(block, pieces)| self.lines[block] == leaf.ball.lines(pieces));
            let holds = |slot, segment| screened && leaf.holds(&self.slots, slot, segment);
            let mut pieces = leaf.slots().zip(&segments);
            if let Some((slot, _)) = pieces.find(|&(slot, segment)| !holds(slot, segment)) {
                return Err(BrokenTree::Capsule { slot });
            }
        }
        self.tree.validate(self.leaves.len(), |leaf| {
            let bounds = self.leaves[leaf]
                .slots()
                .map(|slot| self.segment(slot).bounds());
            bounds.fold(Aabb::EMPTY, Aabb::union)
        })
    }

    fn segment(&self, slot: usize) -> Segment {
        let Part { beam, numbers } = self.slots[slot].part;
        segment(&self.shapes[beam as usize], numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_beams_are_found() {
        let beam = |i: u8| BeamShape {
            origin: Vec3::X * f32::from(i),
            direction: Vec3::new(0.48, 0.6, 0.64),
            length: 50.0,
            radii: [0.1, 0.2],
            limits: BeamShape::UNLIMITED,
        };
        let shapes: Vec<_> = (0..100).map(beam).collect();
        let beams = Beams::build(&shapes).expect("good beams");
        assert_eq!(beams.validate(), Ok(()));
        assert!(beams.pieces().count() > 100);
        let broken = |spoil: &dyn Fn(&mut Beams)| {
            let mut beams = beams.clone();
            spoil(&mut beams);
            beams.validate()
        };
        let Part { beam, numbers } = beams.slots[7].part;
        let beam = beam as usize;
        let piece = Err(BrokenTree::Piece { beam });
        let longer = [numbers[0], numbers[1] + 1];
        assert_eq!(broken(&|beams| beams.slots[7].part.numbers = longer), piece);
        let [first, last] = [0, 99].map(|beam| Err(BrokenTree::Piece { beam }));
        let twice = broken(&|beams| beams.slots[7].part.beam = 99);
        assert!([piece, last].contains(&twice), "{twice:?}");
        let none = broken(&|beams| beams.slots[7].part.beam = 1 << 20);
        assert!([piece, Err(BrokenTree::Piece { beam: 1 << 20 })].contains(&none));
        let missing = broken(&|beams| beams.shapes.push(shapes[0]));
        assert_eq!(missing, Err(BrokenTree::Piece { beam: 100 }));
        let empty = broken(&|beams| beams.shapes[0].radii = [0.0; 2]);
        assert_eq!(empty, first);
        let capsule = |result| matches!(result, Err(BrokenTree::Capsule { .. }));
        let wider = broken(&|beams| beams.shapes[beam].radii[1] = 1.0);
        assert!(capsule(wider), "{wider:?}");
        let moved = broken(&|beams| beams.slots[7].ends[1] ^= 1 << 8);
        assert_eq!(moved, Err(BrokenTree::Capsule { slot: 7 }));
        let aside = broken(&|beams| beams.lines[0] = beams.lines[1].clone());
        assert_eq!(aside, Err(BrokenTree::Capsule { slot: 0 }));
        let elsewhere = broken(&|beams| beams.leaves[0].ball = Ball::around(&[beams.segment(99)]));
        assert_eq!(elsewhere, Err(BrokenTree::Capsule { slot: 0 }));
        let far = BeamShape {
            origin: Vec3::Y,
            ..shapes[0]
        };
        let tree = broken(&|beams| {
            beams.tree = Beams::build(&[far; 100]).expect("good beams").tree;
        });
        let known = matches!(
            tree,
            Err(BrokenTree::Outside { .. } | BrokenTree::Child { .. })
        );
        assert!(known, "{tree:?}");
    }
}
