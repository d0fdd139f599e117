//! Photon discs that face the ray, and the spheres around them.

use crate::{BrokenTree, BuildError, Bvh, LANES, LEAF, LIMIT, Met, Quality, is_within};
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::{Aabb, Ray};
use wide::f32x8;

/// Discs of given centres and radii which turn to face every ray that meets them.
#[derive(Clone, Debug)]
pub struct Discs {
    bvh: Bvh,
    /// A sphere around each block of a leaf: rounder than a box, a third fewer blocks are tested.
    leaves: Vec<Block>,
    blocks: Vec<Block>,
    order: Vec<u32>,
}

/// Eight spheres side by side.
#[derive(Clone, Debug)]
#[repr(align(128))]
struct Block {
    center: [f32x8; 3],
    radius: f32x8,
}

impl Discs {
    /// Discs of `radii` around `centers`. Those of radius 0 are never met.
    ///
    /// # Errors
    /// A centre or a radius is not finite or beyond 1e18, a radius is negative, there is not one
    /// radius a centre, or there are more than `u32::MAX`.
    pub fn build(centers: &[Vec3], radii: &[f32], quality: Quality) -> Result<Self, BuildError> {
        if centers.len() != radii.len() {
            return Err(BuildError::Lengths {
                centers: centers.len(),
                radii: radii.len(),
            });
        }
        if let Some(index) = centers.iter().position(|&center| !is_within(center)) {
            return Err(BuildError::NotFinite { index });
        }
        if let Some(index) = radii.iter().position(|r| !(0.0..=LIMIT).contains(r)) {
            return Err(BuildError::Radius { index });
        }
        let bounds: Vec<Aabb> = centers
            .par_iter()
            .zip(radii)
            .map(|(&center, &radius)| around(center, radius))
            .collect();
        let (bvh, order) = Bvh::over(&bounds, quality)?;
        let disc = |&i: &u32| (centers[i as usize], radii[i as usize]);
        let blocks = order
            .par_chunks(LANES)
            .map(|slots| Block::new(slots.iter().map(disc), 0.0))
            .collect();
        let screen = |block: &[u32]| sphere(block.iter().map(disc));
        let leaves = order
            .par_chunks(LEAF)
            .map(|slots| Block::new(slots.chunks(LANES).map(screen), f32::NEG_INFINITY))
            .collect();
        Ok(Self {
            bvh,
            leaves,
            blocks,
            order,
        })
    }

    /// The index given to [`Discs::build`] of the disc in each slot.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `visit(slot, t, d²)` once for every disc that the ray passes through at distance `t`
    /// in `[0, t_max]`; d² < r² is its squared distance from the centre there.
    #[inline]
    pub fn along(&self, ray: &Ray, mut visit: impl FnMut(usize, f32, f32)) {
        let visit = |met: &Met<'_, 2>| met.each(|slot, [t, d2]| visit(slot, t, d2));
        self.facing(ray, |d2, _| d2, visit);
    }

    /// As [`Discs::along`], by blocks of eight, some at a time: [`Met::values`] are `t` and d²/r²,
    /// 0 and infinite for those that are not met.
    #[inline]
    pub fn blocks_along(&self, ray: &Ray, visit: impl FnMut(&Met<'_, 2>)) {
        self.facing(ray, |d2, r2| d2 / r2, visit);
    }

    /// Visits discs that the ray passes through; values are `t` and that of d² and r².
    #[inline]
    fn facing(
        &self,
        ray: &Ray,
        value: impl Fn(f32x8, f32x8) -> f32x8,
        visit: impl FnMut(&Met<'_, 2>),
    ) {
        let line = Line::new(ray);
        let test = |block: usize| {
            let block = &self.blocks[block];
            let (t, d2) = block.closest(&line);
            let r2 = block.radius * block.radius;
            let met = d2.simd_lt(r2) & t.simd_ge(f32x8::ZERO) & t.simd_le(line.t_max);
            let missed = f32x8::splat(f32::INFINITY);
            let values = [
                met.select(t, f32x8::ZERO),
                met.select(value(d2, r2), missed),
            ];
            (met.to_bitmask(), values)
        };
        (self.bvh).meet(ray, |leaf| self.leaves[leaf].touched(&line), test, visit);
    }

    /// Calls `visit(slot, t, d²)` once for every sphere that the ray is inside of for some part of
    /// `[0, t_max]`: the distance `t`, negative or beyond `t_max` too, at which its line passes
    /// the centre, and the squared distance d² < r² there.
    ///
    /// The chord h = √(r² − d²) to both sides of `t` is as long as min(h, t) + min(h, `t_max` − t)
    /// in that range; the difference of its ends would lose spheres small against `t`.
    #[inline]
    pub fn chords(&self, ray: &Ray, mut visit: impl FnMut(usize, f32, f32)) {
        self.blocks_chords(ray, |met| met.each(|slot, [t, d2]| visit(slot, t, d2)));
    }

    /// As [`Discs::chords`], by blocks of eight, some at a time: [`Met::values`] are `t` and d²,
    /// whatever they may be for those that are not met.
    #[inline]
    pub fn blocks_chords(&self, ray: &Ray, visit: impl FnMut(&Met<'_, 2>)) {
        let line = Line::new(ray);
        let test = |block: usize| {
            let block = &self.blocks[block];
            let (t, d2) = block.closest(&line);
            let r2 = block.radius * block.radius;
            let half = (r2 - d2).sqrt(); // NaN outside
            let length = half.fast_min(t) + half.fast_min(line.t_max - t);
            let met = d2.simd_lt(r2) & length.simd_gt(f32x8::ZERO);
            (met.to_bitmask(), [t, d2])
        };
        (self.bvh).meet(ray, |leaf| self.leaves[leaf].touched(&line), test, visit);
    }

    /// The centre of the disc in a slot.
    ///
    /// # Panics
    /// There is no such slot.
    pub fn center(&self, slot: usize) -> Vec3 {
        self.disc(slot).0
    }

    /// The radius of the disc in a slot.
    ///
    /// # Panics
    /// There is no such slot.
    pub fn radius(&self, slot: usize) -> f32 {
        self.disc(slot).1
    }

    /// Discs, those of radius 0 included.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Bytes of nodes, discs and order.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes()
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.blocks.as_slice())
            + size_of_val(self.order.as_slice())
    }

    /// As [`Bvh::validate`].
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), BrokenTree> {
        let outside = |&slot: &usize| {
            let (middle, reach) = self.leaves[slot / LEAF].get(slot / LANES % LANES);
            middle.distance(self.center(slot)) + self.radius(slot) > reach
        };
        if let Some(slot) = (0..self.len()).find(outside) {
            return Err(BrokenTree::Sphere { slot });
        }
        self.bvh
            .validate(|slot| around(self.center(slot), self.radius(slot)))
    }

    fn disc(&self, slot: usize) -> (Vec3, f32) {
        assert!(slot < self.len(), "slot {slot} of {}", self.len());
        self.blocks[slot / LANES].get(slot % LANES)
    }
}

/// The box of a sphere.
fn around(center: Vec3, radius: f32) -> Aabb {
    Aabb {
        min: center - radius,
        max: center + radius,
    }
}

/// The sphere around spheres, about the middle of their centres.
fn sphere(discs: impl Iterator<Item = (Vec3, f32)> + Clone) -> (Vec3, f32) {
    let middle = Aabb::of_points(discs.clone().map(|(center, _)| center)).center();
    let radius = discs
        .map(|(center, radius)| center.distance(middle) + radius)
        .fold(0.0, f32::max);
    (middle, radius * (1.0 + ROUNDING))
}

/// Of distances to the ray, relative to how far along it they are: 16u, as the crate doc counts.
const ROUNDING: f32 = 1e-6;

/// A ray eight times.
struct Line {
    origin: [f32x8; 3],
    direction: [f32x8; 3],
    t_max: f32x8,
}

impl Line {
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array().map(f32x8::splat),
            direction: ray.direction.to_array().map(f32x8::splat),
            t_max: f32x8::splat(ray.t_max),
        }
    }
}

impl Block {
    fn new(spheres: impl Iterator<Item = (Vec3, f32)>, missing: f32) -> Self {
        let mut block = Self {
            center: [f32x8::ZERO; 3],
            radius: f32x8::splat(missing),
        };
        for (lane, (center, radius)) in spheres.enumerate() {
            for (lanes, x) in block.center.iter_mut().zip(center.to_array()) {
                lanes.as_mut_array()[lane] = x;
            }
            block.radius.as_mut_array()[lane] = radius;
        }
        block
    }

    fn get(&self, lane: usize) -> (Vec3, f32) {
        let of_lane = |values: f32x8| values.as_array()[lane];
        let center = self.center.map(of_lane);
        (Vec3::from_array(center), of_lane(self.radius))
    }

    /// Where the line passes the centres, and the squared distance there. From the difference and
    /// its part across the ray: |w|² − (w·d)² would cancel.
    #[inline]
    fn closest(&self, line: &Line) -> (f32x8, f32x8) {
        let [x, y, z] = [0, 1, 2].map(|axis| self.center[axis] - line.origin[axis]);
        let [dx, dy, dz] = line.direction;
        let t = x * dx + y * dy + z * dz;
        let [x, y, z] = [x - t * dx, y - t * dy, z - t * dz];
        (t, x * x + y * y + z * z)
    }

    /// A bit for each sphere that the ray touches; none for a radius of −∞.
    #[inline]
    fn touched(&self, line: &Line) -> u32 {
        let (t, d2) = self.closest(line);
        let reach = self.radius + t.abs() * f32x8::splat(ROUNDING);
        let met = d2.simd_lt(reach * reach)
            & (t + reach).simd_ge(f32x8::ZERO)
            & (t - reach).simd_le(line.t_max);
        met.to_bitmask()
    }
}
