//! Photon beams: cones in pieces, and which of them a ray or a point comes near.

mod block;
mod shape;
mod split;

use crate::{BrokenTree, BuildError, Bvh, LANES, LEAF, Met, Quality};
use block::{Block, Line, Segment};
use glam::Vec3;
use rayon::prelude::*;
pub use shape::{BeamShape, Piece};
use tyndall_core::Ray;

/// Beams, long ones in pieces, so that rays and points find those which they come near.
///
/// [`Beams::near`] proposes; what is met, the caller decides on the whole [`Beams::beam`], and by
/// [`Piece::holds`], so that every place of a beam is met once.
///
/// ```
/// use glam::Vec3;
/// use tyndall_bvh::{BeamShape, Beams, Quality};
/// use tyndall_core::Ray;
/// let laser = BeamShape {
///     origin: Vec3::ZERO,
///     direction: Vec3::new(0.48, 0.6, 0.64),
///     length: 10.0,
///     radii: [0.1, 0.2],
///     limits: BeamShape::UNLIMITED,
/// };
/// let beams = Beams::build(&[laser], Quality::Fast)?;
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
    bvh: Bvh,
    /// A capsule around each block of a leaf.
    leaves: Vec<Block>,
    blocks: Vec<Block>,
    /// The beam of each slot.
    owners: Vec<u32>,
    beams: Vec<Beam>,
}

#[derive(Clone, Debug)]
struct Beam {
    shape: BeamShape,
    pieces: u16,
}

impl Beam {
    /// Where piece `number` starts, and that before it ends.
    #[inline]
    fn bound(&self, number: u16) -> f32 {
        self.shape.length * (f32::from(number) / f32::from(self.pieces))
    }

    fn piece(&self, number: u16) -> Segment {
        let [start, end] = [number, number + 1].map(|number| f64::from(self.bound(number)));
        Segment {
            ends: [start, end].map(|v| self.shape.at(v)),
            radius: self.shape.radius(start).max(self.shape.radius(end)),
        }
    }
}

impl Beams {
    /// Splits beams into pieces and builds a tree over them. Beams of no length and of radius 0
    /// are never met.
    ///
    /// # Errors
    /// A coordinate of an end or a radius is not finite or beyond 1e18, a length or a limit of radii
    /// is negative, the smallest radius is larger than the largest, the length of a direction is farther than 1e-3 from 1, or there are more than
    /// `u32::MAX` beams or pieces.
    pub fn build(shapes: &[BeamShape], quality: Quality) -> Result<Self, BuildError> {
        if shapes.len() > u32::MAX as usize {
            let count = shapes.len();
            return Err(BuildError::TooMany { count });
        }
        let fault = |(index, shape): (usize, &BeamShape)| shape.fault(index);
        if let Some(fault) = shapes.par_iter().enumerate().find_map_first(fault) {
            return Err(fault);
        }
        let beams = split::into_pieces(shapes);
        let numbers = |(index, beam): (usize, &Beam)| {
            let pieces = beam.pieces;
            (0..pieces).map(move |number| (index as u32, number))
        };
        let pieces: Vec<(u32, u16)> = beams
            .par_iter()
            .enumerate()
            .flat_map_iter(numbers)
            .collect();
        let segment = |&(beam, number): &(u32, u16)| beams[beam as usize].piece(number);
        let bounds: Vec<_> = pieces.par_iter().map(|id| segment(id).bounds()).collect();
        let (bvh, order) = Bvh::over(&bounds, quality)?;
        let ids: Vec<_> = order.par_iter().map(|&i| pieces[i as usize]).collect();
        let segments = |ids: &[(u32, u16)]| ids.iter().map(segment).collect::<Vec<_>>();
        let block = |ids: &[(u32, u16)]| Block::new(&segments(ids), |lane| ids[lane].1);
        let blocks = ids.par_chunks(LANES).map(block).collect();
        let screen = |ids: &[(u32, u16)]| {
            let capsules: Vec<_> = segments(ids).chunks(LANES).map(Segment::around).collect();
            Block::new(&capsules, |_| 0)
        };
        let leaves = ids.par_chunks(LEAF).map(screen).collect();
        let owners = ids.par_iter().map(|id| id.0).collect();
        Ok(Self {
            bvh,
            leaves,
            blocks,
            owners,
            beams,
        })
    }

    /// Calls `visit` once for every piece that the ray comes as near in `[0, t_max]` as the largest
    /// radius of the piece, and for a few that it does not, in no particular order.
    #[inline]
    pub fn near(&self, ray: &Ray, mut visit: impl FnMut(Piece)) {
        let line = Line::new(ray);
        let test = |block: usize| (self.blocks[block].near(&line), []);
        let visit = |met: &Met<'_, 0>| met.each(|slot, []| visit(self.piece(slot)));
        (self.bvh).meet(ray, |leaf| self.leaves[leaf].near(&line), test, visit);
    }

    /// As [`Beams::near`], for a point.
    #[inline]
    pub fn around(&self, point: Vec3, visit: impl FnMut(Piece)) {
        self.near(&Ray::new(point, Vec3::Z).up_to(0.0), visit);
    }

    #[inline]
    fn piece(&self, slot: usize) -> Piece {
        let number = self.blocks[slot / LANES].number(slot % LANES);
        self.piece_of(self.owners[slot] as usize, number)
    }

    #[inline]
    fn piece_of(&self, beam: usize, number: u16) -> Piece {
        let owner = &self.beams[beam];
        Piece {
            beam,
            start: owner.bound(number),
            end: owner.bound(number + 1),
        }
    }

    /// The pieces of a beam, by its index as given to [`Beams::build`], from its start to its end.
    ///
    /// # Panics
    /// There is no such beam.
    pub fn pieces_of(&self, beam: usize) -> impl Iterator<Item = Piece> {
        (0..self.beams[beam].pieces).map(move |number| self.piece_of(beam, number))
    }

    /// A beam, by its index as given to [`Beams::build`].
    ///
    /// # Panics
    /// There is no such beam.
    #[inline]
    pub fn beam(&self, index: usize) -> &BeamShape {
        &self.beams[index].shape
    }

    /// Beams, those that are never met included.
    pub fn len(&self) -> usize {
        self.beams.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.beams.is_empty()
    }

    /// Pieces of all beams.
    pub fn pieces(&self) -> usize {
        self.owners.len()
    }

    /// Bytes of nodes, pieces and beams.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes()
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.blocks.as_slice())
            + size_of_val(self.owners.as_slice())
            + size_of_val(self.beams.as_slice())
    }

    /// As [`Bvh::validate`]; every piece of a beam is in one slot, and in the capsule of its block.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), BrokenTree> {
        let pieces = |beam: &Beam| vec![false; usize::from(beam.pieces)];
        let mut found: Vec<_> = self.beams.iter().map(pieces).collect();
        for (slot, &owner) in self.owners.iter().enumerate() {
            let (block, lane) = (slot / LANES, slot % LANES);
            let (beam, number) = (owner as usize, self.blocks[block].number(lane));
            let of_beam = found.get_mut(beam);
            match of_beam.and_then(|found| found.get_mut(usize::from(number))) {
                Some(found) if !*found => *found = true,
                _ => return Err(BrokenTree::Piece { beam }),
            }
            let piece = self.beams[beam].piece(number);
            let capsule = &self.leaves[slot / LEAF];
            if !self.blocks[block].holds(lane, &piece) || !capsule.holds(block % LANES, &piece) {
                return Err(BrokenTree::Capsule { slot });
            }
        }
        if let Some(beam) = found.iter().position(|found| found.contains(&false)) {
            return Err(BrokenTree::Piece { beam });
        }
        self.bvh.validate(|slot| {
            let number = self.blocks[slot / LANES].number(slot % LANES);
            let owner = &self.beams[self.owners[slot] as usize];
            owner.piece(number).bounds()
        })
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
        let beams = Beams::build(&shapes, Quality::Fast).expect("good beams");
        assert_eq!(beams.validate(), Ok(()));
        assert_eq!(beams.pieces(), 400);
        let broken = |spoil: &dyn Fn(&mut Beams)| {
            let mut beams = beams.clone();
            spoil(&mut beams);
            beams.validate()
        };
        let owner = beams.owners[7] as usize;
        let twice = broken(&|beams| beams.owners[8] = beams.owners[7]);
        assert!(
            matches!(
                twice,
                Err(BrokenTree::Capsule { slot: 8 }) | Err(BrokenTree::Piece { .. })
            ),
            "{twice:?}"
        );
        let beam = 1 << 20;
        let none = broken(&|beams| beams.owners[7] = 1 << 20);
        assert_eq!(none, Err(BrokenTree::Piece { beam }));
        let lost = broken(&|beams| beams.beams[owner].pieces += 1);
        assert!(lost.is_err());
        let last = beams.len();
        let missing = broken(&|beams| beams.beams.push(beams.beams[0].clone()));
        assert_eq!(missing, Err(BrokenTree::Piece { beam: last }));
        let wider = broken(&|beams| beams.beams[owner].shape.radii[1] = 1.0);
        assert!(
            matches!(wider, Err(BrokenTree::Capsule { .. })),
            "{wider:?}"
        );
        let block = broken(&|beams| beams.blocks.swap(1, 2));
        assert!(block.is_err());
        let capsule = broken(&|beams| beams.leaves.swap(0, 1));
        assert_eq!(capsule, Err(BrokenTree::Capsule { slot: 0 }));
        let tree = broken(&|beams| {
            let far = BeamShape {
                origin: Vec3::Y,
                ..shapes[0]
            };
            beams.bvh = Beams::build(&[far; 100], Quality::Fast)
                .expect("good beams")
                .bvh;
        });
        assert!(matches!(tree, Err(BrokenTree::Outside { .. })), "{tree:?}");
    }
}
