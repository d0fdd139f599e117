//! Lines of rays and beams, against brute force and against lines whose passing is known.

use glam::{DVec3, Vec3};
use tyndall_core::{Ray, Sampler, warp};
use tyndall_density::Lines;
use tyndall_testkit::{TestSampler, rng};

const SCALES: [f32; 5] = [1e-8, 1e-3, 1.0, 1e3, 1e8];

/// A pair of lines, with their points.
struct Pair {
    ray: Ray,
    origin: Vec3,
    direction: Vec3,
    lines: Lines,
}

impl Pair {
    fn new(ray: Ray, origin: Vec3, direction: Vec3) -> Self {
        let lines = Lines::new(&ray, origin, direction);
        Self {
            ray,
            origin,
            direction,
            lines,
        }
    }

    /// Anywhere, at this scale.
    fn random(scale: f32, sampler: &mut TestSampler) -> Self {
        let mut direction = || warp::uniform_sphere(sampler.next());
        let [d1, d2, p1, p2] = [(); 4].map(|()| direction());
        Self::new(Ray::new(p1 * scale, d1), p2 * scale, d2)
    }

    fn on_ray(&self, t: f64) -> DVec3 {
        let direction = self.ray.direction.as_dvec3().normalize();
        self.ray.origin.as_dvec3() + t * direction
    }

    fn on_beam(&self, v: f64) -> DVec3 {
        self.origin.as_dvec3() + v * self.direction.as_dvec3().normalize()
    }

    /// From one line to the other.
    fn distance(&self, t: f64, v: f64) -> f64 {
        self.on_ray(t).distance(self.on_beam(v))
    }
}

/// The x in [−reach, reach] where a convex function is least, by thirds.
fn least(reach: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-reach, reach);
    for _ in 0..120 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    0.5 * (low + high)
}

#[track_caller]
fn close(name: &str, found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{name}: {found:e}, expected {expected:e} ± {tolerance:e}"
    );
}

/// A search knows a minimum to the root of what numbers resolve, its value to that itself.
#[test]
fn random_lines_pass_where_a_search_finds_it() {
    let mut sampler = rng(1);
    for scale in SCALES {
        for _ in 0..40 {
            let pair = Pair::random(scale, &mut sampler);
            let (lines, unit) = (&pair.lines, f64::from(scale));
            let sin = lines.sin_theta();
            if sin < 0.1 {
                continue; // long to search
            }
            let reach = 20.0 * unit / sin;
            let foot = |t: f64| least(2.0 * reach, |v| pair.distance(t, v));
            let t = least(reach, |t| pair.distance(t, foot(t)));
            let [found, v] = lines.closest().expect("not parallel");
            let rough = 1e-6 * unit / (sin * sin);
            close("t", found, t, rough);
            close("v", v, foot(t), rough);
            close(
                "distance",
                lines.distance(),
                pair.distance(t, foot(t)),
                1e-9 * unit,
            );
            for x in [-0.7, 0.0, 2.5].map(|x| x * unit) {
                close("foot on the beam", lines.beam_foot(x), foot(x), rough);
                let on_ray = least(2.0 * reach, |t| pair.distance(t, x));
                close("foot on the ray", lines.ray_foot(x), on_ray, rough);
                let squared = pair.distance(x, -0.3 * unit).powi(2);
                let found = lines.distance_squared(x, -0.3 * unit);
                close("squared distance", found, squared, 1e-12 * squared);
            }
        }
    }
}

/// A ray along x, a beam (1, s, 0) from (a, b, c): v = −b/s, t = a + v, distance |c|. Axes are
/// exchanged and turned round.
#[test]
fn lines_almost_parallel_pass_where_they_should() {
    let mut sampler = rng(2);
    let mut number = |scale: f32| scale * (2.0 * sampler.next_1d() - 1.0);
    for scale in SCALES {
        for s in [1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12_f32] {
            for turn in 0..12 {
                let turned = |p: Vec3| {
                    let sign = if turn % 2 == 0 { 1.0 } else { -1.0 };
                    let p = match turn / 2 {
                        0 => p,
                        1 => Vec3::new(p.y, p.z, p.x),
                        2 => Vec3::new(p.z, p.x, p.y),
                        3 => Vec3::new(p.y, p.x, p.z),
                        4 => Vec3::new(p.z, p.y, p.x),
                        _ => Vec3::new(p.x, p.z, p.y),
                    };
                    p * Vec3::new(sign, 1.0, 1.0)
                };
                let [a, b, c] = [(); 3].map(|()| number(scale));
                let back = if turn % 3 == 0 { -1.0 } else { 1.0 };
                let ray = Ray::new(Vec3::ZERO, turned(Vec3::X));
                let direction = turned(Vec3::new(back, s, 0.0));
                let pair = Pair::new(ray, turned(Vec3::new(a, b, c)), direction);
                let lines = &pair.lines;
                let [a, b, c, s, back] = [a, b, c, s, back].map(f64::from);
                let norm = s.hypot(1.0);
                let sin = s / norm;
                close("sine", lines.sin_theta(), sin, 1e-15 * sin);
                let [t, v] = lines.closest().expect("not parallel");
                let far = a.abs() + b.abs() / s;
                close("v", v, -b * norm / s, 1e-14 * far);
                close("t", t, a - back * b / s, 1e-14 * far);
                close(
                    "distance",
                    lines.distance(),
                    c.abs(),
                    1e-14 * far.min(c.abs() + b.abs()),
                );
                // The chord of a radius has an end where the lines are that far from each other:
                // half of it is √(r² − c²)/sin θ on either.
                let radius = 1.5 * c.abs();
                let half = (radius * radius - c * c).sqrt() / sin;
                for (name, chord, middle) in [
                    ("of the ray", lines.ray_chord(radius), t),
                    ("of the beam", lines.beam_chord(radius), v),
                ] {
                    let [start, end] = chord.expect("within the radius");
                    close(name, 0.5 * (end - start), half, 1e-13 * (half + far));
                    close(name, 0.5 * (end + start), middle, 1e-13 * (half + far));
                }
                assert!(lines.ray_chord(0.99 * c.abs()).is_none());
                assert!(lines.beam_chord(0.99 * c.abs()).is_none());
            }
        }
    }
}

#[test]
fn chords_end_where_the_other_line_is_a_radius_away() {
    let mut sampler = rng(3);
    for scale in SCALES {
        for _ in 0..500 {
            let pair = Pair::random(scale, &mut sampler);
            let lines = &pair.lines;
            let radius = 1.5 * f64::from(scale * sampler.next_1d());
            let chords = [lines.ray_chord(radius), lines.beam_chord(radius)];
            if lines.distance() > radius {
                assert_eq!(chords, [None; 2]);
                continue;
            }
            let [ray, beam] = chords.map(|chord| chord.expect("within the radius"));
            let tolerance = 1e-12 * f64::from(scale) / lines.sin_theta();
            for t in ray {
                let away = pair.distance(t, lines.beam_foot(t));
                close("end of the ray's", away, radius, tolerance);
            }
            for v in beam {
                let away = pair.distance(lines.ray_foot(v), v);
                close("end of the beam's", away, radius, tolerance);
            }
        }
    }
}

#[test]
fn stretches_between_feet() {
    let mut sampler = rng(4);
    for scale in SCALES {
        for _ in 0..500 {
            let pair = Pair::random(scale, &mut sampler);
            let lines = &pair.lines;
            let ends = [-0.3, 0.8].map(|x| x * f64::from(scale));
            let cos = pair.ray.direction.as_dvec3().dot(pair.direction.as_dvec3());
            let tolerance = 1e-14 * f64::from(scale) / cos.abs();
            for (stretch, foot) in [
                (
                    lines.ray_between(ends),
                    Lines::beam_foot as fn(&Lines, f64) -> f64,
                ),
                (lines.beam_between(ends), Lines::ray_foot),
            ] {
                let [low, high] = stretch.expect("not at a right angle");
                assert!(low < high);
                let mut feet = [low, high].map(|x| foot(lines, x));
                feet.sort_by(f64::total_cmp);
                close("low", feet[0], ends[0], tolerance);
                close("high", feet[1], ends[1], tolerance);
            }
        }
    }
}

#[test]
fn parallel_and_perpendicular_lines() {
    for scale in SCALES {
        let ray = Ray::new(Vec3::splat(scale), Vec3::Z);
        let origin = Vec3::splat(scale) + scale * Vec3::new(3.0, 4.0, 7.0);
        let unit = f64::from(scale);
        for direction in [Vec3::Z, Vec3::NEG_Z] {
            let lines = Lines::new(&ray, origin, direction);
            assert_eq!((lines.closest(), lines.sin_theta()), (None, 0.0));
            close("distance", lines.distance(), 5.0 * unit, 1e-6 * unit);
            let all = Some([f64::NEG_INFINITY, f64::INFINITY]);
            assert_eq!(lines.ray_chord(6.0 * unit), all);
            assert_eq!(lines.beam_chord(6.0 * unit), all);
            assert_eq!(lines.ray_chord(4.0 * unit), None);
            let sign = f64::from(direction.z);
            close(
                "foot",
                lines.beam_foot(0.0),
                -7.0 * sign * unit,
                1e-6 * unit,
            );
            close("foot", lines.ray_foot(0.0), 7.0 * unit, 1e-6 * unit);
        }
        // At a right angle all of the ray has one foot.
        let lines = Lines::new(&ray, origin, Vec3::X);
        let [t, v] = lines.closest().expect("not parallel");
        close("t", t, 7.0 * unit, 1e-6 * unit);
        close("v", v, -3.0 * unit, 1e-6 * unit);
        let all = Some([f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(lines.ray_between([-4.0 * unit, 0.0]), all);
        assert_eq!(lines.ray_between([0.0, 4.0 * unit]), None);
    }
}
