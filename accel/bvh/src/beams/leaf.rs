//! Leaves: pieces eight side by side, and how near a ray comes to them.

use super::Segment;
use crate::{LANES, LEAF};
use fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use glam::{DVec3, Vec3};
use tyndall_core::Ray;

/// Bits of a coordinate. Of three, two are left over.
const BITS: usize = 10;
/// What is left over of two ends tells the reach of a piece, in parts of that of its block.
const PARTS: i32 = 16;
/// Places of the grid of a leaf along its longest edge, less one.
const LAST: i32 = (1 << BITS) - 1;

/// Up to [`LEAF`] pieces, in blocks. Their ends are on a grid over the box of the leaf: far from the
/// origin of the scene, places lose no digits.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    /// The grid.
    corner: Vec3,
    step: f32,
    /// Its first block.
    pub(super) first: u32,
    pub(super) pieces: u32,
    /// The largest reach of each block: a radius, with how far the ends are off the grid and what
    /// rounding may do, but for that which grows with the distance of a ray.
    reach: [f32; LEAF / LANES],
}

/// Eight pieces.
#[derive(Clone, Debug)]
#[repr(align(128))]
pub(super) struct Block {
    /// Where they start and end: x, y and z, the first in the lowest bits, and a half of the part of
    /// the reach.
    pub(super) ends: [[i32; LANES]; 2],
    pub(super) beams: [u32; LANES],
    /// Of what part of its beam each is: see [`bound`](super::bound).
    pub(super) numbers: [[u16; 2]; LANES],
}

/// What a slot holds: a beam, and which part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) beam: u32,
    pub(super) numbers: [u16; 2],
}

/// Of distances, relative to those to the origin of the ray: 50u, as the crate doc counts.
const ROUNDING: f32 = 3e-6;
/// More than what squares lose when they underflow.
const UNDERFLOW: f64 = 1e-18;
/// Square of a length below which that of a piece would lose digits.
const SHORT: f32 = 1e-30;

impl Leaf {
    /// Of so many pieces as there are segments, and its blocks, of which it is told the first.
    pub(super) fn new(parts: &[Part], segments: &[Segment], first: u32) -> (Self, Vec<Block>) {
        let ends = || segments.iter().flat_map(|segment| segment.ends);
        let corner = ends().fold(DVec3::INFINITY, DVec3::min).as_vec3();
        let corner = corner.map(f32::next_down);
        let size = ends().fold(DVec3::ZERO, |size, end| size.max(end - corner.as_dvec3()));
        let mut leaf = Self {
            corner,
            step: ((size.max_element() / f64::from(LAST)) as f32).next_up(),
            first,
            pieces: parts.len() as u32,
            reach: [0.0; LEAF / LANES],
        };
        let blocks = parts.chunks(LANES).zip(segments.chunks(LANES));
        let blocks = blocks.enumerate().map(|(block, (parts, segments))| {
            let mut lanes = Block::EMPTY;
            let mut reaches = [0.0; LANES];
            for (lane, (part, segment)) in parts.iter().zip(segments).enumerate() {
                lanes.beams[lane] = part.beam;
                lanes.numbers[lane] = part.numbers;
                for (all, end) in lanes.ends.iter_mut().zip(segment.ends) {
                    all[lane] = leaf.on_grid(end);
                }
                reaches[lane] = leaf.reach_of(segment, lanes.ends.map(|all| all[lane]));
            }
            let largest = reaches.into_iter().fold(0.0, f64::max) as f32;
            leaf.reach[block] = largest.next_up();
            lanes.tell(reaches.map(|reach| reach / f64::from(leaf.reach[block])));
            lanes
        });
        let blocks = blocks.collect();
        (leaf, blocks)
    }

    /// The point of the grid next to a place.
    fn on_grid(&self, place: DVec3) -> i32 {
        let step = f64::from(self.step).max(f64::MIN_POSITIVE);
        let cells = (place - self.corner.as_dvec3()) / step;
        let [x, y, z] = cells.to_array().map(|x| (x.round() as i32).clamp(0, LAST));
        x | y << BITS | z << (2 * BITS)
    }

    /// A point of the grid.
    fn place(&self, point: i32) -> DVec3 {
        let cells = [0, 1, 2].map(|axis| f64::from(point >> (axis * BITS) & LAST));
        self.corner.as_dvec3() + f64::from(self.step) * DVec3::from_array(cells)
    }

    /// How near a ray must come to a piece that is taken for another, but for what rounding adds
    /// with the distance of the ray.
    fn reach_of(&self, segment: &Segment, points: [i32; 2]) -> f64 {
        let Segment { ends, radius } = segment;
        let off = [0, 1].map(|i| ends[i].distance(self.place(points[i])));
        let of_leaf = f64::from(LAST) * f64::from(self.step);
        let size = 2.0 * (radius + of_leaf + ends[0].distance(ends[1]));
        radius + off[0].max(off[1]) + f64::from(ROUNDING) * size + UNDERFLOW
    }

    /// Its slots: those behind the last piece of its last block hold nothing.
    pub(super) fn slots(&self) -> std::ops::Range<usize> {
        let start = self.first as usize * LANES;
        start..start + self.pieces as usize
    }

    /// Whether what is tested for a piece holds a segment.
    pub(super) fn holds(&self, blocks: &[Block], slot: usize, segment: &Segment) -> bool {
        let block = &blocks[slot / LANES];
        let points = block.ends.map(|all| all[slot % LANES]);
        let [low, high] = points.map(|point| point >> (3 * BITS) & 3);
        let part = f64::from(low + 4 * high + 1) / f64::from(PARTS);
        let reach = part * f64::from(self.reach[slot / LANES - self.first as usize]);
        self.reach_of(segment, points) <= reach
    }

    /// The grid as a ray sees it, of all blocks.
    #[inline(always)]
    pub(super) fn grid<S: Simd>(&self, line: &Line<S>) -> Grid {
        let corner = self.corner - line.origin;
        let size = 3.0 * LAST as f32 * self.step;
        let to_next = 1.0 / (LAST + 1) as f32;
        Grid {
            corner,
            steps: [1.0, to_next, to_next * to_next].map(|part| self.step * part),
            reach: 0.0,
            rounding: ROUNDING * size * (corner.abs().element_sum() + size),
        }
    }

    /// How near the pieces of a block are shown at most.
    #[inline(always)]
    pub(super) fn reach(&self, block: usize) -> f32 {
        self.reach[block]
    }
}

/// A grid from the origin of a ray, and how near the pieces of a block are shown.
#[derive(Clone, Copy, Default)]
pub(super) struct Grid {
    corner: Vec3,
    /// Along each axis, in the unit of [`axes`].
    steps: [f32; 3],
    pub(super) reach: f32,
    /// What rounding may do to a product of a place, a piece and a direction.
    rounding: f32,
}

impl Block {
    const EMPTY: Self = Self {
        ends: [[0; LANES]; 2],
        beams: [0; LANES],
        numbers: [[0; 2]; LANES],
    };

    /// Notes the reach of each piece, as a share of that of the block, rounded up.
    fn tell(&mut self, shares: [f64; LANES]) {
        for (lane, share) in shares.into_iter().enumerate() {
            let part = (share * f64::from(PARTS)).ceil() as i32 - 1;
            let part = part.clamp(0, PARTS - 1);
            self.ends[0][lane] |= (part & 3) << (3 * BITS);
            self.ends[1][lane] |= (part >> 2) << (3 * BITS);
        }
    }

    #[inline]
    pub(super) fn part(&self, lane: usize) -> Part {
        Part {
            beam: self.beams[lane],
            numbers: self.numbers[lane],
        }
    }

    /// A bit for each piece whose line is near that of the ray: no two of their points are closer
    /// than the lines are.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn lines_near<S: Simd>(&self, line: &Line<S>, grid: Grid) -> u32 {
        let simd = line.t_max.simd;
        let [dx, dy, dz] = line.direction;
        let ([x, y, z], [ex, ey, ez]) = self.segments(simd, grid);
        let nx = dy * ez - dz * ey;
        let ny = dz * ex - dx * ez;
        let nz = dx * ey - dy * ex;
        let triple = (x * nx + y * ny + z * nz).abs();
        let n2 = nx * nx + ny * ny + nz * nz;
        let apart = (triple - grid.rounding).max(f32x8::splat(simd, 0.0));
        let most = (n2 + SHORT) * (grid.reach * grid.reach) + f32::MIN_POSITIVE;
        (apart * apart).simd_le(most).to_bitmask() as u32
    }

    /// Starts from the origin of the ray, and pieces from start to end.
    #[inline(always)]
    fn segments<S: Simd>(&self, simd: S, grid: Grid) -> ([f32x8<S>; 3], [f32x8<S>; 3]) {
        let [start, end] = [axes(simd, &self.ends[0]), axes(simd, &self.ends[1])];
        let [to_x, to_y, to_z] = grid.steps;
        let x = start[0] * to_x + grid.corner.x;
        let y = start[1] * to_y + grid.corner.y;
        let z = start[2] * to_z + grid.corner.z;
        let ex = (end[0] - start[0]) * to_x;
        let ey = (end[1] - start[1]) * to_y;
        let ez = (end[2] - start[2]) * to_z;
        ([x, y, z], [ex, ey, ez])
    }

    /// A bit for each piece that the ray comes near: closest points of two segments (Ericson 2005,
    /// "Real-time collision detection", 5.1.9), by the parts along the ray and across it. The
    /// difference of the origins comes first, and what is across is made from vectors: nothing
    /// cancels where the two are parallel, or far from the origin of the scene.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn near<S: Simd>(&self, line: &Line<S>, grid: Grid) -> u32 {
        let simd = line.t_max.simd;
        let [dx, dy, dz] = line.direction;
        let ([x, y, z], [ex, ey, ez]) = self.segments(simd, grid);
        let starts = i32x8::from_slice(simd, &self.ends[0]) >> (3 * BITS as u32);
        let ends = i32x8::from_slice(simd, &self.ends[1]) >> (3 * BITS as u32);
        let three = i32x8::splat(simd, 3);
        let part =
            (starts & three).to_float::<f32x8<S>>() + (ends & three).to_float::<f32x8<S>>() * 4.0;
        let reach = (part + 1.0) * (grid.reach / PARTS as f32);
        let zero = f32x8::splat(simd, 0.0);
        let one = f32x8::splat(simd, 1.0);
        // So far along the ray, and across it.
        let from = x * dx + y * dy + z * dz;
        let (x, y, z) = (x - from * dx, y - from * dy, z - from * dz);
        let along = ex * dx + ey * dy + ez * dz;
        let (ex, ey, ez) = (ex - along * dx, ey - along * dy, ez - along * dz);
        // Where the piece is closest to the line; where the ray is closest to that; and back.
        let across2 = ex * ex + ey * ey + ez * ez;
        let facing = x * ex + y * ey + z * ez;
        let least = f32x8::splat(simd, f32::MIN_POSITIVE);
        let v = (zero - facing / across2.max(least)).max(zero).min(one);
        let t = (from + v * along).max(zero).min(line.t_max);
        let length2 = (across2 + along * along).max(least);
        let v = (zero - (facing + (from - t) * along) / length2)
            .max(zero)
            .min(one);
        let (x, y, z) = (x + v * ex, y + v * ey, z + v * ez);
        let w = from + v * along - t;
        let reach = reach + from.abs() * ROUNDING;
        let near = (x * x + y * y + z * z + w * w).simd_le(reach * reach);
        near.to_bitmask() as u32
    }
}

/// The axes of eight points of a grid, each in its own unit: they stay where they are in an integer.
#[inline(always)]
fn axes<S: Simd>(simd: S, points: &[i32; LANES]) -> [f32x8<S>; 3] {
    let points = i32x8::from_slice(simd, points);
    let x = (points & i32x8::splat(simd, LAST)).to_float();
    let y = (points & i32x8::splat(simd, LAST << BITS)).to_float();
    let z = (points & i32x8::splat(simd, LAST << (2 * BITS))).to_float();
    [x, y, z]
}

/// A ray, prepared for [`Block::near`].
pub(super) struct Line<S: Simd> {
    origin: Vec3,
    direction: [f32x8<S>; 3],
    t_max: f32x8<S>,
}

impl<S: Simd> Line<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let d = ray.direction;
        Self {
            origin: ray.origin,
            direction: [
                f32x8::splat(simd, d.x),
                f32x8::splat(simd, d.y),
                f32x8::splat(simd, d.z),
            ],
            t_max: f32x8::splat(simd, ray.t_max),
        }
    }
}
