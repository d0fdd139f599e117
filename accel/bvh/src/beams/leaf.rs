//! Leaves: pieces on a grid, and how near a ray comes to eight of them.

use super::Segment;
use super::lines::Ball;
use crate::{LANES, LEAF};
use fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use glam::{DVec3, Vec3};
use std::ops::Range;
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
    pub(super) ball: Ball,
    /// Its first block.
    pub(super) first: u32,
    pub(super) pieces: u32,
    /// The largest reach of each block: a radius, with how far the ends are off the grid and what
    /// rounding may do, but for that which grows with the distance of a ray.
    pub(super) reach: [f32; LEAF / LANES],
}

/// A piece as rays see it first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// Where it starts and ends: x, y and z, the first in the lowest bits, and a half of the part of
    /// the reach.
    pub(super) ends: [i32; 2],
    pub(super) part: Part,
}

/// A beam, and which part of it: see [`bound`](super::bound).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) beam: u32,
    pub(super) numbers: [u16; 2],
}

/// Of distances, relative to those to the origin of the ray: 50u, as the crate doc counts.
pub(super) const ROUNDING: f32 = 3e-6;
/// More than what squares lose when they underflow.
pub(super) const UNDERFLOW: f64 = 1e-18;

impl Leaf {
    /// Of so many pieces as there are segments, and its slots, of which it is told the first block.
    pub(super) fn new(parts: &[Part], segments: &[Segment], first: u32) -> (Self, Vec<Slot>) {
        let ends = || segments.iter().flat_map(|segment| segment.ends);
        let corner = ends().fold(DVec3::INFINITY, DVec3::min).as_vec3();
        let corner = corner.map(f32::next_down);
        let size = ends().fold(DVec3::ZERO, |size, end| size.max(end - corner.as_dvec3()));
        let mut leaf = Self {
            corner,
            step: ((size.max_element() / f64::from(LAST)) as f32).next_up(),
            ball: Ball::around(segments),
            first,
            pieces: parts.len() as u32,
            reach: [0.0; LEAF / LANES],
        };
        let mut slots = vec![Slot::EMPTY; parts.len().next_multiple_of(LANES)];
        let blocks = slots.chunks_mut(LANES).zip(parts.chunks(LANES));
        for ((block, (slots, parts)), segments) in blocks.enumerate().zip(segments.chunks(LANES)) {
            let mut reaches = [0.0; LANES];
            for (lane, (&part, segment)) in parts.iter().zip(segments).enumerate() {
                let ends = segment.ends.map(|end| leaf.on_grid(end));
                slots[lane] = Slot { ends, part };
                reaches[lane] = leaf.reach_of(segment, ends);
            }
            let largest = reaches.into_iter().fold(0.0, f64::max) as f32;
            leaf.reach[block] = largest.next_up();
            for (slot, reach) in slots.iter_mut().zip(reaches) {
                slot.tell(reach / f64::from(leaf.reach[block]));
            }
        }
        (leaf, slots)
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
        let Segment { ends, radius, .. } = segment;
        let off = [0, 1].map(|i| ends[i].distance(self.place(points[i])));
        let of_leaf = f64::from(LAST) * f64::from(self.step);
        let size = 2.0 * (radius + of_leaf + ends[0].distance(ends[1]));
        radius + off[0].max(off[1]) + f64::from(ROUNDING) * size + UNDERFLOW
    }

    /// Its slots: those behind the last piece of its last block hold nothing.
    pub(super) fn slots(&self) -> Range<usize> {
        let start = self.first as usize * LANES;
        start..start + self.pieces as usize
    }

    /// Whether what is tested for a piece holds a segment.
    pub(super) fn holds(&self, slots: &[Slot], slot: usize, segment: &Segment) -> bool {
        let points = slots[slot].ends;
        let [low, high] = points.map(|point| point >> (3 * BITS) & 3);
        let part = f64::from(low + 4 * high + 1) / f64::from(PARTS);
        let reach = part * f64::from(self.reach(slot / LANES));
        self.reach_of(segment, points) <= reach
    }

    /// How near the pieces of a block are shown at most.
    #[inline(always)]
    fn reach(&self, block: usize) -> f32 {
        self.reach[block - self.first as usize]
    }

    /// A bit for each piece of a block that is there.
    #[inline(always)]
    pub(super) fn lanes(&self, block: usize) -> u32 {
        let before = (block - self.first as usize) * LANES;
        0xff >> LANES.saturating_sub(self.pieces as usize - before)
    }

    /// Its blocks.
    #[inline(always)]
    pub(super) fn blocks(&self) -> Range<usize> {
        let first = self.first as usize;
        first..first + (self.pieces as usize).div_ceil(LANES)
    }
}

impl Slot {
    pub(super) const EMPTY: Self = Self {
        ends: [0; 2],
        part: Part {
            beam: 0,
            numbers: [0; 2],
        },
    };

    /// Notes the reach, as a share of that of the block, rounded up.
    fn tell(&mut self, share: f64) {
        let part = (share * f64::from(PARTS)).ceil() as i32 - 1;
        let part = part.clamp(0, PARTS - 1);
        self.ends[0] |= (part & 3) << (3 * BITS);
        self.ends[1] |= (part >> 2) << (3 * BITS);
    }
}

/// Eight pieces of any leaves.
#[derive(Default)]
pub(super) struct Eight {
    ends: [[i32; LANES]; 2],
    /// Of their grids.
    corner: [[f32; LANES]; 3],
    step: [f32; LANES],
    /// Of their blocks.
    reach: [f32; LANES],
}

impl Eight {
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, leaf: &Leaf, slot: &Slot, block: usize) {
        for (all, end) in self.ends.iter_mut().zip(slot.ends) {
            all[lane] = end;
        }
        for (all, corner) in self.corner.iter_mut().zip(leaf.corner.to_array()) {
            all[lane] = corner;
        }
        self.step[lane] = leaf.step;
        self.reach[lane] = leaf.reach(block);
    }

    /// A bit for each that the ray comes near: closest points of two segments (Ericson 2005,
    /// "Real-time collision detection", 5.1.9), by the parts along the ray and across it. The
    /// difference of the origins comes first, and what is across is made from vectors: nothing
    /// cancels where the two are parallel, or far from the origin of the scene.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn near<S: Simd>(&self, line: &Line<S>) -> u32 {
        let simd = line.simd;
        let [dx, dy, dz] = line.direction;
        let [starts, ends] = self
            .ends
            .each_ref()
            .map(|ends| i32x8::from_slice(simd, ends));
        let [sx, sy, sz] = axes(starts);
        let [tx, ty, tz] = axes(ends);
        let [cx, cy, cz] = self.corner.each_ref().map(|c| f32x8::from_slice(simd, c));
        let step = f32x8::from_slice(simd, &self.step);
        let (to_y, to_z) = (step * NEXT, step * (NEXT * NEXT));
        let x = sx * step + (cx - line.origin.x);
        let y = sy * to_y + (cy - line.origin.y);
        let z = sz * to_z + (cz - line.origin.z);
        let ex = (tx - sx) * step;
        let ey = (ty - sy) * to_y;
        let ez = (tz - sz) * to_z;
        let three = i32x8::splat(simd, 3);
        let [low, high] =
            [starts, ends].map(|all| -> f32x8<S> { (all >> (3 * BITS as u32) & three).to_float() });
        let part = (low + high * 4.0 + 1.0) * (1.0 / PARTS as f32);
        let reach = part * f32x8::from_slice(simd, &self.reach);
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
fn axes<S: Simd>(points: i32x8<S>) -> [f32x8<S>; 3] {
    [0, 1, 2].map(|axis| (points & i32x8::splat(points.simd, LAST << (axis * BITS))).to_float())
}

/// The unit of an axis over that of the one before.
const NEXT: f32 = 1.0 / (1 << BITS) as f32;

/// A ray, prepared for [`Eight::near`].
pub(super) struct Line<S: Simd> {
    pub(super) simd: S,
    pub(super) origin: Vec3,
    pub(super) toward: Vec3,
    direction: [f32x8<S>; 3],
    t_max: f32x8<S>,
}

impl<S: Simd> Line<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let d = ray.direction;
        Self {
            simd,
            origin: ray.origin,
            toward: d,
            direction: [
                f32x8::splat(simd, d.x),
                f32x8::splat(simd, d.y),
                f32x8::splat(simd, d.z),
            ],
            t_max: f32x8::splat(simd, ray.t_max),
        }
    }
}
