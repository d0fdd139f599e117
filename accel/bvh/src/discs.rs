//! Photon discs that face the ray, and the spheres around them.

use crate::{BrokenTree, BuildError, Bvh, LANES, LEAF, LIMIT, Met, Quality, Query, is_within};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;
use rayon::prelude::*;
use tyndall_core::{Aabb, Ray};

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
    center: [[f32; LANES]; 3],
    radius: [f32; LANES],
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
        self.blocks_along(ray, |met| {
            met.each().for_each(|(slot, [t, d2])| visit(slot, t, d2));
        });
    }

    /// As [`Discs::along`], by blocks of eight: [`Met::values`] are `t` and d², 0 and infinite for
    /// those that are not met.
    #[inline]
    pub fn blocks_along(&self, ray: &Ray, visit: impl FnMut(Met<2>)) {
        self.bvh.meet(ray, &Facing { discs: self, ray }, visit);
    }

    /// Calls `visit(slot, t, d²)` once for every sphere that the ray is inside of for some part of
    /// `[0, t_max]`: the distance `t`, negative or beyond `t_max` too, at which its line passes
    /// the centre, and the squared distance d² < r² there.
    ///
    /// The chord h = √(r² − d²) to both sides of `t` is as long as min(h, t) + min(h, `t_max` − t)
    /// in that range; the difference of its ends would lose spheres small against `t`.
    #[inline]
    pub fn chords(&self, ray: &Ray, mut visit: impl FnMut(usize, f32, f32)) {
        self.blocks_chords(ray, |met| {
            met.each().for_each(|(slot, [t, d2])| visit(slot, t, d2));
        });
    }

    /// As [`Discs::chords`], by blocks of eight: [`Met::values`] are `t` and d², whatever they may
    /// be for those that are not met.
    #[inline]
    pub fn blocks_chords(&self, ray: &Ray, visit: impl FnMut(Met<2>)) {
        self.bvh.meet(ray, &Inside { discs: self, ray }, visit);
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

impl Block {
    fn new(spheres: impl Iterator<Item = (Vec3, f32)>, missing: f32) -> Self {
        let mut block = Self {
            center: [[0.0; LANES]; 3],
            radius: [missing; LANES],
        };
        for (lane, (center, radius)) in spheres.enumerate() {
            for (lanes, x) in block.center.iter_mut().zip(center.to_array()) {
                lanes[lane] = x;
            }
            block.radius[lane] = radius;
        }
        block
    }

    fn get(&self, lane: usize) -> (Vec3, f32) {
        let center = self.center.map(|values| values[lane]);
        (Vec3::from_array(center), self.radius[lane])
    }

    /// Where the line passes the centres, and the squared distance there. From the difference and
    /// its part across the ray: |w|² − (w·d)² would cancel.
    #[inline(always)]
    fn closest<S: Simd>(&self, simd: S, ray: &Ray) -> (f32x8<S>, f32x8<S>) {
        let [x, y, z] = &self.center;
        let x = f32x8::from_slice(simd, x) - ray.origin.x;
        let y = f32x8::from_slice(simd, y) - ray.origin.y;
        let z = f32x8::from_slice(simd, z) - ray.origin.z;
        let [dx, dy, dz] = ray.direction.to_array();
        let t = x * dx + y * dy + z * dz;
        let [x, y, z] = [x - t * dx, y - t * dy, z - t * dz];
        (t, x * x + y * y + z * z)
    }

    /// A bit for each sphere that the ray touches; none for a radius of −∞.
    #[inline(always)]
    fn touched<S: Simd>(&self, simd: S, ray: &Ray) -> u32 {
        let (t, d2) = self.closest(simd, ray);
        let reach = f32x8::from_slice(simd, &self.radius) + t.abs() * ROUNDING;
        let met =
            d2.simd_lt(reach * reach) & (t + reach).simd_ge(0.0) & (t - reach).simd_le(ray.t_max);
        met.to_bitmask() as u32
    }
}

/// Which discs does the ray pass through?
struct Facing<'a> {
    discs: &'a Discs,
    ray: &'a Ray,
}

impl Query<2> for Facing<'_> {
    #[inline(always)]
    fn screen<S: Simd>(&self, simd: S, leaf: usize) -> u32 {
        self.discs.leaves[leaf].touched(simd, self.ray)
    }

    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: usize) -> (u32, [f32x8<S>; 2]) {
        let block = &self.discs.blocks[block];
        let (t, d2) = block.closest(simd, self.ray);
        let radius = f32x8::from_slice(simd, &block.radius);
        let within = t.simd_ge(0.0) & t.simd_le(self.ray.t_max);
        let met = d2.simd_lt(radius * radius) & within;
        let missed = f32x8::splat(simd, f32::INFINITY);
        let [t, d2] = [
            met.select(t, f32x8::splat(simd, 0.0)),
            met.select(d2, missed),
        ];
        (met.to_bitmask() as u32, [t, d2])
    }
}

/// Which spheres is the ray inside of?
struct Inside<'a> {
    discs: &'a Discs,
    ray: &'a Ray,
}

impl Query<2> for Inside<'_> {
    #[inline(always)]
    fn screen<S: Simd>(&self, simd: S, leaf: usize) -> u32 {
        self.discs.leaves[leaf].touched(simd, self.ray)
    }

    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: usize) -> (u32, [f32x8<S>; 2]) {
        let block = &self.discs.blocks[block];
        let (t, d2) = block.closest(simd, self.ray);
        let radius = f32x8::from_slice(simd, &block.radius);
        let r2 = radius * radius;
        let half = (r2 - d2).sqrt(); // NaN outside
        let length = half.min(t) + half.min(self.ray.t_max - t);
        let met = d2.simd_lt(r2) & length.simd_gt(0.0);
        (met.to_bitmask() as u32, [t, d2])
    }
}
