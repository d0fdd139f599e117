//! Lines of pieces in whole numbers: a first test, which rules out most of them.

use super::leaf::{Line, ROUNDING, UNDERFLOW};
use super::segment::Segment;
use crate::{LANES, LEAF};
use fearless_simd::{Simd, f32x8, i16x16, i32x8, prelude::*};
use glam::{DVec3, Vec3};
use tyndall_core::Aabb;

/// What 1 is in whole numbers.
const ONE: f32 = 27_000.0;
/// No sum of products is larger, of 31 bits: (1 + √3) of its square and what rounding adds.
const MOST: f32 = 2e9;
/// What rounding to whole numbers does at most to a sum of products, in the same: those of a ray are
/// off by 1, those of a piece by a half, each of four vectors is met by one whose coordinates add up
/// to √3, and products of two errors add 3.
const ROUNDED: f32 = 2.0 * 1.5 * 1.7321 * ONE + 3.0;
/// The least radius of a ball: numbers over it are finite.
const LEAST: f64 = 1e-25;

/// A ball that pieces lie in.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ball {
    center: Vec3,
    radius: f32,
}

/// Plücker coordinates of eight lines: their moments about the centre of a ball, over its radius,
/// and their directions. Pairs are side by side.
#[derive(Clone, Debug, PartialEq)]
#[repr(align(32))]
pub(super) struct Lines([[i16; 2 * LANES]; 3]);

impl Ball {
    pub(super) fn around(segments: &[Segment]) -> Self {
        let bounds = segments.iter().map(Segment::bounds);
        let center = bounds.fold(Aabb::EMPTY, Aabb::union).center();
        let reach = |segment: &Segment| {
            let [a, b] = segment.ends.map(|end| end.distance(center.as_dvec3()));
            a.max(b) + segment.radius
        };
        let radius = segments.iter().map(reach).fold(LEAST, f64::max) as f32;
        Self {
            center,
            radius: radius.next_up(),
        }
    }

    /// The lines of up to eight pieces; the last again in what is left over.
    pub(super) fn lines(&self, segments: &[Segment]) -> Lines {
        let mut lines = Lines([[0; 2 * LANES]; 3]);
        for lane in 0..LANES {
            let segment = &segments[lane.min(segments.len() - 1)];
            let from = (segment.ends[0] - self.center.as_dvec3()) / f64::from(self.radius);
            let direction = segment.direction;
            let whole = |v: DVec3| (v * f64::from(ONE)).to_array().map(|x| x.round() as i16);
            let [a, b, c] = whole(from.cross(direction));
            let [d, e, f] = whole(direction);
            for (pairs, pair) in lines.0.iter_mut().zip([[a, b], [c, d], [e, f]]) {
                pairs[2 * lane..][..2].copy_from_slice(&pair);
            }
        }
        lines
    }

    /// What a ray has to do with it; `None` if it passes by.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn seen<S: Simd>(&self, line: &Line<S>) -> Option<Seen<S>> {
        let from = line.origin - self.center;
        let moment = from.cross(line.toward);
        let rounding = ROUNDING * (from.abs().element_sum() + self.radius);
        let passes = self.radius + rounding + UNDERFLOW as f32;
        if moment.length_squared() > passes * passes {
            return None;
        }
        let scale = ONE / self.radius;
        let [x, y, z] = (moment * scale)
            .clamp(Vec3::splat(-ONE), Vec3::splat(ONE))
            .to_array();
        let d = line.toward * ONE;
        let simd = line.simd;
        let unit = ONE * scale;
        Some(Seen {
            pairs: [[d.x, d.y], [d.z, x], [y, z]].map(|pair| splat(simd, pair)),
            unit,
            rounding: rounding * unit + ROUNDED,
        })
    }
}

/// A ray in the whole numbers of a ball.
pub(super) struct Seen<S: Simd> {
    pairs: [i16x16<S>; 3],
    /// What a distance of 1 is.
    unit: f32,
    rounding: f32,
}

impl<S: Simd> Seen<S> {
    /// How far lines are seen to be that are so far, for all blocks of a leaf.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn whole(&self, reaches: &[f32; LEAF / LANES]) -> [i32; LEAF / LANES] {
        let simd = self.pairs[0].simd;
        let reaches = f32x8::from_slice(simd, reaches) * self.unit + self.rounding;
        let whole: i32x8<S> = (reaches * (1.0 + 1e-6)).min(MOST).to_int();
        whole.into()
    }

    /// A bit for each piece whose line is so near that of the ray: no two of their points are closer
    /// than the lines are. The sum is their distance times the sine of their angle, which is 1 at
    /// most.
    #[inline(always)] // into code for the level of the machine
    pub(super) fn near(&self, lines: &Lines, reach: i32) -> u32 {
        let simd = self.pairs[0].simd;
        let [a, b, c] = [0, 1, 2].map(|i| -> i32x8<S> {
            i16x16::from_slice(simd, &lines.0[i]).pairwise_dot_product(self.pairs[i])
        });
        let sum = a + b + c;
        let zero = i32x8::splat(simd, 0);
        let near = sum.max(zero - sum).simd_le(i32x8::splat(simd, reach));
        near.to_bitmask() as u32
    }
}

/// Eight times a pair of whole numbers.
#[inline(always)]
fn splat<S: Simd>(simd: S, pair: [f32; 2]) -> i16x16<S> {
    let [low, high] = pair.map(|x| x as i32);
    i32x8::splat(simd, low & 0xffff | high << 16).bitcast()
}
