//! Eight pieces side by side, and how near a ray comes to them.

use crate::LANES;
use glam::{DVec3, Vec3};
use tyndall_core::{Aabb, Ray};
use wide::f32x8;

/// What a piece is while it is built: a segment and what is within a radius of it.
pub(super) struct Segment {
    pub ends: [DVec3; 2],
    pub radius: f64,
}

impl Segment {
    /// A capsule around segments, along their mean direction: for a bundle, much less than a box;
    /// a sphere, if they point anywhere.
    pub(super) fn around(segments: &[Self]) -> Self {
        let mut axis = DVec3::ZERO;
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &Self { ends: [a, b], .. } in segments {
            let along = b - a;
            axis += if axis.dot(along) < 0.0 { -along } else { along };
            (min, max) = (min.min(a.min(b)), max.max(a.max(b)));
        }
        let (middle, axis) = (0.5 * (min + max), axis.normalize_or_zero());
        // How far along the axis and how far off it their ends are.
        let ends = segments.iter().flat_map(|&Self { ends, radius }| {
            ends.map(|end| {
                let along = (end - middle).dot(axis);
                (along, (end - middle - along * axis).length(), radius)
            })
        });
        let off = ends.clone().map(|(_, off, radius)| off + radius);
        let reach = off.fold(0.0, f64::max);
        // The balls at the ends of the capsule hold what is beyond them.
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (along, off, radius) in ends {
            let ball = ((reach - radius).powi(2) - off * off).max(0.0).sqrt();
            (from, to) = (from.min(along + ball), to.max(along - ball));
        }
        if from > to {
            (from, to) = (0.5 * (from + to), 0.5 * (from + to));
        }
        Self {
            ends: [from, to].map(|v| middle + v * axis),
            radius: reach,
        }
    }

    /// The smallest box around it, rounded to the outside.
    pub(super) fn bounds(&self) -> Aabb {
        let [a, b] = self.ends;
        let [min, max] = [a.min(b) - self.radius, a.max(b) + self.radius].map(DVec3::as_vec3);
        Aabb {
            min: min.map(f32::next_down),
            max: max.map(f32::next_up),
        }
    }
}

/// Eight segments, relative to a point among them: far from the origin of the scene, places lose
/// no digits. Nothing is near where there is no segment.
#[derive(Clone, Debug)]
#[repr(align(128))]
pub(super) struct Block {
    start: [f32x8; 3],
    /// From start to end.
    along: [f32x8; 3],
    /// With what rounding may do, but for that which grows with the distance of a ray.
    reach: f32x8,
    reference: Vec3,
    /// Which piece of its beam each is.
    numbers: [u16; LANES],
}

/// Of distances, relative to those to the origin of the ray: 50u, as the crate doc counts.
const ROUNDING: f32 = 3e-6;
/// More than what squares lose when they underflow.
const UNDERFLOW: f64 = 1e-18;

impl Block {
    /// Segments, and which piece of its beam each is.
    pub(super) fn new(segments: &[Segment], number: impl Fn(usize) -> u16) -> Self {
        let starts = segments.iter().map(|segment| segment.ends[0].as_vec3());
        let mut block = Self {
            start: [f32x8::splat(f32::NAN); 3],
            along: [f32x8::ZERO; 3],
            reach: f32x8::ZERO,
            reference: Aabb::of_points(starts).center(),
            numbers: [0; LANES],
        };
        for (lane, &Segment { ends, radius }) in segments.iter().enumerate() {
            let start = ends[0] - block.reference.as_dvec3();
            let along = ends[1] - ends[0];
            for axis in 0..3 {
                block.start[axis].as_mut_array()[lane] = start[axis] as f32;
                block.along[axis].as_mut_array()[lane] = along[axis] as f32;
            }
            let size = 2.0 * radius + start.length() + 2.0 * along.length();
            let reach = radius + f64::from(ROUNDING) * size + UNDERFLOW;
            block.reach.as_mut_array()[lane] = reach as f32;
            block.numbers[lane] = number(lane);
        }
        block
    }

    /// Whether a segment is inside of that in a lane.
    pub(super) fn holds(&self, lane: usize, segment: &Segment) -> bool {
        let of_lane = |lanes: [f32x8; 3]| {
            Vec3::from_array(lanes.map(|values| values.as_array()[lane])).as_dvec3()
        };
        let [start, along] = [self.start, self.along].map(of_lane);
        let room = f64::from(self.reach.as_array()[lane]) - segment.radius;
        segment.ends.iter().all(|&end| {
            let from = end - self.reference.as_dvec3() - start;
            let least = f64::MIN_POSITIVE;
            let v = (from.dot(along) / along.length_squared().max(least)).clamp(0.0, 1.0);
            (from - v * along).length() <= room
        })
    }

    #[inline]
    pub(super) fn number(&self, lane: usize) -> u16 {
        self.numbers[lane]
    }

    /// A bit for each segment that the ray comes near: closest points of two segments (Ericson 2005,
    /// "Real-time collision detection", 5.1.9), by the parts along the ray and across it. The
    /// difference of the origins comes first, and what is across is made from vectors: nothing
    /// cancels where the two are parallel, or far from the origin of the scene.
    #[inline]
    pub(super) fn near(&self, line: &Line) -> u32 {
        let [zero, one] = [f32x8::ZERO, f32x8::ONE];
        let [dx, dy, dz] = line.direction;
        let offset = (self.reference - line.origin).to_array().map(f32x8::splat);
        // The start from the origin of the ray, and the piece: so far along the ray, and across.
        let [x, y, z] = [0, 1, 2].map(|axis| offset[axis] + self.start[axis]);
        let [ex, ey, ez] = self.along;
        // No two of their points are closer than the lines are: of most pieces that is enough.
        let [nx, ny, nz] = [dy * ez - dz * ey, dz * ex - dx * ez, dx * ey - dy * ex];
        let triple = (x * nx + y * ny + z * nz).abs();
        let sizes = (x.abs() + y.abs() + z.abs()) * (ex.abs() + ey.abs() + ez.abs());
        let most = self.reach * (nx * nx + ny * ny + nz * nz).sqrt();
        if triple
            .simd_le(most + sizes * f32x8::splat(ROUNDING))
            .to_bitmask()
            == 0
        {
            return 0;
        }
        let from = x * dx + y * dy + z * dz;
        let [x, y, z] = [x - from * dx, y - from * dy, z - from * dz];
        let along = ex * dx + ey * dy + ez * dz;
        let [ex, ey, ez] = [ex - along * dx, ey - along * dy, ez - along * dz];
        // Where the piece is closest to the line; where the ray is closest to that; and back.
        let across2 = ex * ex + ey * ey + ez * ez;
        let facing = x * ex + y * ey + z * ez;
        let least = f32x8::splat(f32::MIN_POSITIVE);
        let v = (-facing / across2.fast_max(least))
            .fast_max(zero)
            .fast_min(one);
        let t = (from + v * along).fast_max(zero).fast_min(line.t_max);
        let length2 = (across2 + along * along).fast_max(least);
        let v = (-(facing + (from - t) * along) / length2)
            .fast_max(zero)
            .fast_min(one);
        let [x, y, z] = [x + v * ex, y + v * ey, z + v * ez];
        let w = from + v * along - t;
        let reach = self.reach + from.abs() * f32x8::splat(ROUNDING);
        (x * x + y * y + z * z + w * w)
            .simd_le(reach * reach)
            .to_bitmask()
    }
}

/// A ray, prepared for [`Block::near`].
pub(super) struct Line {
    origin: Vec3,
    direction: [f32x8; 3],
    t_max: f32x8,
}

impl Line {
    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin,
            direction: ray.direction.to_array().map(f32x8::splat),
            t_max: f32x8::splat(ray.t_max),
        }
    }
}
