//! Beams as they are given, and pieces as they are shown.

use crate::{BuildError, LIMIT, is_within};
use glam::{DVec3, Vec3};
use std::ops::RangeInclusive;

/// Where a beam is: the points `origin + v·direction` for v in `[0, length)`, and what is nearer to
/// them than a radius that grows or shrinks linearly, within limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamShape {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Its length in scene units.
    pub length: f32,
    /// Radius at its start and at its end. Where their signs differ, it runs through a focus.
    pub radii: [f32; 2],
    /// Its radius is nowhere less than the first, nor more than the second.
    pub limits: [f32; 2],
}

impl BeamShape {
    /// Limits that keep no radius.
    pub const UNLIMITED: [f32; 2] = [0.0, LIMIT];

    /// The point at distance `v`.
    #[inline]
    pub fn at(&self, v: f64) -> DVec3 {
        self.origin.as_dvec3() + v * self.direction.as_dvec3()
    }

    /// The radius at distance `v` of a beam that has a length.
    ///
    /// ```
    /// use glam::Vec3;
    /// use tyndall_bvh::BeamShape;
    /// let focused = BeamShape {
    ///     origin: Vec3::ZERO,
    ///     direction: Vec3::Z,
    ///     length: 10.0,
    ///     radii: [1.0, -1.0],
    ///     limits: [0.25, 0.5],
    /// };
    /// let radii = [0.0, 3.125, 5.0, 10.0].map(|v| focused.radius(v));
    /// assert_eq!(radii, [0.5, 0.375, 0.25, 0.5]);
    /// ```
    #[inline]
    pub fn radius(&self, v: f64) -> f64 {
        let [start, end] = self.radii.map(f64::from);
        let radius = start + (end - start) * (v / f64::from(self.length));
        let [least, most] = self.limits.map(f64::from);
        radius.abs().clamp(least, most)
    }

    /// Whether [`Beams::build`](crate::Beams::build) takes it.
    pub fn is_valid(&self) -> bool {
        self.fault(0).is_none()
    }

    /// The largest radius, which is at one of its ends.
    pub(super) fn largest(&self) -> f32 {
        let [start, end] = self.radii;
        let [least, most] = self.limits;
        start.abs().max(end.abs()).clamp(least, most)
    }

    /// Whether there is anything to meet.
    pub(super) fn has_volume(&self) -> bool {
        self.length > 0.0 && self.largest() > 0.0
    }

    /// What is wrong with it.
    pub(super) fn fault(&self, index: usize) -> Option<BuildError> {
        let end = self.at(f64::from(self.length)).as_vec3();
        if !is_within(self.origin) {
            Some(BuildError::NotFinite { index })
        } else if !UNIT.contains(&self.direction.length()) {
            Some(BuildError::Direction { index })
        } else if !(0.0..=f32::MAX).contains(&self.length) || !is_within(end) {
            Some(BuildError::Length { index })
        } else if !self.has_radii() {
            Some(BuildError::Radius { index })
        } else {
            None
        }
    }

    fn has_radii(&self) -> bool {
        let [least, most] = self.limits;
        let limits = 0.0 <= least && least <= most && most <= LIMIT;
        limits && self.radii.iter().all(|r| r.abs() <= LIMIT)
    }
}

/// Lengths that a direction may have.
const UNIT: RangeInclusive<f32> = 0.999..=1.001;

/// A piece of a beam: its points of distances in `[start, end)`.
///
/// The pieces of a beam hold every distance in `[0, length)` once: the end of one is to the bit the
/// start of the next, the first starts at 0, and the last ends at `length`, which is no longer of
/// the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The index of the beam, as given to [`Beams::build`](crate::Beams::build).
    pub beam: usize,
    /// The distance where it starts.
    pub start: f32,
    /// The distance where it ends.
    pub end: f32,
}

impl Piece {
    /// Whether the place at distance `v` of its beam is in this piece.
    #[inline]
    pub fn holds(&self, v: f64) -> bool {
        f64::from(self.start) <= v && v < f64::from(self.end)
    }
}
