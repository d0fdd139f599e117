//! Brute force in `f64`.

use glam::Vec3;
use tyndall_bvh::Discs;
use tyndall_core::Ray;

/// What the crate promises: distances to the ray are right to this much of the distance to its
/// origin, so that a rim as near to the ray as that may be met or not.
const PROMISE: f64 = 1e-6;

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
        slack: PROMISE * to_center.length(),
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
#[derive(Default)]
pub(crate) struct Verdict {
    pub met: usize,
    pub unsure: usize,
}

/// Holds [`Discs::along`] against brute force.
pub(crate) fn check_along(discs: &Discs, ray: &Ray) -> Verdict {
    let mut hits = vec![None; discs.len()];
    discs.along(ray, |slot, t, d2| {
        assert!(hits[slot].replace((t, d2)).is_none(), "slot {slot} twice");
    });
    let mut verdict = Verdict::default();
    for (slot, hit) in hits.into_iter().enumerate() {
        let pass = pass(ray, discs.center(slot));
        let radius = f64::from(discs.radius(slot));
        let rim = (pass.d - radius).abs() <= pass.slack && radius > 0.0;
        let certain = match within(pass.t, ray.t_max, pass.slack) {
            Some(false) => Some(false),
            _ if rim => None,
            within => within
                .map(|_| pass.d < radius)
                .or((pass.d > radius).then_some(false)),
        };
        match certain {
            Some(met) => assert_eq!(
                hit.is_some(),
                met,
                "slot {slot} of {ray:?}: {}",
                pass.d / radius
            ),
            None => verdict.unsure += 1,
        }
        if let Some((t, d2)) = hit {
            verdict.met += 1;
            assert!((0.0..=ray.t_max).contains(&t));
            assert!((f64::from(t) - pass.t).abs() <= pass.slack);
            let d = f64::from(d2).sqrt();
            assert!((d - pass.d).abs() <= pass.slack, "{d} is {}", pass.d);
        }
    }
    verdict
}

/// Holds [`Discs::chords`] against brute force.
pub(crate) fn check_chords(discs: &Discs, ray: &Ray) -> Verdict {
    let mut hits = vec![None; discs.len()];
    discs.chords(ray, |slot, d2, t0, t1| {
        assert!(
            hits[slot].replace((d2, t0, t1)).is_none(),
            "slot {slot} twice"
        );
    });
    let mut verdict = Verdict::default();
    for (slot, hit) in hits.into_iter().enumerate() {
        let pass = pass(ray, discs.center(slot));
        let radius = f64::from(discs.radius(slot));
        let half = |d: f64| (radius * radius - d * d).max(0.0).sqrt();
        let cut = |d: f64| {
            let t_max = f64::from(ray.t_max);
            (pass.t - half(d)).max(0.0)..(pass.t + half(d)).min(t_max)
        };
        let long = |d: f64, slack: f64| d < radius && cut(d).start + slack < cut(d).end;
        let (surely, perhaps) = (
            long(pass.d + pass.slack, 4.0 * pass.slack),
            long((pass.d - pass.slack).max(0.0), -4.0 * pass.slack),
        );
        assert!(hit.is_some() || !surely, "slot {slot} of {ray:?} missed");
        assert!(hit.is_none() || perhaps, "slot {slot} of {ray:?} met");
        verdict.unsure += usize::from(surely != perhaps);
        if let Some((_, t0, t1)) = hit {
            verdict.met += 1;
            assert!(0.0 <= t0 && t0 < t1 && t1 <= ray.t_max);
            let slack = 4.0 * (pass.slack + PROMISE * radius)
                + half((pass.d - pass.slack).max(0.0))
                - half(pass.d + pass.slack);
            let cut = cut(pass.d);
            assert!(
                (f64::from(t0) - cut.start).abs() <= slack,
                "{t0} is {}",
                cut.start
            );
            assert!(
                (f64::from(t1) - cut.end).abs() <= slack,
                "{t1} is {}",
                cut.end
            );
        }
    }
    verdict
}
