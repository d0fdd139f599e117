//! Brute force in `f64`.

use glam::Vec3;
use std::fmt::Debug;
use tyndall_bvh::Discs;
use tyndall_core::Ray;

/// What the crate promises: distances to the ray are right to this much of the distance to its
/// origin, so that a rim as near to the ray as that may be met or not. Its doc derives it.
const PROMISE: f64 = 1e-6;
/// What the squares of three coordinates may lose when they underflow: √3 · 2⁻⁷⁵.
const UNDERFLOW: f64 = 4.6e-23;

/// A disc or a sphere as a ray meets it.
struct Pass {
    t: f64,
    d: f64,
    /// What rounding may do to both.
    slack: f64,
}

fn pass(ray: &Ray, center: Vec3) -> Pass {
    let direction = ray.direction.as_dvec3();
    let to_center = center.as_dvec3() - ray.origin.as_dvec3();
    let t = to_center.dot(direction);
    Pass {
        t,
        d: (to_center - t * direction).length(),
        slack: PROMISE * to_center.length() + UNDERFLOW,
    }
}

/// Whether `x` lies in `[0, t_max]`: `None` if that is too close to call.
fn within(x: f64, t_max: f32, slack: f64) -> Option<bool> {
    let t_max = f64::from(t_max);
    match x {
        _ if x.abs() <= slack || (x - t_max).abs() <= slack => None,
        _ => Some(0.0 < x && x < t_max),
    }
}

/// How many of the discs were met for certain, and how many were too close to call.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Verdict {
    pub met: usize,
    pub unsure: usize,
}

impl Verdict {
    /// That more than `met` were met for certain, and less than `unsure` times as many were too
    /// close to call.
    pub(crate) fn assert(self, met: usize, unsure: f64, case: impl Debug) {
        let few = (self.unsure as f64) < unsure * self.met as f64;
        assert!(self.met > met && few, "{case:?}: {self:?}");
    }
}

/// Whether a disc is passed: `None` if that is too close to call.
fn passed(pass: &Pass, radius: f64, t_max: f32) -> Option<bool> {
    let inside = match pass.d - radius {
        past if past.abs() <= pass.slack && radius > 0.0 => None,
        past => Some(past < 0.0),
    };
    match (inside, within(pass.t, t_max, pass.slack)) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    }
}

/// Whether some part of the ray is inside a sphere: `None` if that is too close to call.
fn entered(pass: &Pass, radius: f64, t_max: f32) -> Option<bool> {
    // The square of the radius is rounded as well: half a unit in the last place of the radius.
    let slack = pass.slack + radius * f64::from(f32::EPSILON) / 4.0;
    let length = |d: f64| {
        let half = (radius * radius - d * d).max(0.0).sqrt();
        half.min(pass.t) + half.min(f64::from(t_max) - pass.t)
    };
    // One of the two terms at most has an error of `t`; in the sum of both it cancels.
    let surely = pass.d + slack < radius && length(pass.d + slack) > slack;
    let near = (pass.d - slack).max(0.0);
    let perhaps = radius > 0.0 && near <= radius && length(near) >= -slack;
    (surely == perhaps).then_some(surely)
}

/// Holds [`Discs::along`] against brute force.
pub(crate) fn check_along(discs: &Discs, ray: &Ray) -> Verdict {
    let mut hits = vec![None; discs.len()];
    discs.along(ray, |slot, t, d2| {
        assert!(hits[slot].replace((t, d2)).is_none(), "slot {slot} twice");
        assert!((0.0..=ray.t_max).contains(&t));
    });
    check(discs, ray, &hits, passed)
}

/// Holds [`Discs::chords`] against brute force.
pub(crate) fn check_chords(discs: &Discs, ray: &Ray) -> Verdict {
    let mut hits = vec![None; discs.len()];
    discs.chords(ray, |slot, t, d2| {
        assert!(hits[slot].replace((t, d2)).is_none(), "slot {slot} twice");
    });
    check(discs, ray, &hits, entered)
}

/// Holds what was visited of each slot, `(t, d²)`, against what is `certain`.
fn check(
    discs: &Discs,
    ray: &Ray,
    hits: &[Option<(f32, f32)>],
    certain: impl Fn(&Pass, f64, f32) -> Option<bool>,
) -> Verdict {
    let mut verdict = Verdict::default();
    for (slot, hit) in hits.iter().enumerate() {
        let pass = pass(ray, discs.center(slot));
        let radius = discs.radius(slot);
        match certain(&pass, f64::from(radius), ray.t_max) {
            Some(met) => {
                let place = (pass.t, pass.d, radius);
                assert_eq!(hit.is_some(), met, "slot {slot} of {ray:?}: {place:?}");
                verdict.met += usize::from(met);
            }
            None => verdict.unsure += 1,
        }
        if let Some((t, d2)) = *hit {
            assert!(d2 < radius * radius);
            assert!((f64::from(t) - pass.t).abs() <= pass.slack);
            let d = f64::from(d2).sqrt();
            assert!((d - pass.d).abs() <= pass.slack, "{d} is {}", pass.d);
        }
    }
    verdict
}
